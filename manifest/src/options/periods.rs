//! Update periods of the regions around the gaze, frames.

use super::{Allowed, Setting};
use toml::de::DeValue;

/// Number of regions.
const REGIONS: usize = 5;

/// The periods of five regions, the innermost first, frames: each from 1 to 9, and equal to the one before it or one more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Periods([u8; REGIONS]);

impl Periods {
    /// Periods of a preset, which keep the rules.
    pub(super) const fn of(periods: [u8; REGIONS]) -> Self {
        Self(periods)
    }

    /// The innermost first.
    pub const fn of_regions(self) -> [u8; REGIONS] {
        self.0
    }

    /// From five digits.
    fn parse(text: &str) -> Option<Self> {
        let digits: [u8; REGIONS] = text.as_bytes().try_into().ok()?;
        let periods = digits.map(|digit| digit.wrapping_sub(b'0'));
        let is_allowed = periods.iter().all(|period| (1..=9).contains(period))
            && periods.windows(2).all(|pair| pair[1] == pair[0] || pair[1] == pair[0] + 1);
        is_allowed.then_some(Self(periods))
    }
}

impl Setting for Periods {
    type Range = ();

    fn read(value: &DeValue<'_>, (): ()) -> Option<Self> {
        Self::parse(value.as_str()?)
    }

    fn allowed((): ()) -> Allowed {
        Allowed::Text(
            "five digits from 1 to 9, each equal to the one before it or one more, such as \"11223\"",
        )
    }

    fn to_toml(self) -> String {
        let digits: String = self.0.iter().map(|period| char::from(b'0' + period)).collect();
        format!("\"{digits}\"")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_period_is_that_before_it_or_one_more() {
        for text in ["11111", "11223", "12345", "56789", "99999", "33333"] {
            let periods = Periods::parse(text).unwrap();
            assert_eq!(periods.to_toml(), format!("\"{text}\""));
        }
        for text in [
            "",
            "1122",
            "112233",
            "11224",
            "11124",
            "21111",
            "01122",
            "1122x",
            "1122\u{663}",
            "56789a",
            "99:::",
        ] {
            assert_eq!(Periods::parse(text), None, "{text}");
        }
    }
}
