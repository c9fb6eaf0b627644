//! Options of two angles.

use super::{Allowed, Setting};
use toml::de::DeValue;

/// Largest angle either way, degrees: more than a headset that slips turns the gaze by.
const LARGEST_DEG: f32 = 20.0;

/// Two angles from the centre of the view, degrees: to the left, and upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles([f32; 2]);

impl Angles {
    /// No turn.
    pub const NONE: Self = Self([0.0; 2]);

    /// To the left, and upwards, degrees within -20..=20.
    pub const fn left_up_deg(self) -> [f32; 2] {
        self.0
    }

    fn parse(text: &str) -> Option<Self> {
        let (left, up) = text.split_once(',')?;
        let angle = |text: &str| {
            text.trim().parse().ok().filter(|angle| (-LARGEST_DEG..=LARGEST_DEG).contains(angle))
        };
        Some(Self([angle(left)?, angle(up)?]))
    }
}

impl Setting for Angles {
    type Range = ();

    fn read(value: &DeValue<'_>, (): ()) -> Option<Self> {
        Self::parse(value.as_str()?)
    }

    fn allowed((): ()) -> Allowed {
        Allowed::Text("two numbers from -20 to 20, separated by a comma, such as \"1.5, -0.5\"")
    }

    fn to_toml(self) -> String {
        let [left, up] = self.0;
        format!("\"{left}, {up}\"")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_numbers_within_the_bounds_are_taken_and_read_again() {
        for (text, angles) in [("0,0", [0.0; 2]), ("1.5, -0.5", [1.5, -0.5]), (" -20.0 ,20", [-20.0, 20.0])] {
            let taken = Angles::parse(text).unwrap();
            assert_eq!(taken.left_up_deg(), angles, "{text}");
            assert_eq!(Angles::parse(taken.to_toml().trim_matches('"')), Some(taken), "{text}");
        }
        for refused in ["", "1", "1 2", "1,2,3", "1,", "a,0", "20.1, 0", "nan, 0", "0, -inf"] {
            assert_eq!(Angles::parse(refused), None, "{refused}");
        }
    }
}
