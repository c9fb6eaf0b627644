//! What an option is, and the macro that makes the table and the structures from one list.

use std::fmt;
use std::ops::RangeInclusive;
use toml::de::DeValue;

use super::Config;

/// One row of the table.
#[derive(Clone, Copy, Debug)]
pub struct OptionSpec {
    /// The TOML table that it is in; empty at the top level.
    pub section: &'static str,
    /// Its key within the section.
    pub name: &'static str,
    /// What it does, one line.
    pub doc: &'static str,
    /// What a number counts; empty for a pure number and for what is no number.
    pub unit: &'static str,
    pub(crate) allowed: fn() -> Allowed,
    pub(crate) write: fn(&mut Config, &DeValue<'_>) -> Result<(), NotAllowed>,
    pub(crate) to_toml: fn(&Config) -> String,
}

/// A value is of the wrong type or out of range: not what [`OptionSpec::allowed`] says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NotAllowed;

impl OptionSpec {
    /// The key as the user writes it: `chroma.mode`.
    pub fn key(&self) -> String {
        if self.section.is_empty() { self.name.to_owned() } else { format!("{}.{}", self.section, self.name) }
    }

    /// The values that it takes.
    pub fn allowed(&self) -> Allowed {
        (self.allowed)()
    }

    /// The values that it takes, in words, with the unit.
    pub fn allowed_with_unit(&self) -> String {
        let allowed = self.allowed();
        if self.unit.is_empty() { allowed.to_string() } else { format!("{allowed} {}", self.unit) }
    }

    /// Its value in `config`, as it stands in a file.
    pub fn value(&self, config: &Config) -> String {
        (self.to_toml)(config)
    }
}

/// The values that an option takes. `Display` completes "allowed: ...".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Allowed {
    /// True or false.
    Flag,
    /// A finite number within bounds, both allowed.
    Number {
        /// The least.
        min: f32,
        /// The greatest.
        max: f32,
    },
    /// A whole number within bounds, both allowed.
    Whole {
        /// The least.
        min: u32,
        /// The greatest.
        max: u32,
    },
    /// One of some names, each with what it means.
    Choice(&'static [(&'static str, &'static str)]),
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag => f.write_str("true or false"),
            Self::Number { min, max } => write!(f, "a number from {min} to {max}"),
            Self::Whole { min, max } => write!(f, "a whole number from {min} to {max}"),
            Self::Choice(choices) => {
                for (index, (name, _)) in choices.iter().enumerate() {
                    let separator = match index {
                        0 => "",
                        _ if index + 1 == choices.len() => " or ",
                        _ => ", ",
                    };
                    write!(f, "{separator}\"{name}\"")?;
                }
                Ok(())
            }
        }
    }
}

/// A type that an option can have.
pub trait Setting: Copy {
    /// What bounds it: nothing, or a range.
    type Range;

    /// The value, if it has the right type and is within `range`.
    fn read(value: &DeValue<'_>, range: Self::Range) -> Option<Self>;

    /// What [`Setting::read`] takes.
    fn allowed(range: Self::Range) -> Allowed;

    /// As it stands in a file: what [`Setting::read`] makes the same value from.
    fn to_toml(self) -> String;
}

impl Setting for bool {
    type Range = ();

    fn read(value: &DeValue<'_>, (): ()) -> Option<Self> {
        value.as_bool()
    }

    fn allowed((): ()) -> Allowed {
        Allowed::Flag
    }

    fn to_toml(self) -> String {
        self.to_string()
    }
}

impl Setting for u32 {
    type Range = RangeInclusive<u32>;

    fn read(value: &DeValue<'_>, range: Self::Range) -> Option<Self> {
        let integer = value.as_integer()?;
        u32::from_str_radix(integer.as_str(), integer.radix()).ok().filter(|number| range.contains(number))
    }

    fn allowed(range: Self::Range) -> Allowed {
        Allowed::Whole { min: *range.start(), max: *range.end() }
    }

    fn to_toml(self) -> String {
        self.to_string()
    }
}

impl Setting for f32 {
    type Range = RangeInclusive<f32>;

    /// Takes integers too: `55` is as good as `55.0`. The range excludes NaN and the infinities.
    fn read(value: &DeValue<'_>, range: Self::Range) -> Option<Self> {
        let number = match value {
            DeValue::Float(float) => float.as_str().parse().ok()?,
            DeValue::Integer(integer) => i32::from_str_radix(integer.as_str(), integer.radix()).ok()? as f32,
            _ => return None,
        };
        range.contains(&number).then_some(number)
    }

    fn allowed(range: Self::Range) -> Allowed {
        Allowed::Number { min: *range.start(), max: *range.end() }
    }

    fn to_toml(self) -> String {
        format!("{self:?}")
    }
}

/// Makes [`Config`] with a structure for each section, their defaults, and the table [`OPTIONS`].
///
/// An option is `name: type = default;`, a number `name: type = default, min..=max "unit";`.
macro_rules! options {
    (
        $(#[doc = $config_doc:literal])+ $config:ident {
            $($(#[doc = $top_doc:literal])+ $top:ident: $top_type:ty = $top_default:expr;)+
        }
        $($(#[doc = $section_doc:literal])+ $section:ident: $struct:ident {
            $($(#[doc = $doc:literal])+
            $name:ident: $type:ty = $default:expr $(, $min:literal..=$max:literal $unit:literal)?;)+
        })+
    ) => {
        $(#[doc = $config_doc])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $config {
            $($(#[doc = $top_doc])+ pub $top: $top_type,)+
            $($(#[doc = $section_doc])+ pub $section: $struct,)+
        }

        impl Default for $config {
            fn default() -> Self {
                Self { $($top: $top_default,)+ $($section: $struct::default(),)+ }
            }
        }

        $(
            $(#[doc = $section_doc])+
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct $struct {
                $($(#[doc = $doc])+ $(#[doc = concat!("\n\n", $min, "..=", $max, " ", $unit)])? pub $name: $type,)+
            }

            impl Default for $struct {
                fn default() -> Self {
                    Self { $($name: $default,)+ }
                }
            }
        )+

        /// Every option, in the order in which the default file lists them.
        pub const OPTIONS: &[OptionSpec] = &[
            $(options!(@row "", concat!($($top_doc),+), "", $top_type, [$top], ()),)+
            $($(options!(
                @row stringify!($section), concat!($($doc),+), concat!($($unit)?), $type,
                [$section.$name], ($($min..=$max)?)
            ),)+)+
        ];
    };
    (@row $section:expr, $doc:expr, $unit:expr, $type:ty, [$($field:ident).+], $range:expr) => {
        OptionSpec {
            section: $section,
            name: options!(@last $($field)+),
            doc: $doc.trim_ascii(),
            unit: $unit,
            allowed: || <$type as Setting>::allowed($range),
            write: |config, value| match <$type as Setting>::read(value, $range) {
                Some(setting) => {
                    config.$($field).+ = setting;
                    Ok(())
                }
                None => Err(table::NotAllowed),
            },
            to_toml: |config| Setting::to_toml(config.$($field).+),
        }
    };
    (@last $section:ident $name:ident) => { stringify!($name) };
    (@last $name:ident) => { stringify!($name) };
}

pub(super) use options;
