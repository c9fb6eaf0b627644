//! Update period of each region: the frame rate configurations of paper B.

use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// Number of regions, from the centre outwards (paper B, section 3.3).
pub const REGIONS: usize = 5;

/// Slowest factor that has a digit.
pub const MAX_FACTOR: u8 = 9;

/// Paper B's frame rate configuration f: region i is rendered in one of `f_i` frames.
///
/// Factors are 1..=9, from the centre outwards, each equal to the one before it or one more
/// (f_i <= f_{i+1} <= f_i + 1). Written as five digits, "11223".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct UpdateConfiguration([u8; REGIONS]);

impl UpdateConfiguration {
    /// Everything in every frame: the schedule does nothing.
    pub const F11111: Self = Self([1, 1, 1, 1, 1]);
    /// The outermost region at half the frame rate; nearly free while fixating.
    pub const F11112: Self = Self([1, 1, 1, 1, 2]);
    /// 52.2 % of the pixels.
    pub const F11122: Self = Self([1, 1, 1, 2, 2]);
    /// 36.4 % of the pixels, "feasible" in the paper.
    pub const F11223: Self = Self([1, 1, 2, 2, 3]);
    /// 34.6 % of the pixels.
    pub const F11233: Self = Self([1, 1, 2, 3, 3]);
    /// 50.2 % of the pixels.
    pub const F12222: Self = Self([1, 2, 2, 2, 2]);
    /// 34.4 % of the pixels.
    pub const F12233: Self = Self([1, 2, 2, 3, 3]);
    /// 27.3 % of the pixels.
    pub const F12234: Self = Self([1, 2, 2, 3, 4]);
    /// 26.7 % of the pixels.
    pub const F12334: Self = Self([1, 2, 3, 3, 4]);
    /// 21.5 % of the pixels, the slowest.
    pub const F12345: Self = Self([1, 2, 3, 4, 5]);

    /// The ten that paper B studied, in the order of its section 3.3.
    pub const PAPER: [Self; 10] = [
        Self::F11111,
        Self::F11112,
        Self::F11122,
        Self::F11223,
        Self::F11233,
        Self::F12222,
        Self::F12233,
        Self::F12234,
        Self::F12334,
        Self::F12345,
    ];

    /// A configuration from its factors, the centre's first.
    ///
    /// # Errors
    /// Where a factor is not within 1..=9, or not equal to the one before it or one more.
    pub fn new(factors: [u8; REGIONS]) -> Result<Self, ConfigurationError> {
        for (index, factor) in factors.into_iter().enumerate() {
            if !(1..=MAX_FACTOR).contains(&factor) {
                return Err(ConfigurationError::Factor { region: index + 1, factor });
            }
        }
        for (index, pair) in factors.windows(2).enumerate() {
            if pair[1] < pair[0] || pair[1] > pair[0] + 1 {
                return Err(ConfigurationError::Step { region: index + 2, factor: pair[1], before: pair[0] });
            }
        }
        Ok(Self(factors))
    }

    /// The factors f_1..f_5, each 1..=9.
    pub const fn factors(self) -> [u8; REGIONS] {
        self.0
    }

    /// The same with no factor above `cap` (0 counts as 1). The rules of [`Self::new`] still hold.
    pub fn capped(self, cap: u8) -> Self {
        Self(self.0.map(|factor| factor.min(cap.max(1))))
    }

    /// The same with no region's factor above its own cap, the centre's first, of which none counts as less than 1 or than the
    /// one before it. The rules of [`Self::new`] still hold.
    pub fn limited(self, caps: [u8; REGIONS]) -> Self {
        let (mut cap, mut most) = (1, MAX_FACTOR);
        Self(std::array::from_fn(|region| {
            cap = caps[region].max(cap);
            let factor = self.0[region].min(cap).min(most);
            most = factor + 1;
            factor
        }))
    }

    /// One step faster: every factor above 1 less by one. For times when updates are noticed more readily, such as
    /// pursuit (paper B, section 6: following an object is worse than fixating).
    pub fn faster(self) -> Self {
        Self(self.0.map(|factor| factor.max(2) - 1))
    }
}

impl Default for UpdateConfiguration {
    /// [`Self::F11111`].
    fn default() -> Self {
        Self::F11111
    }
}

impl fmt::Display for UpdateConfiguration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|factor| write!(f, "{factor}"))
    }
}

impl FromStr for UpdateConfiguration {
    type Err = ConfigurationError;

    /// Five digits, without spaces.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut factors = [0; REGIONS];
        let mut count = 0;
        for character in text.chars() {
            let factor = character.to_digit(10).ok_or(ConfigurationError::Character(character))?;
            if let Some(slot) = factors.get_mut(count) {
                *slot = factor as u8;
            }
            count += 1;
        }
        if count != REGIONS {
            return Err(ConfigurationError::Length(count));
        }
        Self::new(factors)
    }
}

/// Reason why a text is not an update configuration. Each message ends with the allowed values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ConfigurationError {
    /// Not five characters.
    #[error("an update configuration has {REGIONS} digits, not {0}; {ALLOWED}")]
    Length(usize),
    /// Something that is not a digit.
    #[error("{0:?} in an update configuration is not a digit; {ALLOWED}")]
    Character(char),
    /// A factor out of range.
    #[error("region {region} has factor {factor}; {ALLOWED}")]
    Factor {
        /// Number of the region; 1 is the centre.
        region: usize,
        /// Its factor.
        factor: u8,
    },
    /// A factor below, or more than one above, that of the region inside.
    #[error("region {region} has factor {factor} after {before}; {ALLOWED}")]
    Step {
        /// Number of the region, 2..=5.
        region: usize,
        /// Its factor.
        factor: u8,
        /// The factor of the region inside it.
        before: u8,
    },
}

const ALLOWED: &str =
    "allowed are five digits from 1 to 9, each equal to the one before it or one more, such as 11223";
