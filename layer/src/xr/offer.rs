//! The gaze of the layer's own sources for applications that ask for `XR_EXT_eye_gaze_interaction` (`gaze.offer`), where the runtime has no
//! eye gaze.
//!
//! Action sets, actions and spaces are the runtime's, with its results and errors. The layer holds the suggestion for the profile of eye
//! gaze, which the runtime would refuse, and answers where the gaze shows: system properties, current profile, state and pose. Only
//! instances that asked for the extension get these hooks.
//!
//! Loaders list the extensions of a layer by its manifest alone, and refuse others before a layer is asked; so `parafovea install` writes
//! `instance_extensions` where a configuration has `gaze.offer = true` (OpenXR loader, `ApiLayerInterface::GetInstanceExtensionProperties`,
//! `LoaderInstance::CreateInstance`). An instance can thus ask for the extension without `gaze.offer`: it gets one whose system has no eye
//! gaze.

mod below;
mod hooks;
mod input;
mod layers;
mod pose;
mod properties;
mod session;
mod sources;
mod spaces;

pub use hooks::{
    current_profile, note_attached, note_event, note_suggestion, strip_eyes, suggest, synchronise,
};
pub use layers::placed_by_gaze;
pub use properties::get_system_properties;
pub use session::SessionOffer;
pub use spaces::{GazeSpace, forget_all_of, forget_space};

use super::actions::gaze_paths;
use super::dispatch::Next;
use below::OfferNext;
use input::OfferedInput;
use openxr_sys as xr;
use openxr_sys::pfn;
use std::ffi::CStr;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// State of an instance that gives the gaze to its application.
pub struct Offer {
    next: OfferNext,
    /// Whether the extension is on in the runtime, whose system may still have no eye gaze.
    is_known_below: bool,
    paths: GazePaths,
    input: Mutex<OfferedInput>,
}

/// Paths of the extension.
#[derive(Clone, Copy, Debug)]
pub struct GazePaths {
    /// The interaction profile.
    pub profile: xr::Path,
    /// The user path of the eyes.
    pub eyes: xr::Path,
    /// The pose of the gaze, as a binding.
    pub pose: xr::Path,
    /// The same without its last name, for which a runtime chooses the pose.
    pub source: xr::Path,
    /// The user path of the left hand, which every runtime knows.
    pub left_hand: xr::Path,
}

impl Offer {
    /// Resolves the functions below; `None`, with one line in the log, where one is missing.
    pub fn new(
        get: impl Fn(&CStr) -> Option<pfn::VoidFunction>,
        next: &Next,
        instance: xr::Instance,
        is_known_below: bool,
    ) -> Option<Self> {
        // SAFETY: `get` returns the function of the name that it is given.
        let functions = unsafe { OfferNext::load(get) };
        let functions = functions
            .inspect_err(|missing| {
                tracing::info!(
                    "no gaze for the application: the runtime has no {}",
                    missing.to_string_lossy()
                )
            })
            .ok()?;
        let paths = gaze_paths(next, instance)
            .inspect_err(|result| {
                tracing::info!("no gaze for the application: xrStringToPath returned {result:?}")
            })
            .ok()?;
        Some(Self { next: functions, is_known_below, paths, input: Mutex::default() })
    }

    /// Action sets, actions and suggestions of the application.
    pub fn input(&self) -> MutexGuard<'_, OfferedInput> {
        self.input.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Our hook for a function, in an instance with an [`Offer`].
pub fn hook(name: &CStr) -> Option<pfn::VoidFunction> {
    below::hook(name)
}

#[cfg(test)]
mod tests {
    use super::GazePaths;
    use openxr_sys::Path;

    /// Paths that differ.
    pub fn paths() -> GazePaths {
        let [profile, eyes, pose, source, left_hand] = [1, 2, 3, 4, 5].map(Path::from_raw);
        GazePaths { profile, eyes, pose, source, left_hand }
    }
}
