//! Rules of a profile that decide which passes are the scene, if recognition is wrong.

mod format;

pub use format::{COLOR_FORMATS, ColorFormat};

use super::{Allowed, Setting};
use std::fmt;
use std::num::NonZeroU32;
use std::str::FromStr;
use toml::de::DeValue;

/// Most rules of a profile.
pub const MOST_RULES: usize = 8;

/// Rules in their order; the first one that fits a pass counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PassRules {
    rules: [Option<PassRule>; MOST_RULES],
}

/// A rule on passes with certain targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassRule {
    /// Their kind.
    pub kind: PassKind,
    /// Only those with a target of this format.
    pub format: Option<ColorFormat>,
    /// Only those with a target of this size, pixels.
    pub extent: Option<[u32; 2]>,
    /// Of the passes of a frame with these, only the one with this number, from 1.
    pub ordinal: Option<u32>,
    /// Vertical orientation of the picture; `None`: the finer of both orientations applies.
    pub way_up: Option<WayUp>,
}

/// Kind of a pass, over its whole render area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PassKind {
    /// Not the scene.
    Exclude,
    /// The left eye buffer.
    Left,
    /// The right eye buffer.
    Right,
    /// Either eye buffer: the finer of both maps applies.
    Either,
    /// Both eyes beside each other, the left one on the left.
    DoubleWide,
    /// The left eye in array layer 0, the right one in layer 1.
    Array,
}

/// Vertical orientation of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WayUp {
    /// The first row is the top.
    Upright,
    /// The first row is the bottom.
    Flipped,
}

const KINDS: [(&str, PassKind); 6] = [
    ("exclude", PassKind::Exclude),
    ("left", PassKind::Left),
    ("right", PassKind::Right),
    ("either", PassKind::Either),
    ("double-wide", PassKind::DoubleWide),
    ("array", PassKind::Array),
];

const WAYS_UP: [(&str, WayUp); 2] = [("upright", WayUp::Upright), ("flipped", WayUp::Flipped)];

/// Syntax of a rule, for people.
const SYNTAX: &str = "rules like \"exclude 2048x2048; left R16G16B16A16_SFLOAT 1440x1600 #1 upright\": exclude, left, right, \
    either, double-wide or array; then at least one of a colour format (VkFormat without VK_FORMAT_), a size, and # with the number of \
    the pass in the frame; then upright or flipped, if known";

/// Reason why a text is not a list of rules.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PassRulesError {
    /// A rule that does not begin with a kind of passes.
    #[error("\"{0}\": a rule begins with exclude, left, right, either, double-wide or array")]
    Kind(String),
    /// A word that may not follow.
    #[error(
        "\"{0}\": allowed: a colour format (such as R16G16B16A16_SFLOAT), a size (1440x1600), a number from 1 (#1), \
         upright, flipped"
    )]
    Word(String),
    /// A repeated value.
    #[error("\"{0}\": a second value of this kind in one rule")]
    Twice(String),
    /// A rule that would fit every pass.
    #[error("\"{0}\": a rule needs a colour format, a size or a number")]
    Everything(String),
    /// Too many.
    #[error("too many rules; allowed: at most {MOST_RULES}")]
    Many,
}

impl PassRules {
    /// The rules in their order.
    pub fn iter(&self) -> impl Iterator<Item = &PassRule> {
        self.rules.iter().flatten()
    }
}

impl FromStr for PassRules {
    type Err = PassRulesError;

    /// Rules apart by semicolons; an empty text stands for no rules.
    fn from_str(text: &str) -> Result<Self, PassRulesError> {
        let mut rules = Self::default();
        let mut places = rules.rules.iter_mut();
        for rule in text.split(';').map(str::trim).filter(|rule| !rule.is_empty()) {
            *places.next().ok_or(PassRulesError::Many)? = Some(rule.parse()?);
        }
        Ok(rules)
    }
}

impl FromStr for PassRule {
    type Err = PassRulesError;

    fn from_str(text: &str) -> Result<Self, PassRulesError> {
        let mut words = text.split_whitespace();
        let first = words.next().unwrap_or_default();
        let kind = named(&KINDS, first).ok_or_else(|| PassRulesError::Kind(first.to_owned()))?;
        let mut rule = Self { kind, format: None, extent: None, ordinal: None, way_up: None };
        for word in words {
            rule.add(word)?;
        }
        if rule.format.is_none() && rule.extent.is_none() && rule.ordinal.is_none() {
            return Err(PassRulesError::Everything(text.to_owned()));
        }
        Ok(rule)
    }
}

impl PassRule {
    fn add(&mut self, word: &str) -> Result<(), PassRulesError> {
        let was_there = if let Some(ordinal) = word.strip_prefix('#').and_then(number) {
            self.ordinal.replace(ordinal).is_some()
        } else if let Some(extent) = extent(word) {
            self.extent.replace(extent).is_some()
        } else if let Some(way_up) = named(&WAYS_UP, word) {
            self.way_up.replace(way_up).is_some()
        } else if let Some(format) = ColorFormat::from_name(word) {
            self.format.replace(format).is_some()
        } else {
            return Err(PassRulesError::Word(word.to_owned()));
        };
        if was_there { Err(PassRulesError::Twice(word.to_owned())) } else { Ok(()) }
    }
}

/// A whole number from 1, in digits only.
fn number(text: &str) -> Option<u32> {
    let is_digits = text.bytes().all(|byte| byte.is_ascii_digit());
    text.parse::<NonZeroU32>().ok().filter(|_| is_digits).map(NonZeroU32::get)
}

fn extent(text: &str) -> Option<[u32; 2]> {
    let (width, height) = text.split_once('x')?;
    Some([number(width)?, number(height)?])
}

fn named<T: Copy>(names: &[(&str, T)], name: &str) -> Option<T> {
    names.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

fn name_of<T: Copy + PartialEq>(names: &[(&'static str, T)], value: T) -> &'static str {
    names.iter().find(|(_, known)| *known == value).map_or("", |(name, _)| name)
}

impl fmt::Display for PassRules {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, rule) in self.iter().enumerate() {
            let separator = if index == 0 { "" } else { "; " };
            write!(f, "{separator}{rule}")?;
        }
        Ok(())
    }
}

impl fmt::Display for PassRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(name_of(&KINDS, self.kind))?;
        if let Some(format) = self.format {
            write!(f, " {format}")?;
        }
        if let Some([width, height]) = self.extent {
            write!(f, " {width}x{height}")?;
        }
        if let Some(ordinal) = self.ordinal {
            write!(f, " #{ordinal}")?;
        }
        match self.way_up {
            Some(way_up) => write!(f, " {}", name_of(&WAYS_UP, way_up)),
            None => Ok(()),
        }
    }
}

impl Setting for PassRules {
    type Range = ();

    fn read(value: &DeValue<'_>, (): ()) -> Option<Self> {
        value.as_str()?.parse().ok()
    }

    fn allowed((): ()) -> Allowed {
        Allowed::Text(SYNTAX)
    }

    fn reason(value: &DeValue<'_>) -> Option<String> {
        value.as_str()?.parse::<Self>().err().map(|error| error.to_string())
    }

    fn to_toml(self) -> String {
        format!("\"{self}\"")
    }
}

#[cfg(test)]
mod tests;
