//! The types that options can have, and the values that they take.

use std::fmt;
use std::ops::RangeInclusive;
use toml::de::DeValue;

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
    /// A text, and how it is made up.
    Text(&'static str),
    /// One of some names, each with its meaning.
    Choice(&'static [(&'static str, &'static str)]),
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag => f.write_str("true or false"),
            Self::Number { min, max } => write!(f, "a number from {min} to {max}"),
            Self::Whole { min, max } => write!(f, "a whole number from {min} to {max}"),
            Self::Text(syntax) => f.write_str(syntax),
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
    /// Its bounds: none, or a range.
    type Range;

    /// The value, if it has the right type and is within `range`.
    fn read(value: &DeValue<'_>, range: Self::Range) -> Option<Self>;

    /// The values that [`Setting::read`] takes.
    fn allowed(range: Self::Range) -> Allowed;

    /// The reason against a value that [`Setting::read`] does not take; `None` if the allowed values tell it.
    fn reason(_: &DeValue<'_>) -> Option<String> {
        None
    }

    /// Its text in a file, from which [`Setting::read`] makes the same value.
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
