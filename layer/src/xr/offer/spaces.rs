//! Spaces of actions that the gaze drives. They are the runtime's, which has no pose for them; locating one is locating the head, and
//! turning that.

use super::hooks::offering;
use super::pose::{Pose, flags};
use crate::abi::{guard, pnext};
use crate::inputs::gaze::Look;
use crate::registry::Registry;
use crate::xr::session::{self, Session};
use openxr_sys as xr;
use smallvec::SmallVec;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The space of an action, in an application that asked for eye gaze.
#[derive(Debug)]
struct ActionSpace {
    session: xr::Session,
    action: xr::Action,
    subaction: xr::Path,
    /// The pose of the space in the action's space.
    offset: Pose,
}

static SPACES: Registry<xr::Space, ActionSpace> = Registry::new();

/// Number of entries in [`SPACES`]: without any, a locate only reads this number.
static COUNT: AtomicUsize = AtomicUsize::new(0);

/// Whether there is any.
pub fn has_spaces() -> bool {
    COUNT.load(Ordering::Relaxed) > 0
}

/// A space is destroyed.
pub fn forget_space(space: xr::Space) {
    if has_spaces() && SPACES.remove(space).is_some() {
        COUNT.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Forgets the spaces of a session, before it is destroyed: they go with it.
pub fn forget_all_of(session: xr::Session) {
    let removed = SPACES.remove_where(|space| space.session == session);
    COUNT.fetch_sub(removed.len(), Ordering::Relaxed);
}

/// `xrCreateActionSpace`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create_action_space(
    handle: xr::Session,
    info: *const xr::ActionSpaceCreateInfo,
    space: *mut xr::Space,
) -> xr::Result {
    let known = session::find(handle);
    let Some(instance) = offering(known.as_ref()) else { return xr::Result::ERROR_HANDLE_INVALID };
    let Some(offer) = &instance.offer else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments, or our copy of one.
    let below = |info| unsafe { (offer.next.create_action_space)(handle, info, space) };
    guard(
        "xrCreateActionSpace",
        || below(info),
        |answer| {
            // SAFETY: valid usage: `info` is valid.
            let Some(asked) = (unsafe { info.as_ref() }) else { return answer.record(below(info)) };
            let subaction_path = offer.subaction_below(asked.action, asked.subaction_path);
            let result = answer.record(below(&xr::ActionSpaceCreateInfo { subaction_path, ..*asked }));
            let is_offered = known.as_ref().is_some_and(|known| known.offer.is_some());
            if let (true, true, Some(offset)) =
                (result.into_raw() >= 0, is_offered, Pose::read(&asked.pose_in_action_space))
            {
                let made = ActionSpace {
                    session: handle,
                    action: asked.action,
                    subaction: asked.subaction_path,
                    offset,
                };
                // SAFETY: the call succeeded, so `space` points to the new handle.
                let space = unsafe { *space };
                forget_space(space);
                SPACES.insert(space, Arc::new(made));
                COUNT.fetch_add(1, Ordering::Relaxed);
            }
            result
        },
    )
}

/// A space that the gaze moves.
pub struct GazeSpace {
    session: Arc<Session>,
    space: Arc<ActionSpace>,
    /// The head's space, of the same session.
    head: xr::Space,
}

impl GazeSpace {
    /// The space of that handle; `None` for a space that the runtime moves.
    pub fn find(handle: xr::Space) -> Option<Self> {
        if !has_spaces() {
            return None;
        }
        let space = SPACES.get(handle)?;
        let session = session::find(space.session)?;
        let head = session.spaces?.head;
        let (offer, offered) = session.offered()?;
        let follows = offered.follows(space.action, space.subaction, &offer.paths);
        follows.then_some(Self { session: Arc::clone(&session), space, head })
    }

    /// Its pose in the space of the head for `time`.
    fn placement(&self, time: xr::Time) -> Placement {
        if !self.session.offered().is_some_and(|(_, offered)| offered.is_active(self.space.action)) {
            return Placement::Nowhere;
        }
        let config = self.session.instance.config.snapshot();
        match self.session.gaze.application_look(&config, time.as_nanos()) {
            Look::At { direction, sampled_ns, .. } => {
                Placement::Gaze { pose: Pose::of_gaze(direction).then(self.space.offset), sampled_ns }
            }
            Look::Unseen | Look::NoTracker => Placement::Nowhere,
        }
    }

    /// The same for a composition layer; `None` if it has none: then the runtime does not show the layer.
    pub fn pose_in_head(&self, time: xr::Time) -> Option<Pose> {
        match self.placement(time) {
            Placement::Gaze { pose, .. } => Some(pose),
            Placement::Same | Placement::Nowhere => None,
        }
    }

    /// The space of the head, in which the runtime locates.
    pub fn head(&self) -> xr::Space {
        self.head
    }
}

/// One of the two spaces of a locate: for the runtime, the head instead of a gaze.
struct Side {
    handle: xr::Space,
    gaze: Option<GazeSpace>,
}

/// Pose of a side in the space that the runtime was asked about.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Placement {
    /// The same space.
    Same,
    /// The pose of the gaze, in the space of the head.
    Gaze {
        pose: Pose,
        /// Time at which the eyes looked there.
        sampled_ns: i64,
    },
    /// None: the eyes are not seen, or the action is not active.
    Nowhere,
}

impl Side {
    fn new(handle: xr::Space) -> Self {
        let gaze = GazeSpace::find(handle);
        Self { handle: gaze.as_ref().map_or(handle, |gaze| gaze.head), gaze }
    }

    fn placement(&self, time: xr::Time) -> Placement {
        self.gaze.as_ref().map_or(Placement::Same, |gaze| gaze.placement(time))
    }
}

/// Converts the runtime's location into that of `space` relative to `base`; for the gaze, the runtime located the head instead. The time is that
/// of the sample if `space` is the gaze, else 0. [`NOWHERE`] if either has no pose.
fn turned(
    (located_flags, located): (xr::SpaceLocationFlags, &xr::Posef),
    space: Placement,
    base: Placement,
) -> (xr::SpaceLocationFlags, xr::Posef, i64) {
    let flags = flags(located_flags);
    let Some(located) = Pose::read(located).filter(|_| flags != xr::SpaceLocationFlags::EMPTY) else {
        return NOWHERE;
    };
    let (of_space, sampled_ns) = match space {
        Placement::Same => (located, 0),
        Placement::Gaze { pose, sampled_ns } => (located.then(pose), sampled_ns),
        Placement::Nowhere => return NOWHERE,
    };
    let pose = match base {
        Placement::Same => of_space,
        Placement::Gaze { pose, .. } => pose.inverse().then(of_space),
        Placement::Nowhere => return NOWHERE,
    };
    (flags, pose.written(), sampled_ns)
}

/// `xrLocateSpace`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn locate(
    space: xr::Space,
    base: xr::Space,
    time: xr::Time,
    location: *mut xr::SpaceLocation,
) -> xr::Result {
    let Some(instance) = offering(None) else { return xr::Result::ERROR_HANDLE_INVALID };
    let Some(offer) = &instance.offer else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments, or live spaces of the same session.
    let below = |space, base| unsafe { (offer.next.locate_space)(space, base, time, location) };
    if !has_spaces() {
        return below(space, base);
    }
    guard(
        "xrLocateSpace",
        || below(space, base),
        |answer| {
            let (from, to) = (Side::new(space), Side::new(base));
            if (from.gaze.is_none() && to.gaze.is_none()) || location.is_null() {
                return answer.record(below(space, base));
            }
            // SAFETY: valid usage: the structure and its chain are valid, and the application lets no other code use them.
            let mut sample = unsafe { pnext::unlink::<xr::EyeGazeSampleTimeEXT>(&raw mut (*location).next) };
            let result = answer.record(below(from.handle, to.handle));
            if result.into_raw() < 0 {
                return result;
            }
            // SAFETY: the call succeeded, so the structure is valid.
            let location = unsafe { &mut *location };
            let located = (location.location_flags, &location.pose);
            let (flags, pose, sampled_ns) = turned(located, from.placement(time), to.placement(time));
            (location.location_flags, location.pose) = (flags, pose);
            if let Some(sample) = &mut sample {
                sample.get().time = xr::Time::from_nanos(sampled_ns);
            }
            // SAFETY: as above. How fast the eyes move is not known.
            if let Some(mut velocity) = unsafe { pnext::unlink::<xr::SpaceVelocity>(&raw mut location.next) }
            {
                velocity.get().velocity_flags = xr::SpaceVelocityFlags::EMPTY;
            }
            result
        },
    )
}

/// A location without a pose.
const NOWHERE: (xr::SpaceLocationFlags, xr::Posef, i64) =
    (xr::SpaceLocationFlags::EMPTY, xr::Posef::IDENTITY, 0);

/// `xrLocateSpaces`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn locate_many(
    handle: xr::Session,
    info: *const xr::SpacesLocateInfo,
    locations: *mut xr::SpaceLocations,
) -> xr::Result {
    let known = session::find(handle);
    let Some(instance) = offering(known.as_ref()) else { return xr::Result::ERROR_HANDLE_INVALID };
    let next = instance.offer.as_ref().and_then(|offer| offer.next.locate_spaces);
    let Some(next) = next else { return xr::Result::ERROR_FUNCTION_UNSUPPORTED };
    // SAFETY: the next layer's function with the application's own arguments, or our copy of one.
    let below = |info| unsafe { next(handle, info, locations) };
    guard(
        "xrLocateSpaces",
        || below(info),
        |answer| {
            // SAFETY: valid usage: `info` is valid.
            let asked = unsafe { info.as_ref() }.filter(|asked| !asked.spaces.is_null());
            let Some(asked) = asked.filter(|_| !locations.is_null()) else {
                return answer.record(below(info));
            };
            // SAFETY: valid usage: an array of that many spaces.
            let spaces = unsafe { std::slice::from_raw_parts(asked.spaces, asked.space_count as usize) };
            let to = Side::new(asked.base_space);
            let from: SmallVec<[Side; 8]> = spaces.iter().map(|space| Side::new(*space)).collect();
            if to.gaze.is_none() && from.iter().all(|side| side.gaze.is_none()) {
                return answer.record(below(info));
            }
            let handles: SmallVec<[xr::Space; 8]> = from.iter().map(|side| side.handle).collect();
            let result = answer.record(below(&xr::SpacesLocateInfo {
                base_space: to.handle,
                spaces: handles.as_ptr(),
                ..*asked
            }));
            if result.into_raw() < 0 {
                return result;
            }
            // SAFETY: the call succeeded, so the structure has as many locations as there are spaces.
            let located = unsafe { std::slice::from_raw_parts_mut((*locations).locations, from.len()) };
            // SAFETY: as above, and its chain is valid.
            let mut velocities = unsafe { pnext::unlink::<xr::SpaceVelocities>(&raw mut (*locations).next) };
            let base = to.placement(asked.time);
            for (index, (side, data)) in from.iter().zip(located).enumerate() {
                if side.gaze.is_none() && to.gaze.is_none() {
                    continue;
                }
                let located = (data.location_flags, &data.pose);
                let (flags, pose, _) = turned(located, side.placement(asked.time), base);
                (data.location_flags, data.pose) = (flags, pose);
                if let Some(velocities) = &mut velocities {
                    let velocities = velocities.get();
                    if index < velocities.velocity_count as usize && !velocities.velocities.is_null() {
                        // SAFETY: valid usage: an array of that many velocities.
                        unsafe {
                            (*velocities.velocities.add(index)).velocity_flags =
                                xr::SpaceVelocityFlags::EMPTY;
                        }
                    }
                }
            }
            result
        },
    )
}

impl GazeSpace {
    /// Turns the views of an `xrLocateViews` from the space of the head to this one.
    pub fn turn_views(&self, time: xr::Time, state: &mut xr::ViewState, views: &mut [xr::View]) {
        // Views and spaces have the same bits.
        let located = xr::SpaceLocationFlags::from_raw(state.view_state_flags.into_raw());
        let base = self.placement(time);
        for view in views {
            let (flags, pose, _) = turned((located, &view.pose), Placement::Same, base);
            state.view_state_flags = xr::ViewStateFlags::from_raw(flags.into_raw());
            view.pose = pose;
        }
    }
}
