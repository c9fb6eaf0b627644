//! Orientation of the head, by the views that the application located. A locate by the layer may wait for another process. So it is made
//! only if the views are not enough, and every [`BETWEEN_COMPARISONS_NS`] to compare.

use super::super::session::Session;
use super::rests;
use crate::planner::head_of;
use glam::Quat;
use openxr_sys as xr;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The mean of the views is the head where the two are within this angle, radians: one degree. OpenXR puts the VIEW space between the views
/// (section 7.1, Reference Spaces) but leaves its orientation open for canted displays; a head that turns by 400 degrees a second moves by
/// less between the predictions of two calls.
const AGREEMENT_RAD: f32 = 0.0175;

/// Time between two comparisons, nanoseconds.
const BETWEEN_COMPARISONS_NS: i64 = 4_000_000_000;

/// The call that counts of several ones for a display time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precedence {
    /// The earlier one.
    EarlierCall,
    /// The present one, which plans the frame.
    ThisCall,
}

/// The head of a session, for the frames whose views were located last.
#[derive(Debug, Default)]
pub struct LocatedHead {
    state: Mutex<State>,
}

#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// Of two display times, the newest first: a thread of the application may locate the next frame's views ahead.
    views: [Option<ViewsHead>; 2],
    comparison: Option<Comparison>,
}

/// The mean of located views.
#[derive(Clone, Copy, Debug)]
struct ViewsHead {
    space: xr::Space,
    time: xr::Time,
    turn: Quat,
}

/// Result of a locate, compared with the views.
#[derive(Clone, Copy, Debug)]
struct Comparison {
    space: xr::Space,
    time: xr::Time,
    /// Whether the mean of the views is the head.
    agrees: bool,
    /// From the space to that of the world, where it rests there.
    to_world: Option<Quat>,
}

impl LocatedHead {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The application located its views in `space` for the display time of a frame, the eyes' first.
    pub fn views_located(
        &self,
        space: xr::Space,
        time: xr::Time,
        views: impl IntoIterator<Item = Quat>,
        precedence: Precedence,
    ) {
        let mut state = self.state();
        let is_known = state.views.iter().flatten().any(|views| views.time == time);
        if precedence == Precedence::EarlierCall && is_known {
            return;
        }
        let newest = head_of(views.into_iter().take(2)).map(|turn| ViewsHead { space, time, turn });
        let last = state.views.into_iter().flatten().find(|views| views.time != time);
        state.views = [newest, last];
    }

    /// The views of that time, in `space` if one is given, and their newest comparison, if that still holds.
    fn known(&self, space: Option<xr::Space>, time: xr::Time) -> Option<(ViewsHead, Option<Comparison>)> {
        let State { views, comparison } = *self.state();
        let fits = |views: &ViewsHead| views.time == time && space.is_none_or(|space| views.space == space);
        let views = views.into_iter().flatten().find(fits)?;
        let holds = |comparison: &Comparison| {
            let passed_ns = time.as_nanos().saturating_sub(comparison.time.as_nanos());
            comparison.space == views.space && (0..BETWEEN_COMPARISONS_NS).contains(&passed_ns)
        };
        Some((views, comparison.filter(holds)))
    }
}

impl Session {
    /// Orientation of the head in the world at `time`; the identity if it is unknown.
    pub fn head_in_world(&self, time: xr::Time) -> Quat {
        let known = self.head.known(None, time).map(|(views, comparison)| {
            let comparison = comparison.unwrap_or_else(|| self.compare(views));
            comparison.to_world.filter(|_| comparison.agrees).map(|to_world| to_world * views.turn)
        });
        let locate = || self.spaces.and_then(|spaces| self.locate_head(spaces.world, time));
        known.flatten().or_else(locate).unwrap_or(Quat::IDENTITY)
    }

    /// Orientation of the head in `space` at `time`; `None` if it is unknown.
    pub fn head_in(&self, space: xr::Space, time: xr::Time) -> Option<Quat> {
        let known = self.head.known(Some(space), time).map(|(views, comparison)| {
            let comparison = comparison.unwrap_or_else(|| self.compare(views));
            comparison.agrees.then_some(views.turn)
        });
        known.flatten().or_else(|| self.locate_head(space, time))
    }

    /// Compares the views with a locate, and keeps the answer.
    fn compare(&self, ViewsHead { space, time, turn }: ViewsHead) -> Comparison {
        let located = self.locate_head(space, time);
        let agrees = located.is_some_and(|located| located.angle_between(turn) < AGREEMENT_RAD);
        let world = self.spaces.map(|spaces| spaces.world).filter(|_| agrees && rests(space));
        let in_world = world.and_then(|world| self.locate_head(world, time));
        let to_world = in_world.zip(located).map(|(in_world, located)| in_world * located.inverse());
        let comparison = Comparison { space, time, agrees, to_world };
        self.head.state().comparison = Some(comparison);
        comparison
    }
}
