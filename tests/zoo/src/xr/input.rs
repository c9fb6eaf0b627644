//! The controllers, as nearly every application has them: a layer can add the gaze to its actions.

use anyhow::Result;
use openxr as xr;

/// One action set with one button, attached to the session.
pub struct Input {
    set: xr::ActionSet,
    /// Kept alive with the set.
    _quit: xr::Action<bool>,
}

impl Input {
    /// Makes the action set, suggests a binding for the simple controller, and attaches it.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn attach(instance: &xr::Instance, session: &xr::Session<xr::Vulkan>) -> Result<Self> {
        let set = instance.create_action_set("zoo", "Zoo", 0)?;
        let quit = set.create_action::<bool>("quit", "Leave the zoo", &[])?;
        let path = |text| instance.string_to_path(text);
        instance.suggest_interaction_profile_bindings(
            path("/interaction_profiles/khr/simple_controller")?,
            &[xr::Binding::new(&quit, path("/user/hand/left/input/menu/click")?)],
        )?;
        session.attach_action_sets(&[&set])?;
        Ok(Self { set, _quit: quit })
    }

    /// Synchronises it, once a frame.
    ///
    /// # Errors
    /// Errors of xrSyncActions.
    pub fn synchronise(&self, session: &xr::Session<xr::Vulkan>) -> Result<()> {
        Ok(session.sync_actions(&[xr::ActiveActionSet::new(&self.set)])?)
    }
}
