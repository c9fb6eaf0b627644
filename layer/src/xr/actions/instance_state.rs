//! State of an instance's action sets and ours.

use super::application::ApplicationInput;
use super::gaze_action::GazeAction;
use crate::xr::instance::{Instance, text};
use openxr_sys as xr;
use std::ptr;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The action sets of an instance.
#[derive(Debug, Default)]
pub struct InstanceActions {
    application: Mutex<ApplicationInput>,
    ours: Mutex<Ours>,
}

/// Our action sets.
#[derive(Debug, Clone, Copy, Default)]
struct Ours {
    made: u32,
    newest: Option<GazeAction>,
    has_failed: bool,
}

impl InstanceActions {
    /// The application's input. Nothing is called down meanwhile.
    pub fn application(&self) -> MutexGuard<'_, ApplicationInput> {
        self.application.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn ours(&self) -> MutexGuard<'_, Ours> {
        self.ours.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Our action set, with its binding suggested. It is made by the first call, and again after the application has
    /// suggested bindings for eye gaze, which replaced ours: a set that was attached once takes no more suggestions. To be
    /// called before action sets are attached.
    pub fn gaze_action(&self, instance: &Instance) -> Option<GazeAction> {
        let suggestions = self.application().gaze_suggestions();
        let number = {
            let mut ours = self.ours();
            if let Some(newest) = ours.newest.filter(|newest| newest.suggestion == suggestions) {
                return Some(newest);
            }
            if ours.has_failed {
                return None;
            }
            ours.made += 1;
            ours.made
        };
        let wanted = self.application().wanted(number);
        let made = wanted
            .ok_or_else(|| {
                "the application extends its bindings for the eye tracker with unknown structures".to_owned()
            })
            .and_then(|wanted| {
                GazeAction::create(&instance.next, instance.handle, &wanted)
                    .map_err(|(what, result)| format!("{what} failed: {result:?}"))
            })
            .inspect_err(|reason| tracing::info!("no eye tracker: {reason}"))
            .ok();
        let mut ours = self.ours();
        ours.has_failed |= made.is_none();
        ours.newest = made;
        made
    }
}

/// A headset, as the runtime describes it.
#[derive(Clone, Debug, Default)]
pub struct Headset {
    /// Its name; empty: not known.
    pub name: String,
    /// Whether it has an eye tracker.
    pub reports_eye_gaze: bool,
}

impl Instance {
    /// The headset of a system.
    pub fn headset(&self, system: xr::SystemId) -> Headset {
        let mut gaze = xr::SystemEyeGazeInteractionPropertiesEXT {
            ty: xr::SystemEyeGazeInteractionPropertiesEXT::TYPE,
            next: ptr::null_mut(),
            supports_eye_gaze_interaction: xr::FALSE,
        };
        let mut properties = xr::SystemProperties {
            ty: xr::SystemProperties::TYPE,
            // The extension's structure without the extension is invalid usage.
            next: if self.eye_gaze { (&raw mut gaze).cast() } else { ptr::null_mut() },
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
        if result.into_raw() < 0 {
            return Headset::default();
        }
        let name = text(&properties.system_name);
        Headset { name, reports_eye_gaze: gaze.supports_eye_gaze_interaction == xr::TRUE }
    }
}
