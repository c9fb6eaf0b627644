//! Values of actions at the newest `xrSyncActions`.

use super::check_action;
use super::sync::State;
use crate::abi::pointers::{In, Out};
use crate::fault::Fault;
use crate::runtime::{Runtime, call};
use openxr_sys as xr;
use openxr_sys::Handle;

fn read(
    runtime: &mut Runtime,
    session: xr::Session,
    info: &In<xr::ActionStateGetInfo>,
    ty: xr::ActionType,
) -> Result<State, Fault> {
    let info = runtime.read(info)?;
    check_action(runtime, session, info.action, info.subaction_path, ty)?;
    let states = &runtime.sessions.get(session)?.input.states;
    Ok(states.get(&(info.action.into_raw(), info.subaction_path)).copied().unwrap_or_default())
}

/// Threshold at which an analog input counts as pressed.
const PRESSED: f32 = 0.5;

/// `xrGetActionStateBoolean`.
pub(crate) extern "system" fn get_boolean(
    session: xr::Session,
    info: In<xr::ActionStateGetInfo>,
    mut state: Out<xr::ActionStateBoolean>,
) -> xr::Result {
    call("xrGetActionStateBoolean", |runtime| {
        let read = read(runtime, session, &info, xr::ActionType::BOOLEAN_INPUT)?;
        let filled = state.get()?;
        filled.current_state = (read.value[0] > PRESSED).into();
        filled.changed_since_last_sync = read.changed.into();
        filled.last_change_time = xr::Time::from_nanos(read.last_change);
        filled.is_active = read.active.into();
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrGetActionStateFloat`.
pub(crate) extern "system" fn get_float(
    session: xr::Session,
    info: In<xr::ActionStateGetInfo>,
    mut state: Out<xr::ActionStateFloat>,
) -> xr::Result {
    call("xrGetActionStateFloat", |runtime| {
        let read = read(runtime, session, &info, xr::ActionType::FLOAT_INPUT)?;
        let filled = state.get()?;
        filled.current_state = read.value[0];
        filled.changed_since_last_sync = read.changed.into();
        filled.last_change_time = xr::Time::from_nanos(read.last_change);
        filled.is_active = read.active.into();
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrGetActionStateVector2f`.
pub(crate) extern "system" fn get_vector2f(
    session: xr::Session,
    info: In<xr::ActionStateGetInfo>,
    mut state: Out<xr::ActionStateVector2f>,
) -> xr::Result {
    call("xrGetActionStateVector2f", |runtime| {
        let read = read(runtime, session, &info, xr::ActionType::VECTOR2F_INPUT)?;
        let filled = state.get()?;
        filled.current_state = xr::Vector2f { x: read.value[0], y: read.value[1] };
        filled.changed_since_last_sync = read.changed.into();
        filled.last_change_time = xr::Time::from_nanos(read.last_change);
        filled.is_active = read.active.into();
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrGetActionStatePose`.
pub(crate) extern "system" fn get_pose(
    session: xr::Session,
    info: In<xr::ActionStateGetInfo>,
    mut state: Out<xr::ActionStatePose>,
) -> xr::Result {
    call("xrGetActionStatePose", |runtime| {
        let read = read(runtime, session, &info, xr::ActionType::POSE_INPUT)?;
        state.get()?.is_active = read.active.into();
        Ok(xr::Result::SUCCESS)
    })
}
