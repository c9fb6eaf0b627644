//! Parts of pictures that are searched for changes of content.

use super::SessionPlanner;
use glam::{Quat, Vec3};

/// The part of an eye buffer that may be re-used in later frames, so that its changes count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watched {
    orientation: Quat,
    /// The part that is rendered in each frame anyhow is around these, in the view's space, ...
    centres: [Vec3; 2],
    /// ... within the angle that has this cosine.
    cosine: f32,
}

impl SessionPlanner {
    /// The watched part of eye buffers of an eye, by the newest plan; `None` if the plan renders everything in each frame, and in the frames of
    /// the other eye: both see most of the changes.
    pub fn watched(&self, eye: usize) -> Option<Watched> {
        let plan = self.planner.as_ref()?.newest();
        if eye != eye_watched_in(plan.frame) {
            return None;
        }
        let always = plan.periods.iter().take_while(|period| **period == 1).count();
        let radius_deg = match always {
            0 => -1.0,
            _ => *plan.regions_deg.get(always - 1)?,
        };
        let cosine = if radius_deg < 0.0 { 2.0 } else { radius_deg.min(180.0).to_radians().cos() };
        Some(Watched { orientation: self.orientations[eye], centres: plan.eyes[eye].centres, cosine })
    }
}

/// The eye of each turn, frame by frame, over and over: no eye waits for more than two frames, and as thirteen has no divisor in common
/// with any period of re-use, tiles that are rendered in every so many frames have their turn in both eyes. Found by trying all for the
/// shortest waits.
const TURNS: [usize; 13] = [0, 0, 1, 0, 0, 1, 0, 1, 0, 1, 0, 1, 1];

fn eye_watched_in(frame: u64) -> usize {
    TURNS[(frame % TURNS.len() as u64) as usize]
}

impl Watched {
    /// Of everything farther from a direction than the angle with this cosine.
    #[cfg(test)]
    pub fn beyond(cosine: f32, centre: Vec3) -> Self {
        Self { orientation: Quat::IDENTITY, centres: [centre; 2], cosine }
    }

    /// Orientation of the view in the world when its picture was planned.
    pub fn orientation(&self) -> Quat {
        self.orientation
    }

    /// Whether a direction in the view's space, of any length, is watched.
    pub fn is_watched(&self, direction: Vec3) -> bool {
        let limit = self.cosine * direction.length();
        self.centres.iter().all(|centre| centre.dot(direction) < limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_every_frame_are_not_watched() {
        let cosine = 9.1f32.to_radians().cos();
        let ahead = Watched { orientation: Quat::IDENTITY, centres: [Vec3::NEG_Z, Vec3::NEG_Z], cosine };
        for (angle_deg, is_watched) in [(0.0f32, false), (8.9, false), (9.3, true), (40.0, true)] {
            let direction = 3.0 * (Quat::from_rotation_y(angle_deg.to_radians()) * Vec3::NEG_Z);
            assert_eq!(ahead.is_watched(direction), is_watched, "{angle_deg}");
        }
        let everywhere = Watched { cosine: 2.0, ..ahead };
        assert!(everywhere.is_watched(Vec3::NEG_Z));
        assert_eq!(SessionPlanner::default().watched(0), None, "without a plan");
    }

    #[test]
    fn directions_of_any_period_are_watched_in_both_eyes() {
        for (period, first) in (1..=9).flat_map(|period| (0..period).map(move |first| (period, first))) {
            let turns: Vec<usize> = (0..26).map(|turn| eye_watched_in(first + period * turn)).collect();
            for eye in [0, 1] {
                let waits = turns.split(|turn| *turn == eye).map(<[usize]>::len).max();
                assert!(waits <= Some(4), "eye {eye}, {first} + n {period}: {turns:?}");
            }
        }
        let next: Vec<usize> = (0..27).map(eye_watched_in).collect();
        assert!(next.windows(3).all(|turns| turns.contains(&0) && turns.contains(&1)));
    }
}
