//! Spaces, and where one is in another.

use crate::abi::pointers::{In, List, Out};
use crate::actions;
use crate::fault::{Fault, section};
use crate::pose::Pose;
use crate::runtime::{Runtime, call};
use crate::scenario::Answer;
use crate::script;
use glam::{Quat, Vec3};
use openxr_sys as xr;
use openxr_sys::{ReferenceSpaceType, SpaceLocationFlags};

/// An `XrSpace`.
pub(crate) struct Space {
    pub session: xr::Session,
    origin: Origin,
    /// Its pose in the space of its origin.
    offset: Pose,
}

/// Origin of a space.
enum Origin {
    Reference(ReferenceSpaceType),
    Action { action: xr::Action, subaction: xr::Path },
}

/// Types of reference spaces of an instance.
fn reference_types(runtime: &Runtime, session: xr::Session) -> Result<Vec<ReferenceSpaceType>, Fault> {
    let (_, instance) = runtime.session_and_instance(session)?;
    let mut types = vec![ReferenceSpaceType::VIEW, ReferenceSpaceType::LOCAL, ReferenceSpaceType::STAGE];
    types.extend(instance.is_1_1().then_some(ReferenceSpaceType::LOCAL_FLOOR));
    Ok(types)
}

fn check_reference_type(
    runtime: &Runtime,
    session: xr::Session,
    ty: ReferenceSpaceType,
) -> Result<(), Fault> {
    let types = reference_types(runtime, session)?;
    if types.contains(&ty) {
        return Ok(());
    }
    let message = format!("{ty:?} is not supported; {types:?} are");
    Err(Fault::new(xr::Result::ERROR_REFERENCE_SPACE_UNSUPPORTED, section::REFERENCE_SPACES, message))
}

/// `xrEnumerateReferenceSpaces`.
pub(crate) extern "system" fn enumerate_reference_spaces(
    session: xr::Session,
    capacity: u32,
    count: Out<u32>,
    items: Out<ReferenceSpaceType>,
) -> xr::Result {
    call("xrEnumerateReferenceSpaces", |runtime| {
        List { capacity, count, items }.fill("spaces", &reference_types(runtime, session)?)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrCreateReferenceSpace`.
pub(crate) extern "system" fn create_reference_space(
    session: xr::Session,
    info: In<xr::ReferenceSpaceCreateInfo>,
    space: Out<xr::Space>,
) -> xr::Result {
    call("xrCreateReferenceSpace", |runtime| {
        let info = runtime.read(&info)?;
        check_reference_type(runtime, session, info.reference_space_type)?;
        let created = Space {
            session,
            origin: Origin::Reference(info.reference_space_type),
            offset: Pose::checked("poseInReferenceSpace", &info.pose_in_reference_space)?,
        };
        space.set("space", runtime.spaces.insert(&mut runtime.serial, created))?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrGetReferenceSpaceBoundsRect`: a stage of 3 by 3 metres; the other spaces have no bounds.
pub(crate) extern "system" fn get_reference_space_bounds(
    session: xr::Session,
    ty: ReferenceSpaceType,
    bounds: Out<xr::Extent2Df>,
) -> xr::Result {
    call("xrGetReferenceSpaceBoundsRect", |runtime| {
        check_reference_type(runtime, session, ty)?;
        let side = if ty == ReferenceSpaceType::STAGE { 3.0 } else { 0.0 };
        bounds.set("bounds", xr::Extent2Df { width: side, height: side })?;
        let known = ty == ReferenceSpaceType::STAGE;
        Ok(if known { xr::Result::SUCCESS } else { xr::Result::SPACE_BOUNDS_UNAVAILABLE })
    })
}

/// `xrCreateActionSpace`.
pub(crate) extern "system" fn create_action_space(
    session: xr::Session,
    info: In<xr::ActionSpaceCreateInfo>,
    space: Out<xr::Space>,
) -> xr::Result {
    call("xrCreateActionSpace", |runtime| {
        let info = runtime.read(&info)?;
        runtime.sessions.get(session)?;
        let action = runtime.actions.get(info.action)?;
        if action.ty != xr::ActionType::POSE_INPUT {
            let message = format!("{} is no pose action", action.name);
            return Err(Fault::new(xr::Result::ERROR_ACTION_TYPE_MISMATCH, section::ACTION_SPACES, message));
        }
        if runtime.scenario.quirks.no_early_spaces {
            actions::check_attached(runtime, session, action)?;
        }
        actions::check_subaction(runtime, session, info.action, info.subaction_path)?;
        let created = Space {
            session,
            origin: Origin::Action { action: info.action, subaction: info.subaction_path },
            offset: Pose::checked("poseInActionSpace", &info.pose_in_action_space)?,
        };
        space.set("space", runtime.spaces.insert(&mut runtime.serial, created))?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrDestroySpace`.
pub(crate) extern "system" fn destroy(space: xr::Space) -> xr::Result {
    call("xrDestroySpace", |runtime| {
        runtime.spaces.remove(space)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// A time as a parameter: positive.
pub(crate) fn check_time(time: xr::Time, section: &'static str) -> Result<i64, Fault> {
    match time.as_nanos() {
        nanoseconds if nanoseconds > 0 => Ok(nanoseconds),
        other => {
            let message = format!("the time is {other}, which is not positive");
            Err(Fault::new(xr::Result::ERROR_TIME_INVALID, section, message))
        }
    }
}

/// The head in the LOCAL space.
pub(crate) fn head(runtime: &Runtime, time: i64) -> Pose {
    script::head_at(&runtime.scenario.head, runtime.clock.scenario_seconds(time))
}

/// A space in the LOCAL space; `None` if its origin is not tracked.
pub(crate) fn in_local(runtime: &Runtime, space: xr::Space, time: i64) -> Result<Option<Pose>, Fault> {
    let space = runtime.spaces.get(space)?;
    let origin = match space.origin {
        Origin::Reference(ReferenceSpaceType::VIEW) => Some(head(runtime, time)),
        Origin::Reference(ReferenceSpaceType::LOCAL) => Some(Pose::IDENTITY),
        // STAGE and LOCAL_FLOOR: the floor below the origin of LOCAL.
        Origin::Reference(_) => {
            let floor = Vec3::NEG_Y * runtime.scenario.system.eye_height;
            Some(Pose { orientation: Quat::IDENTITY, position: floor })
        }
        Origin::Action { action, subaction } => {
            actions::pose::in_local(runtime, space.session, action, subaction, time)
        }
    };
    Ok(origin.map(|origin| origin.then(space.offset)))
}

const TRACKED: [SpaceLocationFlags; 4] = [
    SpaceLocationFlags::ORIENTATION_VALID,
    SpaceLocationFlags::POSITION_VALID,
    SpaceLocationFlags::ORIENTATION_TRACKED,
    SpaceLocationFlags::POSITION_TRACKED,
];

fn located(
    runtime: &Runtime,
    space: xr::Space,
    base: xr::Space,
    time: i64,
) -> Result<(SpaceLocationFlags, Pose), Fault> {
    if runtime.spaces.get(space)?.session != runtime.spaces.get(base)?.session {
        return Err(Fault::validation(section::LOCATING, "space and baseSpace belong to different sessions"));
    }
    Ok(match (in_local(runtime, space, time)?, in_local(runtime, base, time)?) {
        (Some(space), Some(base)) => {
            let flags = TRACKED.into_iter().fold(SpaceLocationFlags::EMPTY, |all, flag| all | flag);
            (flags, base.inverse().then(space))
        }
        _ => (SpaceLocationFlags::EMPTY, Pose::IDENTITY),
    })
}

/// `xrLocateSpace`. Velocities are never valid.
pub(crate) extern "system" fn locate(
    space: xr::Space,
    base: xr::Space,
    time: xr::Time,
    mut location: Out<xr::SpaceLocation>,
) -> xr::Result {
    wait_for_lock();
    call("xrLocateSpace", |runtime| {
        runtime.spaces.get(space)?;
        runtime.spaces.get(base)?;
        let time = check_time(time, section::LOCATING)?;
        let (flags, pose) = match (runtime.answer, located(runtime, space, base, time)?) {
            (Answer::Untracked, (_, pose)) => (SpaceLocationFlags::EMPTY, pose),
            (Answer::Nan, (flags, _)) => {
                (flags, Pose { orientation: Quat::from_array([f32::NAN; 4]), position: Vec3::NAN })
            }
            (_, there) => there,
        };
        let session = runtime.spaces.get(space)?.session;
        let is_gaze = follows_gaze(runtime, space)?;
        if is_gaze && !flags.is_empty() {
            runtime.sessions.get_mut(session)?.frames.gaze_reads += 1;
        }
        let filled = location.get()?;
        (filled.location_flags, filled.pose) = (flags, pose.to_xr());
        if let Some(velocity) = location.extension::<xr::SpaceVelocity>() {
            velocity.velocity_flags = xr::SpaceVelocityFlags::EMPTY;
        }
        if let Some(sample) = location.extension::<xr::EyeGazeSampleTimeEXT>() {
            let is_known = is_gaze && !flags.is_empty() && runtime.scenario.tracker.sample_time;
            let time = if is_known { actions::pose::sampled_at(runtime, session, time) } else { 0 };
            sample.time = xr::Time::from_nanos(time);
        }
        Ok(xr::Result::SUCCESS)
    })
}

/// A runtime whose answer waits for another process: for the lock that the scenario names. Nothing else waits meanwhile.
fn wait_for_lock() {
    let lock = crate::runtime::quirks().locate_lock;
    if lock.as_os_str().is_empty() {
        return;
    }
    let locked = std::fs::File::open(&lock).and_then(|file| file.lock());
    if let Err(error) = locked {
        eprintln!("parafovea mock runtime: {}: {error}", lock.display());
    }
}

fn follows_gaze(runtime: &Runtime, space: xr::Space) -> Result<bool, Fault> {
    let space = runtime.spaces.get(space)?;
    Ok(match space.origin {
        Origin::Reference(_) => false,
        Origin::Action { action, subaction } => {
            actions::pose::is_gaze(runtime, space.session, action, subaction)
        }
    })
}

/// `xrLocateSpaces`. Velocities are never valid.
pub(crate) extern "system" fn locate_many(
    session: xr::Session,
    info: In<xr::SpacesLocateInfo>,
    mut locations: Out<xr::SpaceLocations>,
) -> xr::Result {
    call("xrLocateSpaces", |runtime| {
        let info = runtime.read(&info)?;
        runtime.sessions.get(session)?;
        let time = check_time(info.time, section::LOCATING)?;
        if runtime.spaces.get(info.base_space)?.session != session {
            return Err(Fault::validation(section::LOCATING, "baseSpace belongs to another session"));
        }
        let spaces = info.spaces()?;
        let filled = locations.get_locations()?;
        if spaces.is_empty() || filled.len() != spaces.len() {
            let (wanted, found) = (spaces.len(), filled.len());
            let message =
                format!("spaceCount is {wanted}, locationCount {found}; both must be the same, not 0");
            return Err(Fault::validation(section::LOCATING, message));
        }
        for (filled, space) in filled.iter_mut().zip(spaces) {
            let (flags, pose) = located(runtime, *space, info.base_space, time)?;
            *filled = xr::SpaceLocationData { location_flags: flags, pose: pose.to_xr() };
        }
        for velocity in locations.get_velocities()? {
            velocity.velocity_flags = xr::SpaceVelocityFlags::EMPTY;
        }
        Ok(xr::Result::SUCCESS)
    })
}
