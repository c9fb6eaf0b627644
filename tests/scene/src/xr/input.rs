//! The controllers: the menu button of either hand ends the application.

use anyhow::Result;
use openxr as xr;

/// The one action set, attached to the session.
pub struct Input {
    set: xr::ActionSet,
    quit: xr::Action<bool>,
}

impl Input {
    /// Makes the action set, suggests bindings for the simple controller, and attaches it.
    ///
    /// # Errors
    /// Those of the calls.
    pub fn attach(instance: &xr::Instance, session: &xr::Session<xr::Vulkan>) -> Result<Self> {
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
        session.attach_action_sets(&[&set])?;
        Ok(Self { set, quit })
    }

    /// Whether the menu button has just been pressed.
    ///
    /// # Errors
    /// Those of xrSyncActions and xrGetActionStateBoolean.
    pub fn wants_to_quit(&self, session: &xr::Session<xr::Vulkan>) -> Result<bool> {
        session.sync_actions(&[xr::ActiveActionSet::new(&self.set)])?;
        let state = self.quit.state(session, xr::Path::NULL)?;
        Ok(state.is_active && state.changed_since_last_sync && state.current_state)
    }
}
