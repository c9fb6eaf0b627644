//! From the one ray that most sources have to a direction for each eye.

use crate::geometry::unit_direction;
use glam::Vec3;

/// Assumed distance of an unknown fixation point, metres: rings around both eyes' directions to it cover all points farther away, and with
/// an eye at 6 degrees from the ray nearly all points from 0.3 m on.
pub const NEAREST_ASSUMED_M: f32 = 0.4;

/// Nearest distance that is believed, metres: the near point of a child's eye is at 0.07 to 0.1.
const NEAREST_M: f32 = 0.1;

/// Half the distance between the eyes where that is not known, metres (mean of 63 mm, Dodgson 2004).
const HALF_IPD_M: f32 = 0.0315;

/// Farthest that an eye is from the middle of both, metres; the widest interpupillary distance measured is 78 mm
/// (Dodgson 2004).
const FARTHEST_EYE_M: f32 = 0.06;

/// Gaze direction of each eye, left first, when both look at the point `distance_m` along the ray `gaze` from between them.
///
/// The ray is the direction of neither eye: 3.6 degrees off at 0.5 m, 6 at 0.3 m. `eyes_m` are the eyes' positions (the
/// views' poses) relative to the ray's origin, in the space of `gaze`, metres. `distance_m` may come from submitted depth;
/// infinity is far away. Without one, or with one that is not positive, the eyes are taken to look at [`NEAREST_ASSUMED_M`]:
/// the rings around both then reach to either side as far as either eye can look, which is a fovea widened along the line
/// between the eyes.
///
/// The results are unit vectors. A `gaze` that is not a direction counts as -z. Eyes at impossible positions (not finite, or
/// more than 6 cm from the ray's origin) are taken to be 63 mm apart.
pub fn eye_directions(gaze: Vec3, eyes_m: [Vec3; 2], distance_m: Option<f32>) -> [Vec3; 2] {
    let gaze = unit_direction(gaze).unwrap_or(Vec3::NEG_Z);
    let distance = distance_m.filter(|distance| *distance > 0.0).unwrap_or(NEAREST_ASSUMED_M);
    let plausible = eyes_m.iter().all(|eye| eye.is_finite() && eye.length() <= FARTHEST_EYE_M);
    let eyes = if plausible { eyes_m } else { [Vec3::NEG_X * HALF_IPD_M, Vec3::X * HALF_IPD_M] };
    // Divided by the distance, so that an infinite one is not a special case.
    let nearness = 1.0 / distance.max(NEAREST_M);
    eyes.map(|eye| unit_direction(gaze - eye * nearness).unwrap_or(gaze))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const EYES: [Vec3; 2] = [Vec3::new(-0.0315, 0.0, 0.0), Vec3::new(0.0315, 0.0, 0.0)];

    fn right_deg(direction: Vec3) -> f32 {
        direction.x.atan2(-direction.z).to_degrees()
    }

    #[test]
    fn eyes_converge_at_the_distance() {
        for (distance_m, angle_deg) in [(0.3, 5.99), (0.5, 3.60), (1.0, 1.80), (f32::INFINITY, 0.0)] {
            let [left, right] = eye_directions(Vec3::NEG_Z, EYES, Some(distance_m)).map(right_deg);
            assert!((left - angle_deg).abs() < 0.01, "{distance_m}: {left}");
            assert!((right + angle_deg).abs() < 0.01, "{distance_m}: {right}");
        }
    }

    #[test]
    fn without_a_distance_the_rings_reach_both_ways() {
        for distance_m in [None, Some(0.0), Some(-1.0), Some(f32::NAN)] {
            let [left, right] = eye_directions(Vec3::NEG_Z, EYES, distance_m).map(right_deg);
            assert!((left - 4.50).abs() < 0.01 && (right + 4.50).abs() < 0.01, "{left} {right}");
        }
    }

    proptest! {
        #[test]
        fn any_input_gives_unit_vectors_near_the_ray(
            gaze in proptest::array::uniform3(proptest::num::f32::ANY),
            eyes in proptest::array::uniform2(proptest::array::uniform3(
                prop_oneof![proptest::num::f32::ANY, -0.06f32..0.06],
            )),
            distance_m in proptest::option::of(proptest::num::f32::ANY),
        ) {
            let gaze = Vec3::from(gaze);
            for direction in eye_directions(gaze, eyes.map(Vec3::from), distance_m) {
                prop_assert!(direction.is_normalized());
                let from = unit_direction(gaze).unwrap_or(Vec3::NEG_Z);
                // An eye 6 cm to the side that looks at 10 cm: 31 degrees, asin(0.6) = 37 if the offset is not at right angles to the gaze.
                prop_assert!(from.angle_between(direction).to_degrees() < 37.5);
            }
        }
    }
}
