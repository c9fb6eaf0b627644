//! Values of the scenario's keyframes at a time.

use crate::pose::Pose;
use crate::scenario::{Gaze, Head, Input, Zoom};
use glam::{EulerRot, Quat, Vec3};

/// The head in the LOCAL space.
pub(crate) fn head_at(frames: &[Head], t: f64) -> Pose {
    let Some((from, to, amount)) = around(frames, |frame| frame.t, t) else { return Pose::IDENTITY };
    let mix = |get: fn(&Head) -> f32| get(from) + (get(to) - get(from)) * amount;
    Pose {
        orientation: orientation(
            mix(|head| head.yaw_deg),
            mix(|head| head.pitch_deg),
            mix(|head| head.roll_deg),
        ),
        position: Vec3::from(from.position).lerp(Vec3::from(to.position), amount),
    }
}

/// The gaze in the VIEW space, or nothing while the eyes are not tracked.
pub(crate) fn gaze_at(frames: &[Gaze], t: f64) -> Option<Quat> {
    let (from, to, amount) = around(frames, |frame| frame.t, t)?;
    // The gaze cannot move towards an untracked direction.
    let to = if to.tracked { to } else { from };
    let mix = |get: fn(&Gaze) -> f32| get(from) + (get(to) - get(from)) * amount;
    from.tracked.then(|| orientation(mix(|gaze| gaze.yaw_deg), mix(|gaze| gaze.pitch_deg), 0.0))
}

/// Factor of the fields of view.
pub(crate) fn zoom_at(frames: &[Zoom], t: f64) -> f32 {
    frames.iter().rev().find(|frame| frame.t <= t).map_or(1.0, |frame| frame.scale)
}

/// Value of an input's last keyframe; `None` before the first.
pub(crate) fn input_at(frames: &[Input], path: &str, t: f64) -> Option<[f32; 2]> {
    let past = frames.iter().filter(|frame| frame.path == path && frame.t <= t);
    past.max_by(|a, b| a.t.total_cmp(&b.t)).map(|frame| frame.value.pair())
}

/// Yaw about +y, then pitch about the new +x, then roll about the new +z.
fn orientation(yaw_deg: f32, pitch_deg: f32, roll_deg: f32) -> Quat {
    Quat::from_euler(EulerRot::YXZ, yaw_deg.to_radians(), pitch_deg.to_radians(), roll_deg.to_radians())
}

/// The keyframes before and after `t`, and the position of `t` between them (0 to 1). Outside, the nearest twice.
fn around<T>(frames: &[T], time: impl Fn(&T) -> f64, t: f64) -> Option<(&T, &T, f32)> {
    let next = frames.partition_point(|frame| time(frame) <= t);
    let from = frames.get(next.saturating_sub(1))?;
    let to = frames.get(next).unwrap_or(from);
    let span = time(to) - time(from);
    let amount = if span > 0.0 { ((t - time(from)) / span).clamp(0.0, 1.0) } else { 0.0 };
    Some((from, to, amount as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gaze(t: f64, yaw_deg: f32, tracked: bool) -> Gaze {
        Gaze { t, yaw_deg, pitch_deg: 0.0, tracked }
    }

    #[test]
    fn positive_yaw_looks_left_and_positive_pitch_looks_up() {
        let forward = |yaw, pitch| orientation(yaw, pitch, 0.0) * Vec3::NEG_Z;
        assert!(forward(90.0, 0.0).abs_diff_eq(Vec3::NEG_X, 1e-6));
        assert!(forward(0.0, 90.0).abs_diff_eq(Vec3::Y, 1e-6));
    }

    #[test]
    fn heads_move_linearly_and_rest_outside_their_keyframes() {
        let key = |t, x| Head { t, position: [x, 0.0, 0.0], ..Head::default() };
        let frames = [key(1.0, 0.0), key(2.0, 4.0)];
        let x = |t| head_at(&frames, t).position.x;
        assert_eq!([x(0.0), x(1.0), x(1.25), x(2.0), x(9.0)], [0.0, 0.0, 1.0, 4.0, 4.0]);
    }

    #[test]
    fn a_gap_in_the_gaze_lasts_from_its_keyframe_to_the_next() {
        let frames = [gaze(0.0, 0.0, true), gaze(1.0, 0.0, false), gaze(2.0, 10.0, true)];
        let tracked = |t| gaze_at(&frames, t).is_some();
        assert_eq!([tracked(0.99), tracked(1.0), tracked(1.99), tracked(2.0)], [true, false, false, true]);
    }
}
