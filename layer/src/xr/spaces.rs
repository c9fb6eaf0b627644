//! The layer's own spaces, in which gaze and head are located, and the application's spaces that rest in the world.

mod head;
mod resting;

pub use head::{LocatedHead, Precedence};
pub use resting::{create_reference, destroy, forget_all_of, rests};

use super::dispatch::Next;
use super::session::Session;
use crate::inputs::gaze::rotation;
use glam::Quat;
use openxr_sys as xr;
use std::ffi::c_void;
use std::ptr;

/// Spaces of one session; they go with it.
#[derive(Debug, Clone, Copy)]
pub struct Spaces {
    /// Of the head: between the eyes, -z forward.
    pub head: xr::Space,
    /// One that rests in the world.
    world: xr::Space,
}

impl Spaces {
    /// Makes them; `None`, with one line in the log, where the runtime refuses.
    pub fn create(next: &Next, session: xr::Session) -> Option<Self> {
        let create = |kind| {
            let info = xr::ReferenceSpaceCreateInfo {
                ty: xr::ReferenceSpaceCreateInfo::TYPE,
                next: ptr::null(),
                reference_space_type: kind,
                pose_in_reference_space: xr::Posef::IDENTITY,
            };
            let mut space = xr::Space::default();
            // SAFETY: the next layer's function, a live session, a valid structure and a place for the handle.
            let result = unsafe { (next.create_reference_space)(session, &info, &mut space) };
            let succeeded = result.into_raw() >= 0;
            if !succeeded {
                tracing::info!("no gaze: xrCreateReferenceSpace returned {result:?}");
            }
            succeeded.then_some(space)
        };
        Some(Self {
            head: create(xr::ReferenceSpaceType::VIEW)?,
            world: create(xr::ReferenceSpaceType::LOCAL)?,
        })
    }
}

impl Session {
    /// Orientation of the head in `space` at `time`, located by the runtime.
    fn locate_head(&self, space: xr::Space, time: xr::Time) -> Option<Quat> {
        let head = self.spaces?.head;
        locate(&self.instance.next, head, space, time, xr::SpaceLocationFlags::EMPTY, ptr::null_mut())
    }
}

/// Orientation of the gaze in the space of the head at `time`, and the time of its sample, nanoseconds, 0 if unknown. `None` if the
/// eyes are not tracked.
///
/// Source: XR_EXT_eye_gaze_interaction, `XrEyeGazeSampleTimeEXT`.
pub fn gaze(next: &Next, gaze: xr::Space, head: xr::Space, time: xr::Time) -> Option<(Quat, i64)> {
    let mut sample = xr::EyeGazeSampleTimeEXT {
        ty: xr::EyeGazeSampleTimeEXT::TYPE,
        next: ptr::null_mut(),
        time: xr::Time::from_nanos(0),
    };
    let tracked = xr::SpaceLocationFlags::ORIENTATION_TRACKED;
    let turned = locate(next, gaze, head, time, tracked, (&raw mut sample).cast())?;
    Some((turned, sample.time.as_nanos()))
}

/// The orientation of one space in another at `time`, if it is valid, and `wanted` too. `extension` is null or a structure
/// that extends `XrSpaceLocation`.
fn locate(
    next: &Next,
    space: xr::Space,
    base: xr::Space,
    time: xr::Time,
    wanted: xr::SpaceLocationFlags,
    extension: *mut c_void,
) -> Option<Quat> {
    let mut location = xr::SpaceLocation {
        ty: xr::SpaceLocation::TYPE,
        next: extension,
        location_flags: xr::SpaceLocationFlags::EMPTY,
        pose: xr::Posef::IDENTITY,
    };
    // SAFETY: the next layer's function, live spaces and valid structures to write to.
    let result = unsafe { (next.locate_space)(space, base, time, &mut location) };
    let wanted = xr::SpaceLocationFlags::ORIENTATION_VALID | wanted;
    if result.into_raw() < 0 || !location.location_flags.contains(wanted) {
        return None;
    }
    let xr::Quaternionf { x, y, z, w } = location.pose.orientation;
    rotation(x, y, z, w)
}
