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
    /// The pose of the space in that of the action.
    offset: Pose,
}

static SPACES: Registry<xr::Space, ActionSpace> = Registry::new();

/// How many there are: without any, a locate costs no more than this.
static COUNT: AtomicUsize = AtomicUsize::new(0);

/// A space is destroyed.
pub fn forget_space(space: xr::Space) {
    if COUNT.load(Ordering::Relaxed) > 0 && SPACES.remove(space).is_some() {
        COUNT.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Forgets the spaces of a session, before it is destroyed: they go with it.
pub fn forget_all_of(session: xr::Session) {
    let removed = SPACES.remove_where(|space| space.session == session);
    COUNT.fetch_sub(removed.len(), Ordering::Relaxed);
}

/// `xrCreateActionSpace`.
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
    /// That of the head, of the same session.
    head: xr::Space,
}

impl GazeSpace {
    /// The space of that handle; `None` for a space that the runtime moves.
    fn find(handle: xr::Space) -> Option<Self> {
        if COUNT.load(Ordering::Relaxed) == 0 {
            return None;
        }
        let space = SPACES.get(handle)?;
        let session = session::find(space.session)?;
        let head = session.spaces?.head;
        let (offer, offered) = session.offered()?;
        let follows = offered.follows(space.action, space.subaction, &offer.paths);
        follows.then_some(Self { session: Arc::clone(&session), space, head })
    }

    /// Its pose in the space of the head for `time`, and when the eyes looked there; `None` while they are not seen, or the action is not
    /// active.
    fn pose(&self, time: xr::Time) -> Option<(Pose, i64)> {
        let (_, offered) = self.session.offered()?;
        if !offered.is_active(self.space.action) {
            return None;
        }
        let config = self.session.instance.config.snapshot();
        match self.session.gaze.application_look(&config, time.as_nanos()) {
            Look::At { direction, sampled_ns } => {
                Some((Pose::of_gaze(direction).then(self.space.offset), sampled_ns))
            }
            Look::Unseen | Look::NoTracker => None,
        }
    }
}

/// One of the two spaces of a locate: for the runtime, the head instead of a gaze.
struct Side {
    handle: xr::Space,
    gaze: Option<GazeSpace>,
}

impl Side {
    fn new(handle: xr::Space) -> Self {
        let gaze = GazeSpace::find(handle);
        Self { handle: gaze.as_ref().map_or(handle, |gaze| gaze.head), gaze }
    }

    /// The pose of the space in the one that the runtime was asked about, with the time of its sample; `None` where the gaze is not there.
    fn pose(&self, time: xr::Time) -> Option<(Option<Pose>, i64)> {
        match &self.gaze {
            None => Some((None, 0)),
            Some(gaze) => gaze.pose(time).map(|(pose, sampled_ns)| (Some(pose), sampled_ns)),
        }
    }
}

/// What the runtime located, turned by the gaze of either side; also the time of the sample where the space is the gaze.
fn turned(
    (located_flags, located): (xr::SpaceLocationFlags, &xr::Posef),
    space: Option<(Option<Pose>, i64)>,
    base: Option<(Option<Pose>, i64)>,
) -> Option<(xr::SpaceLocationFlags, xr::Posef, i64)> {
    let ((space, sampled_ns), (base, _)) = (space?, base?);
    let flags = flags(located_flags);
    if flags == xr::SpaceLocationFlags::EMPTY {
        return None;
    }
    let mut pose = Pose::read(located)?;
    if let Some(space) = space {
        pose = pose.then(space);
    }
    if let Some(base) = base {
        pose = base.inverse().then(pose);
    }
    Some((flags, pose.written(), sampled_ns))
}

/// `xrLocateSpace`.
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
    if COUNT.load(Ordering::Relaxed) == 0 {
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
            // SAFETY: valid usage: the structure and its chain are valid, and the application lets nobody else use them.
            let mut sample = unsafe { pnext::unlink::<xr::EyeGazeSampleTimeEXT>(&raw mut (*location).next) };
            let result = answer.record(below(from.handle, to.handle));
            if result.into_raw() < 0 {
                return result;
            }
            // SAFETY: the call succeeded, so the structure is valid.
            let location = unsafe { &mut *location };
            let found = turned((location.location_flags, &location.pose), from.pose(time), to.pose(time));
            let (flags, pose, sampled_ns) = found.unwrap_or(NOWHERE);
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
            let base = to.pose(asked.time);
            for (index, (side, data)) in from.iter().zip(located).enumerate() {
                if side.gaze.is_none() && to.gaze.is_none() {
                    continue;
                }
                let found = turned((data.location_flags, &data.pose), side.pose(asked.time), base);
                let (flags, pose, _) = found.unwrap_or(NOWHERE);
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

/// The base space of an `xrLocateViews` that the gaze moves.
pub struct ViewsBase(GazeSpace);

/// The base space of views, if the gaze moves it.
pub fn views_base(space: xr::Space) -> Option<ViewsBase> {
    GazeSpace::find(space).map(ViewsBase)
}

impl ViewsBase {
    /// The space of the head, in which the runtime locates the views.
    pub fn head(&self) -> xr::Space {
        self.0.head
    }

    /// Turns views from the space of the head to that of the gaze.
    pub fn turn(&self, time: xr::Time, state: &mut xr::ViewState, views: &mut [xr::View]) {
        let flags = xr::SpaceLocationFlags::from_raw(state.view_state_flags.into_raw());
        let base = self.0.pose(time).map(|(pose, sampled_ns)| (Some(pose), sampled_ns));
        for view in views {
            let found = turned((flags, &view.pose), Some((None, 0)), base);
            let (flags, pose, _) = found.unwrap_or(NOWHERE);
            // The bits of views mean what those of spaces mean.
            state.view_state_flags = xr::ViewStateFlags::from_raw(flags.into_raw());
            view.pose = pose;
        }
    }
}
