//! Centres of fixed foveation: the lenses.

use super::FixedFoveation;
use crate::geometry::{Cap, rotation};
use glam::{Quat, Vec3};

/// Radius of the disc around the head's forward direction that stays at full rate for any cant of the lenses, degrees: as the fovea of the
/// safety limits.
const AHEAD_DEG: f32 = 5.0;

impl FixedFoveation {
    /// Centres of the rings for an unknown gaze: the optical axes of the left and of the right lens, unit vectors in the space
    /// common to both views. `orientations` lead there from the views' own spaces; an invalid one counts as none.
    ///
    /// A view of OpenXR looks along -z, where the tangents of its field of view are 0: there a lens is sharpest, and a picture has most pixels a
    /// degree. With canted displays (5 degrees outwards in a Valve Index, 10 in a Pimax) that is beside the head's forward direction, and
    /// with asymmetric fields of view beside the middle of the picture. A direction has the finer of the rates by its angles from both
    /// axes, in both eyes: where the views overlap they agree, and beyond, on the temporal side, each eye's own axis is the nearer one.
    ///
    /// The angle of the axes from the head's forward direction is limited, so that a disc of 5 degrees there stays at full rate.
    pub fn lens_centres(&self, orientations: [Quat; 2]) -> [Vec3; 2] {
        // Not a number: none.
        let most_deg = (self.foveal_deg - AHEAD_DEG).max(0.0);
        let ahead = Cap { centre: Vec3::NEG_Z, radius: 0.0 };
        orientations.map(|orientation| {
            let axis = rotation(orientation).map_or(Vec3::NEG_Z, |orientation| orientation * Vec3::NEG_Z);
            ahead.turned_towards(axis, most_deg.to_radians())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed_foveation::eccentricities_deg;
    use crate::geometry::{Fov, eccentricity};
    use crate::rate::ShadingRate;

    /// Displays that are canted outwards, degrees.
    fn canted(degrees: f32) -> [Quat; 2] {
        [degrees, -degrees].map(|cant| Quat::from_rotation_y(cant.to_radians()))
    }

    #[test]
    fn rings_are_around_the_axis_of_each_lens() {
        let map = FixedFoveation::WITHOUT_TRACKER;
        assert_eq!(map.lens_centres([Quat::IDENTITY; 2]), [Vec3::NEG_Z; 2]);
        for cant in [5.0, 10.0] {
            let orientations = canted(cant);
            let centres = map.lens_centres(orientations);
            for (centre, orientation) in centres.into_iter().zip(orientations) {
                let in_view = orientation.inverse() * centre;
                assert!(in_view.abs_diff_eq(Vec3::NEG_Z, 1e-6), "{in_view} with {cant} degrees");
            }
            let apart = eccentricity(centres[0], centres[1]).to_degrees();
            assert!((apart - 2.0 * cant).abs() < 1e-3, "{apart}");
            assert!(centres[0].x < 0.0 && centres[1].x > 0.0, "the left one is on the left");
        }
    }

    #[test]
    fn straight_ahead_stays_at_full_rate_whatever_the_cant() {
        for foveal_deg in [0.0, 5.0, 9.44, 14.34, 30.0, f32::NAN] {
            let map = FixedFoveation { foveal_deg, ..FixedFoveation::WITHOUT_TRACKER };
            for cant in [0.0, 5.0, 10.0, 40.0, 90.0] {
                for centre in map.lens_centres(canted(cant)) {
                    let ahead_deg = eccentricity(centre, Vec3::NEG_Z).to_degrees();
                    assert!(
                        ahead_deg <= (foveal_deg - AHEAD_DEG).max(0.0) + 1e-3,
                        "{ahead_deg} of {foveal_deg}"
                    );
                    assert!(ahead_deg <= cant + 1e-3);
                }
            }
        }
    }

    #[test]
    fn an_invalid_orientation_gives_the_forward_direction() {
        let map = FixedFoveation::WITHOUT_TRACKER;
        for orientation in [Quat::from_array([0.0; 4]), Quat::from_array([f32::NAN; 4])] {
            assert_eq!(map.lens_centres([orientation; 2]), [Vec3::NEG_Z; 2]);
        }
    }

    /// Pixels of a view that rings around `centre` shade, as a part of all. 1440 x 1600 pixels, as a Valve Index has them.
    fn shaded(map: &FixedFoveation, fov: Fov, centre: Vec3) -> f32 {
        let extent = [1440, 1600];
        let tiles = eccentricities_deg(&fov.tangents().plane(extent), extent, [16, 16], centre);
        map.mean_shading_rate(&tiles, &crate::rate::VULKAN_RATES)
    }

    /// With rings around the head's forward direction, a canted display would be at full rate to 35 degrees on the nasal side of its lens,
    /// and to 25 on the temporal one.
    #[test]
    fn rings_around_the_lens_shade_as_much_on_either_side() {
        let map = FixedFoveation { peripheral: ShadingRate::R4X4, ..FixedFoveation::L1_C1 };
        let degrees = |angle: f32| angle.to_radians();
        let fov = Fov { left: degrees(-52.0), right: degrees(52.0), up: degrees(52.0), down: degrees(-52.0) };
        let [nasal, temporal] = [Fov { left: 0.0, ..fov }, Fov { right: 0.0, ..fov }];
        let of = |fov: Fov, centre: Vec3| shaded(&map, fov, centre);
        assert!((of(nasal, Vec3::NEG_Z) - of(temporal, Vec3::NEG_Z)).abs() < 0.01);
        let ahead = canted(10.0)[0].inverse() * Vec3::NEG_Z;
        assert!(
            of(nasal, ahead) > of(temporal, ahead) + 0.05,
            "{} {}",
            of(nasal, ahead),
            of(temporal, ahead)
        );
    }
}
