//! Orientation of the head: eyes that rest on the world turn against it, and a sample's direction is as old as the sample.

use glam::Quat;

/// Frames that are remembered: twice the longest [`super::LONGEST_NS`] at 90 a second.
const KEPT: usize = 27;

/// Fastest turn of a head, degrees a second; a faster one is a jump of its space.
const FASTEST_DEG_S: f32 = 500.0;

/// Shortest time that such a jump is judged by, seconds: another orientation of the same time may be a better prediction.
const LEAST_S: f32 = 0.01;

/// Orientations of the head at the times of the last frames, in a space that rests in the world and never jumps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Head {
    /// Oldest first.
    samples: [(Quat, i64); KEPT],
    count: usize,
    /// From the space of the orientations that are passed in.
    origin: Quat,
    deg_s: f32,
}

impl Default for Head {
    /// A head of unknown orientation, which does not turn.
    fn default() -> Self {
        Self { samples: [(Quat::IDENTITY, 0); KEPT], count: 0, origin: Quat::IDENTITY, deg_s: 0.0 }
    }
}

impl Head {
    /// Takes its orientation, a unit quaternion, at a time. Returns its turn since the newest time before, degrees.
    pub(super) fn turned(&mut self, told: Quat, time_ns: i64) -> f32 {
        let Some((before, before_ns)) = self.newest() else {
            // The identity, as for the samples before this one.
            self.origin = told.inverse();
            self.keep(Quat::IDENTITY, time_ns);
            return 0.0;
        };
        let angle = {
            let seconds = (time_ns.saturating_sub(before_ns) as f64 * 1e-9) as f32;
            let angle = angle_deg(before, self.origin * told);
            if angle > FASTEST_DEG_S * seconds.abs().max(LEAST_S) {
                self.origin = before * told.inverse();
                self.deg_s = 0.0;
                0.0
            } else if seconds > 0.0 {
                self.deg_s = angle / seconds;
                angle
            } else {
                // No motion.
                0.0
            }
        };
        self.keep((self.origin * told).normalize(), time_ns);
        angle
    }

    /// Speed, degrees a second; 0 before the second orientation.
    pub(super) fn deg_s(&self) -> f32 {
        self.deg_s
    }

    fn newest(&self) -> Option<(Quat, i64)> {
        self.samples[..self.count].last().copied()
    }

    fn keep(&mut self, head: Quat, time_ns: i64) {
        while self.newest().is_some_and(|(_, newest_ns)| newest_ns >= time_ns) {
            self.count -= 1;
        }
        if self.count == KEPT {
            self.samples.rotate_left(1);
            self.count -= 1;
        }
        self.samples[self.count] = (head, time_ns);
        self.count += 1;
    }

    /// Orientation at a time, from the head's own space to the world's; constant before the first and after the newest time that is
    /// remembered. `None` if no orientation is known, so that directions stay unchanged in every bit.
    pub(super) fn at(&self, time_ns: i64) -> Option<Quat> {
        let samples = &self.samples[..self.count];
        let later = samples.partition_point(|(_, moment_ns)| *moment_ns <= time_ns);
        let (before, after) = (later.checked_sub(1).map(|index| samples[index]), samples.get(later).copied());
        match (before, after) {
            (Some((before, before_ns)), Some((after, after_ns))) => {
                let since = |ns: i64| ns.saturating_sub(before_ns) as f64;
                Some(before.slerp(after, (since(time_ns) / since(after_ns)) as f32))
            }
            (Some((only, _)), None) | (None, Some((only, _))) => Some(only),
            (None, None) => None,
        }
    }
}

/// Twice the angle of the shorter half turn; 1 - |dot| loses small ones.
fn angle_deg(a: Quat, b: Quat) -> f32 {
    2.0 * (a.inverse() * b).xyz().length().min(1.0).asin().to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    fn yaw(deg: f32) -> Quat {
        Quat::from_rotation_y(deg.to_radians())
    }

    /// A head that turns at 100 degrees a second, with an orientation every 10 ms from 0 on.
    fn turning(frames: i64) -> Head {
        let mut head = Head::default();
        for frame in 0..frames {
            head.turned(yaw(frame as f32), frame * 10 * MS);
        }
        head
    }

    /// Its turn at a time, degrees; NaN if unknown.
    fn turned_deg(head: &Head, time_ns: i64) -> f32 {
        head.at(time_ns).map_or(f32::NAN, |rotation| angle_deg(Quat::IDENTITY, rotation))
    }

    #[test]
    fn it_is_known_how_it_was_turned_at_every_time() {
        let head = turning(100);
        assert!((head.deg_s() - 100.0).abs() < 0.1);
        for (time_ms, expected_deg) in [(800, 80.0), (913, 91.3), (985, 98.5), (990, 99.0), (2000, 99.0)] {
            let angle_deg = turned_deg(&head, time_ms * MS);
            assert!((angle_deg - expected_deg).abs() < 0.01, "{angle_deg} at {time_ms}");
        }
        assert!((turned_deg(&head, i64::MIN) - 73.0).abs() < 0.01, "no more than is kept");
        assert_eq!(Head::default().at(5), None);
    }

    #[test]
    fn a_jump_of_the_space_is_no_turn() {
        let mut head = turning(100);
        assert_eq!(head.turned(yaw(-40.0), 1000 * MS), 0.0);
        assert_eq!(head.deg_s(), 0.0);
        assert!((turned_deg(&head, 1000 * MS) - 99.0).abs() < 0.01, "as if it had stood still meanwhile");
        assert!((head.turned(yaw(-39.0), 1010 * MS) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn late_and_repeated_poses_replace_earlier_ones() {
        let mut head = turning(100);
        assert_eq!(head.turned(yaw(98.5), 990 * MS), 0.0);
        assert!((turned_deg(&head, 990 * MS) - 98.5).abs() < 0.01);
        head.turned(yaw(97.0), 971 * MS);
        assert!((turned_deg(&head, 990 * MS) - 97.0).abs() < 0.01, "what came after it is forgotten");
    }
}
