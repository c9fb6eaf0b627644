//! The parts of an option, and the macro that makes the table and the structures from one list.

use toml::de::DeValue;

use super::{Allowed, Config};

/// One row of the table.
#[derive(Clone, Copy, Debug)]
pub struct OptionSpec {
    /// The TOML table that it is in; empty at the top level.
    pub section: &'static str,
    /// Its key within the section.
    pub name: &'static str,
    /// Its effect, one line.
    pub doc: &'static str,
    /// Unit of a number; empty for a pure number and for other values.
    pub unit: &'static str,
    pub(crate) allowed: fn() -> Allowed,
    pub(crate) write: fn(&mut Config, &DeValue<'_>) -> Result<(), NotAllowed>,
    pub(crate) reason: fn(&DeValue<'_>) -> Option<String>,
    pub(crate) to_toml: fn(&Config) -> String,
}

/// A value is of the wrong type or out of the range of [`OptionSpec::allowed`].
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

/// The keys of all options with this name, joined by "or"; `None` if there are none.
pub fn keys_named(name: &str) -> Option<String> {
    let keys: Vec<_> =
        super::OPTIONS.iter().filter(|option| option.name == name).map(OptionSpec::key).collect();
    (!keys.is_empty()).then(|| keys.join(" or "))
}

/// Makes [`Config`] with a structure for each section, their defaults, and the table `OPTIONS`.
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
            reason: <$type as Setting>::reason,
            to_toml: |config| Setting::to_toml(config.$($field).+),
        }
    };
    (@last $section:ident $name:ident) => { stringify!($name) };
    (@last $name:ident) => { stringify!($name) };
}

pub(super) use options;
