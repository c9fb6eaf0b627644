//! Gaze as a frame needs it: a direction, or none.
//!
//! Directions are in the space of a projection layer, in which its views are posed too. All are unit vectors.
//! Quaternions rotate from a view to that space; view space looks along -z.

use glam::{Quat, Vec3};

/// Where a view looks, in its own space.
pub const FORWARD: Vec3 = Vec3::NEG_Z;

/// An orientation as OpenXR gives it, made a unit quaternion; `None` for one that is no rotation.
pub fn rotation(x: f32, y: f32, z: f32, w: f32) -> Option<Quat> {
    let quaternion = Quat::from_xyzw(x, y, z, w);
    let length = quaternion.length();
    (length.is_finite() && length > 0.5).then(|| quaternion.normalize())
}

/// Straight ahead: the mean of where the views look, so that canted displays agree on one direction.
pub fn straight_ahead(views: impl Iterator<Item = Quat>) -> Option<Vec3> {
    views.map(|view| view * FORWARD).sum::<Vec3>().try_normalize()
}

/// `direction` as seen from a view.
pub fn in_view(direction: Vec3, view: Quat) -> Vec3 {
    view.inverse() * direction
}

/// Keeps the last gaze for a while after it is lost, as in a blink.
#[derive(Debug, Default)]
pub struct Hold {
    last: Option<Held>,
}

/// A gaze relative to the head, with which it moves while it is kept: an image is kept as it is, too.
#[derive(Debug, Clone, Copy)]
struct Held {
    in_head: Vec3,
    at_nanos: i64,
}

impl Hold {
    /// The gaze to use at display time `now_nanos`: `tracked` itself, or the last one if it is not older
    /// than `hold_nanos`. `head` is the orientation of the head then. A tracked direction away from where
    /// the head points is not believed: some runtimes give the opposite one (peers: Pimax via SteamVR).
    pub fn update(
        &mut self,
        tracked: Option<Vec3>,
        head: Quat,
        now_nanos: i64,
        hold_nanos: i64,
    ) -> Option<Vec3> {
        let believed =
            tracked.map(|direction| in_view(direction, head)).filter(|seen| seen.dot(FORWARD) > 0.0);
        if let Some(in_head) = believed {
            self.last = Some(Held { in_head, at_nanos: now_nanos });
        }
        // Display times can go back, where a runtime starts its clock anew: nothing is kept across that.
        let age = |held: &Held| now_nanos.saturating_sub(held.at_nanos);
        let held = self.last.filter(|held| believed.is_some() || (0..=hold_nanos).contains(&age(held)))?;
        Some(head * held.in_head)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

    const MS: i64 = 1_000_000;

    #[test]
    fn a_lost_gaze_is_kept_for_the_hold_time_and_turns_with_the_head() {
        let mut hold = Hold::default();
        let left_45 = Quat::from_rotation_y(FRAC_PI_4) * FORWARD;
        assert_eq!(hold.update(None, Quat::IDENTITY, 0, 500 * MS), None);
        assert!(
            hold.update(Some(left_45), Quat::IDENTITY, 10 * MS, 500 * MS).unwrap().abs_diff_eq(left_45, 1e-6)
        );
        let turned = Quat::from_rotation_y(FRAC_PI_4);
        let kept = hold.update(None, turned, 510 * MS, 500 * MS).unwrap();
        assert!(kept.abs_diff_eq(Vec3::NEG_X, 1e-6), "{kept}");
        assert_eq!(hold.update(None, turned, 511 * MS, 500 * MS), None);
    }

    #[test]
    fn without_hold_time_a_lost_gaze_is_gone_at_once() {
        let mut hold = Hold::default();
        assert!(hold.update(Some(FORWARD), Quat::IDENTITY, 5 * MS, 0).is_some());
        assert_eq!(hold.update(None, Quat::IDENTITY, 6 * MS, 0), None);
    }

    #[test]
    fn a_gaze_out_of_the_back_of_the_head_is_not_believed() {
        let mut hold = Hold::default();
        assert_eq!(hold.update(Some(Vec3::Z), Quat::IDENTITY, 0, 500 * MS), None);
        let head = Quat::from_rotation_y(std::f32::consts::PI);
        assert!(hold.update(Some(Vec3::Z), head, 0, 500 * MS).is_some());
    }

    #[test]
    fn a_clock_that_went_back_ends_the_hold() {
        let mut hold = Hold::default();
        assert!(hold.update(Some(FORWARD), Quat::IDENTITY, 900 * MS, 500 * MS).is_some());
        assert_eq!(hold.update(None, Quat::IDENTITY, 0, 500 * MS), None);
    }

    #[test]
    fn canted_views_agree_on_straight_ahead() {
        let cant = 0.2;
        let views = [Quat::from_rotation_y(cant), Quat::from_rotation_y(-cant)];
        let ahead = straight_ahead(views.into_iter()).unwrap();
        assert!(ahead.abs_diff_eq(FORWARD, 1e-6));
        assert!(in_view(ahead, views[0]).x > 0.0, "the left display is turned left: ahead is to its right");
        let opposite = [Quat::IDENTITY, Quat::from_rotation_y(2.0 * FRAC_PI_2)];
        assert!(straight_ahead(opposite.into_iter()).is_none_or(|ahead| ahead.is_finite()));
    }

    #[test]
    fn what_is_no_rotation_is_refused() {
        assert_eq!(rotation(0.0, 0.0, 0.0, 0.0), None);
        assert_eq!(rotation(f32::NAN, 0.0, 0.0, 1.0), None);
        assert_eq!(rotation(0.0, 0.0, 0.0, 1.1), Some(Quat::IDENTITY));
    }
}
