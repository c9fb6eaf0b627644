//! Locations of pose actions.

use super::bindings::Binding;
use super::profiles::EYES;
use crate::pose::Pose;
use crate::runtime::Runtime;
use crate::{script, spaces};
use glam::{Quat, Vec3};
use openxr_sys as xr;

/// The binding that an action, limited to a subaction path, follows since the newest `xrSyncActions`.
fn binding(
    runtime: &Runtime,
    session: xr::Session,
    action: xr::Action,
    subaction: xr::Path,
) -> Option<&Binding> {
    let (session, instance) = runtime.session_and_instance(session).ok()?;
    let user = if subaction == xr::Path::NULL { None } else { Some(instance.paths.text(subaction).ok()?) };
    let mut active = session.input.active.iter();
    active.find(|binding| binding.action == action && user.is_none_or(|user| user == binding.user))
}

/// Whether an action follows the gaze.
pub(crate) fn is_gaze(
    runtime: &Runtime,
    session: xr::Session,
    action: xr::Action,
    subaction: xr::Path,
) -> bool {
    binding(runtime, session, action, subaction).is_some_and(|binding| binding.user == EYES)
}

/// Time of the gaze sample that the tracker reports at `time`.
pub(crate) fn sampled_at(runtime: &Runtime, session: xr::Session, time: i64) -> i64 {
    let tracker = &runtime.scenario.tracker;
    let located = runtime.sessions.get(session).ok().and_then(|session| session.frames.views_located);
    let newer_ms = if located == Some(time) { tracker.newer_at_views_ms } else { 0.0 };
    time - ((tracker.latency_ms - newer_ms) * 1e6) as i64
}

/// Position of the right hand in the LOCAL space; mirrored for the left one.
const RIGHT_HAND: Vec3 = Vec3::new(0.2, -0.3, -0.5);

/// An action's pose in the LOCAL space; `None` while it is not active, or its source is not tracked.
pub(crate) fn in_local(
    runtime: &Runtime,
    session: xr::Session,
    action: xr::Action,
    subaction: xr::Path,
    time: i64,
) -> Option<Pose> {
    let binding = binding(runtime, session, action, subaction)?;
    let resting = |position| Some(Pose { orientation: Quat::IDENTITY, position });
    match binding.user {
        EYES => {
            let seconds = runtime.clock.scenario_seconds(sampled_at(runtime, session, time));
            let forward = script::gaze_at(&runtime.scenario.gaze, seconds)?;
            let half_turn = Quat::from_rotation_y(std::f32::consts::PI);
            let orientation = if runtime.scenario.tracker.backwards { forward * half_turn } else { forward };
            // The gaze begins between the eyes.
            Some(spaces::head(runtime, time).then(Pose { orientation, position: Vec3::ZERO }))
        }
        "/user/hand/left" => resting(RIGHT_HAND * Vec3::new(-1.0, 1.0, 1.0)),
        "/user/hand/right" => resting(RIGHT_HAND),
        _ => None,
    }
}
