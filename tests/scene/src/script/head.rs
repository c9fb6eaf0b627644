//! Motion of the head.

use glam::{EulerRot, Quat, Vec3};

/// Height of LOCAL above the floor that the scenes stand on, metres: the mock runtime's default.
pub const EYE_HEIGHT_M: f32 = 1.6;

/// A keyframe of the head; the fields of the mock runtime's `[[head]]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadKey {
    /// Seconds.
    pub t: f64,
    /// In LOCAL, metres.
    pub position: [f32; 3],
    /// To the left, degrees.
    pub yaw_deg: f32,
    /// Upwards, degrees.
    pub pitch_deg: f32,
    /// Counter-clockwise, degrees.
    pub roll_deg: f32,
}

impl HeadKey {
    /// Orientation of the head: yaw about +y, then pitch about the new +x, then roll about the new +z.
    pub fn orientation(&self) -> Quat {
        let [yaw, pitch, roll] = [self.yaw_deg, self.pitch_deg, self.roll_deg].map(f32::to_radians);
        Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll)
    }

    /// Position of the head in the scene's world, metres.
    pub fn world_position(&self) -> Vec3 {
        Vec3::from(self.position) + Vec3::Y * EYE_HEIGHT_M
    }

    /// Direction and distance in metres of a point of the world, seen from the head (VIEW: -z is ahead, +y is up).
    pub fn view_of(&self, point: Vec3) -> (Vec3, f32) {
        let seen = self.orientation().inverse() * (point - self.world_position());
        (seen.normalize_or(Vec3::NEG_Z), seen.length())
    }

    fn numbers(&self) -> [f32; 6] {
        let [x, y, z] = self.position;
        [x, y, z, self.yaw_deg, self.pitch_deg, self.roll_deg]
    }
}

/// A smooth path through waypoints; it rests before the first and after the last.
#[derive(Clone, Debug)]
pub struct HeadPath {
    waypoints: &'static [HeadKey],
}

impl HeadPath {
    /// A path through waypoints in ascending order of time.
    pub(super) fn new(waypoints: &'static [HeadKey]) -> Self {
        Self { waypoints }
    }

    /// The head at a time: cubic Hermite curves with the slopes of Catmull and Rom, so that speed is continuous.
    pub fn at(&self, t: f64) -> HeadKey {
        let last = self.waypoints.len() - 1;
        let next = self.waypoints.partition_point(|waypoint| waypoint.t <= t).clamp(1, last);
        let (from, to) = (&self.waypoints[next - 1], &self.waypoints[next]);
        let span = (to.t - from.t) as f32;
        let s = (((t - from.t) / (to.t - from.t)).clamp(0.0, 1.0)) as f32;
        let slope = |index: usize, number: usize| {
            // At rest at both ends.
            if index == 0 || index == last {
                return 0.0;
            }
            let (before, after) = (&self.waypoints[index - 1], &self.waypoints[index + 1]);
            (after.numbers()[number] - before.numbers()[number]) / (after.t - before.t) as f32
        };
        let (s2, s3) = (s * s, s * s * s);
        let [x, y, z, yaw_deg, pitch_deg, roll_deg] = std::array::from_fn(|number| {
            (2.0 * s3 - 3.0 * s2 + 1.0) * from.numbers()[number]
                + (s3 - 2.0 * s2 + s) * span * slope(next - 1, number)
                + (3.0 * s2 - 2.0 * s3) * to.numbers()[number]
                + (s3 - s2) * span * slope(next, number)
        });
        HeadKey { t, position: [x, y, z], yaw_deg, pitch_deg, roll_deg }
    }

    /// Dense keyframes for linear interpolation, so many a second.
    pub fn keyframes(&self, rate_hz: f64) -> Vec<HeadKey> {
        super::gaze::times(rate_hz).map(|t| self.at(t)).collect()
    }
}
