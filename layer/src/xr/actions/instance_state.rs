//! What is known of an instance's action sets, and ours.

use super::gaze_action::{self, GazeAction};
use crate::xr::instance::Instance;
use openxr_sys as xr;
use std::ptr;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The action sets of an instance.
#[derive(Debug, Default)]
pub struct InstanceActions(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    application_has_set: bool,
    suggestion: Suggestion,
    ours: Ours,
}

/// What the application suggested for the profile of eye gaze.
#[derive(Debug, Clone, Default)]
enum Suggestion {
    #[default]
    Nothing,
    Bindings(Vec<xr::ActionSuggestedBinding>),
    /// With extending structures, which cannot be kept.
    Extended,
}

#[derive(Debug, Clone, Copy, Default)]
enum Ours {
    #[default]
    NotTried,
    Failed,
    /// Made, and its binding suggested.
    Ready(GazeAction),
}

impl InstanceActions {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The application makes an action set.
    pub fn note_action_set(&self) {
        self.state().application_has_set = true;
    }

    /// Whether the application has made an action set.
    pub fn application_has_set(&self) -> bool {
        self.state().application_has_set
    }

    /// Remembers a suggestion of the application, if it is for eye gaze.
    ///
    /// # Safety
    ///
    /// `suggestion` is valid.
    pub unsafe fn note_suggestion(
        &self,
        instance: &Instance,
        suggestion: &xr::InteractionProfileSuggestedBinding,
    ) {
        let is_gaze = instance.eye_gaze
            && gaze_action::profile(&instance.next, instance.handle) == Ok(suggestion.interaction_profile);
        if !is_gaze {
            return;
        }
        self.state().suggestion = match suggestion.next.is_null() {
            // SAFETY: the caller vouches for the structure: an array of that many bindings.
            true => Suggestion::Bindings(unsafe {
                std::slice::from_raw_parts(
                    suggestion.suggested_bindings,
                    suggestion.count_suggested_bindings as usize,
                )
                .to_vec()
            }),
            false => Suggestion::Extended,
        };
    }

    /// Our action set, with its binding suggested; the first call makes it, and must come before action sets
    /// are attached.
    pub fn gaze_action(&self, instance: &Instance) -> Option<GazeAction> {
        let mut state = self.state();
        if let Ours::NotTried = state.ours {
            state.ours = match create(instance, &state.suggestion) {
                Ok(ready) => Ours::Ready(ready),
                Err(reason) => {
                    tracing::info!("no eye gaze: {reason}");
                    Ours::Failed
                }
            };
        }
        match state.ours {
            Ours::Ready(ready) => Some(ready),
            Ours::NotTried | Ours::Failed => None,
        }
    }
}

fn create(instance: &Instance, suggestion: &Suggestion) -> Result<GazeAction, String> {
    let applications: &[xr::ActionSuggestedBinding] = match suggestion {
        Suggestion::Nothing => &[],
        Suggestion::Bindings(bindings) => bindings,
        Suggestion::Extended => return Err("the application's own use of it has extensions".to_owned()),
    };
    let (next, handle) = (&instance.next, instance.handle);
    let made = GazeAction::create(next, handle)
        .map_err(|result| format!("making an action set returned {result:?}"))?;
    made.suggest(next, handle, applications)
        .inspect_err(|_| made.destroy(next))
        .map_err(|result| format!("suggesting its binding returned {result:?}"))?;
    Ok(made)
}

impl Instance {
    /// Whether the runtime says that a system has an eye tracker.
    pub fn reports_eye_gaze(&self, system: xr::SystemId) -> bool {
        if !self.eye_gaze {
            return false;
        }
        let mut gaze = xr::SystemEyeGazeInteractionPropertiesEXT {
            ty: xr::SystemEyeGazeInteractionPropertiesEXT::TYPE,
            next: ptr::null_mut(),
            supports_eye_gaze_interaction: xr::FALSE,
        };
        let mut properties = xr::SystemProperties {
            ty: xr::SystemProperties::TYPE,
            next: (&raw mut gaze).cast(),
            system_id: xr::SystemId::NULL,
            vendor_id: 0,
            system_name: [0; xr::MAX_SYSTEM_NAME_SIZE],
            graphics_properties: xr::SystemGraphicsProperties {
                max_swapchain_image_height: 0,
                max_swapchain_image_width: 0,
                max_layer_count: 0,
            },
            tracking_properties: xr::SystemTrackingProperties {
                orientation_tracking: xr::FALSE,
                position_tracking: xr::FALSE,
            },
        };
        // SAFETY: the next layer's function, a live instance and valid structures to write to.
        let result = unsafe { (self.next.get_system_properties)(self.handle, system, &mut properties) };
        result.into_raw() >= 0 && gaze.supports_eye_gaze_interaction == xr::TRUE
    }
}
