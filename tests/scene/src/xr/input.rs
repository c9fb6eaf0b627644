//! The controllers: the menu button of either hand ends the application. And the eyes, where foveation wants them.

use anyhow::Result;
use glam::{Quat, Vec3};
use openxr as xr;

/// The one action set, attached to the session.
pub struct Input {
    set: xr::ActionSet,
    quit: xr::Action<bool>,
    eyes: Option<Eyes>,
}

/// The gaze.
struct Eyes {
    action: xr::Action<xr::Posef>,
    gaze: xr::Space,
    view: xr::Space,
    /// Last tracked direction in VIEW, so that a blink changes nothing; the centre of the view before the first.
    direction: Vec3,
}

impl Input {
    /// Makes the action set, suggests bindings for the simple controller, and attaches it; with the gaze if
    /// `with_eyes`, which needs XR_EXT_eye_gaze_interaction.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn attach(
        instance: &xr::Instance,
        session: &xr::Session<xr::Vulkan>,
        with_eyes: bool,
    ) -> Result<Self> {
        let set = instance.create_action_set("courtyard", "Courtyard", 0)?;
        let quit = set.create_action::<bool>("quit", "Leave the courtyard", &[])?;
        let path = |text| instance.string_to_path(text);
        instance.suggest_interaction_profile_bindings(
            path("/interaction_profiles/khr/simple_controller")?,
            &[
                xr::Binding::new(&quit, path("/user/hand/left/input/menu/click")?),
                xr::Binding::new(&quit, path("/user/hand/right/input/menu/click")?),
            ],
        )?;
        let look = with_eyes
            .then(|| -> Result<_> {
                let action = set.create_action::<xr::Posef>("look", "Look", &[])?;
                instance.suggest_interaction_profile_bindings(
                    path("/interaction_profiles/ext/eye_gaze_interaction")?,
                    &[xr::Binding::new(&action, path("/user/eyes_ext/input/gaze_ext/pose")?)],
                )?;
                Ok(action)
            })
            .transpose()?;
        session.attach_action_sets(&[&set])?;
        let eyes = look
            .map(|action| -> Result<_> {
                let gaze = action.create_space(session, xr::Path::NULL, xr::Posef::IDENTITY)?;
                let view =
                    session.create_reference_space(xr::ReferenceSpaceType::VIEW, xr::Posef::IDENTITY)?;
                Ok(Eyes { action, gaze, view, direction: Vec3::NEG_Z })
            })
            .transpose()?;
        Ok(Self { set, quit, eyes })
    }

    /// The direction of the gaze in a space at a time, if the runtime knows at least how the head is turned.
    ///
    /// # Errors
    /// Errors of xrGetActionStatePose and xrLocateSpace.
    pub fn gaze(
        &mut self,
        session: &xr::Session<xr::Vulkan>,
        space: &xr::Space,
        time: xr::Time,
    ) -> Result<Option<Vec3>> {
        let Some(eyes) = &mut self.eyes else { return Ok(None) };
        if eyes.action.is_active(session, xr::Path::NULL)?
            && let Some(turn) = orientation(&eyes.gaze, &eyes.view, time)?
        {
            eyes.direction = turn * Vec3::NEG_Z;
        }
        Ok(orientation(&eyes.view, space, time)?.map(|head| head * eyes.direction))
    }

    /// Whether the menu button has just been pressed.
    ///
    /// # Errors
    /// Errors of xrSyncActions and xrGetActionStateBoolean.
    pub fn wants_to_quit(&self, session: &xr::Session<xr::Vulkan>) -> Result<bool> {
        session.sync_actions(&[xr::ActiveActionSet::new(&self.set)])?;
        let state = self.quit.state(session, xr::Path::NULL)?;
        Ok(state.is_active && state.changed_since_last_sync && state.current_state)
    }
}

/// Orientation of a space in another one; None if it is not tracked.
fn orientation(space: &xr::Space, base: &xr::Space, time: xr::Time) -> Result<Option<Quat>> {
    let location = space.locate(base, time)?;
    let known = xr::SpaceLocationFlags::ORIENTATION_VALID | xr::SpaceLocationFlags::ORIENTATION_TRACKED;
    let turn = location.pose.orientation;
    Ok(location.location_flags.contains(known).then(|| Quat::from_xyzw(turn.x, turn.y, turn.z, turn.w)))
}
