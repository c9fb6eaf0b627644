//! Haptics: checked, without any output.

use super::check_action;
use crate::abi::pointers::In;
use crate::fault::Fault;
use crate::runtime::{Runtime, call};
use openxr_sys as xr;

fn check(
    runtime: &mut Runtime,
    session: xr::Session,
    info: &In<xr::HapticActionInfo>,
) -> Result<bool, Fault> {
    let info = runtime.read(info)?;
    check_action(runtime, session, info.action, info.subaction_path, xr::ActionType::VIBRATION_OUTPUT)?;
    Ok(runtime.sessions.get(session)?.state == xr::SessionState::FOCUSED)
}

fn result(focused: bool) -> xr::Result {
    if focused { xr::Result::SUCCESS } else { xr::Result::SESSION_NOT_FOCUSED }
}

/// `xrApplyHapticFeedback`.
pub(crate) extern "system" fn apply(
    session: xr::Session,
    info: In<xr::HapticActionInfo>,
    feedback: In<xr::HapticVibration>,
) -> xr::Result {
    call("xrApplyHapticFeedback", |runtime| {
        let focused = check(runtime, session, &info)?;
        runtime.read(&feedback)?;
        Ok(result(focused))
    })
}

/// `xrStopHapticFeedback`.
pub(crate) extern "system" fn stop(session: xr::Session, info: In<xr::HapticActionInfo>) -> xr::Result {
    call("xrStopHapticFeedback", |runtime| check(runtime, session, &info).map(result))
}
