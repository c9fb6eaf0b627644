//! Instances: creation, tracking, destruction.

mod below;
mod extensions;

use super::actions::InstanceActions;
use super::dispatch::Next;
use super::offer::Offer;
use super::{session, vulkan_activation};
use crate::abi::{Enablement, attempt, guard};
use crate::config::{Arming, Environment, LiveConfig};
use crate::log::NAMES;
use crate::registry::Registry;
use below::Below;
use extensions::EyeGaze;
use openxr_sys as xr;
use openxr_sys::pfn;
use std::cell::Cell;
use std::ffi::{CStr, c_char};
use std::sync::Arc;

/// Proton asks a runtime for its abilities with an instance of this name, and destroys it at once (peers: Proton,
/// wineopenxr).
const WINE_TEST_INSTANCE: &str = "wineopenxr test instance";

/// An instance, as far as every call needs it.
pub struct Known {
    /// The next layer's `xrGetInstanceProcAddr`.
    pub next_get_instance_proc_addr: pfn::GetInstanceProcAddr,
    /// The state of our hooks; `None` for an inert instance, which gets no hooks at all.
    pub hooked: Option<Arc<Instance>>,
}

/// An instance that is not inert.
pub struct Instance {
    /// Its handle.
    pub handle: xr::Instance,
    /// The functions below.
    pub next: Next,
    /// The application's name for itself.
    pub application: String,
    /// Its configuration.
    pub config: LiveConfig,
    /// Whether `XR_EXT_eye_gaze_interaction` is on, for the application or for us.
    pub eye_gaze: bool,
    /// Whether the application asked for it.
    pub eye_gaze_is_asked_for: bool,
    /// Its action sets, and ours.
    pub actions: InstanceActions,
    /// The gaze for an application that asks for it; `None` if the application gets the runtime's.
    pub offer: Option<Offer>,
}

impl Instance {
    /// Whether `XR_EXT_eye_gaze_interaction` is on for us alone, and thus hidden from the application.
    pub fn has_own_eye_gaze(&self) -> bool {
        self.eye_gaze && !self.eye_gaze_is_asked_for
    }
}

static INSTANCES: Registry<xr::Instance, Known> = Registry::new();

/// The instance of that handle.
pub fn find(handle: xr::Instance) -> Option<Arc<Known>> {
    INSTANCES.get(handle)
}

/// The instance of that handle if it is not inert.
pub fn hooked(handle: xr::Instance) -> Option<Arc<Instance>> {
    find(handle)?.hooked.clone()
}

/// The functions below for a handle that is not known, so that the runtime returns its own error.
/// Loaders allow one instance at a time.
pub fn next_of_any() -> Option<Next> {
    Some(any_hooked()?.next)
}

/// Any instance that is not inert, for a handle whose instance is not tracked here.
pub fn any_hooked() -> Option<Arc<Instance>> {
    find_hooked(|_| true)
}

/// An instance that is not inert, and meets the condition.
pub fn find_hooked(is_wanted: impl Fn(&Instance) -> bool) -> Option<Arc<Instance>> {
    INSTANCES.find_map(|known| known.hooked.clone().filter(|instance| is_wanted(instance)))
}

/// Any instance whose application asked for eye gaze, with an offer of ours.
pub fn any_offering() -> Option<Arc<Instance>> {
    find_hooked(|instance| instance.offer.is_some())
}

/// `xrCreateApiLayerInstance`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create(
    info: *const xr::InstanceCreateInfo,
    layer_info: *const xr::ApiLayerCreateInfo,
    instance: *mut xr::Instance,
) -> xr::Result {
    // SAFETY: the loader vouches for its list.
    let Some(below) = (unsafe { Below::read(layer_info) }) else {
        return xr::Result::ERROR_INITIALIZATION_FAILED;
    };
    // SAFETY: the application's own arguments.
    let as_asked = || unsafe { create_as_asked(&below, info, instance) };
    // A panic after the call down does not make a second instance.
    let created = Cell::new(None);
    // As if nothing of ours were there; but the loader asks us for all of its functions.
    let inert = || {
        let result = created.get().unwrap_or_else(as_asked);
        if result == xr::Result::SUCCESS {
            // SAFETY: the call succeeded, so `instance` is valid.
            track(&below, unsafe { *instance }, String::new(), None, GazeExtension::Off);
        }
        result
    };
    guard("xrCreateInstance", inert, |answer| {
        // SAFETY: the loader checked that `info` and `instance` are not null; both are valid, as
        // xrCreateInstance demands.
        let (Some(info), Some(handle)) = (unsafe { (info.as_ref(), instance.as_mut()) }) else {
            return as_asked();
        };
        let name = text(&info.application_info.application_name);
        let wanted = wanted(&name);
        let (result, eye_gaze) = match &wanted {
            Some(config) => {
                vulkan_activation::activate();
                // A configuration without work leaves calls as they are, as it does devices; an edit takes effect after a restart.
                let may_add = Arming::of(&config.snapshot()) != Arming::Inert;
                // SAFETY: as above.
                unsafe { create_with_eye_gaze(&below, info, handle, may_add) }
            }
            None => (as_asked(), GazeExtension::Off),
        };
        created.set(Some(result));
        if result == xr::Result::SUCCESS {
            track(&below, *handle, name, wanted, eye_gaze);
        }
        answer.record(result)
    })
}

/// The configuration, unless this instance stays inert; the reason goes to the log.
fn wanted(name: &str) -> Option<LiveConfig> {
    let enablement = Enablement::of_process();
    let environment = Environment::of_process(enablement == Enablement::Elevated);
    if enablement != Enablement::Enabled {
        tracing::info!(target: NAMES, "OpenXR instance of \"{name}\" inert: {enablement}");
        return None;
    }
    if name == WINE_TEST_INSTANCE {
        return None;
    }
    let config = LiveConfig::new(&environment, Some(name));
    if !config.snapshot().enabled {
        tracing::info!(
            target: NAMES,
            "OpenXR instance of \"{name}\" inert: enabled = false; an edit takes effect after a restart of the application"
        );
        return None;
    }
    tracing::info!(target: NAMES, "OpenXR instance of \"{name}\"");
    Some(config)
}

/// State of `XR_EXT_eye_gaze_interaction`, by its requester.
#[derive(Clone, Copy, PartialEq, Eq)]
enum GazeExtension {
    Off,
    Ours,
    Applications,
    /// The application asked for it, and the runtime does not have it.
    Missing,
}

/// Creates the instance as the application asks. A loader lets an extension of our manifest through which the runtime may not have: then
/// the application gets an instance without it.
///
/// # Safety
///
/// As for `xrCreateInstance`.
unsafe fn create_as_asked(
    below: &Below,
    info: *const xr::InstanceCreateInfo,
    instance: *mut xr::Instance,
) -> xr::Result {
    // SAFETY: the arguments are valid, as `# Safety` demands.
    let result = unsafe { below.create(info, instance) };
    if result != xr::Result::ERROR_EXTENSION_NOT_PRESENT {
        return result;
    }
    // SAFETY: as above.
    let without = unsafe { info.as_ref() }.map(|info| (info, unsafe { EyeGaze::of(info, None) }));
    let Some((info, EyeGaze::AskedFor { others, .. })) = without else { return result };
    // SAFETY: as above, with a copy of the structure.
    unsafe { below.create(&with_extensions(info, &others), instance) }
}

/// The structure with other extensions, which are to outlive it.
fn with_extensions(info: &xr::InstanceCreateInfo, names: &[*const c_char]) -> xr::InstanceCreateInfo {
    xr::InstanceCreateInfo {
        enabled_extension_count: names.len() as u32,
        enabled_extension_names: names.as_ptr(),
        ..*info
    }
}

/// Creates the instance with eye gaze added, where it may be added and the runtime may have it. We may be the cause of a failure: then the application gets the
/// result of its unchanged call.
///
/// # Safety
///
/// As for `xrCreateInstance`.
unsafe fn create_with_eye_gaze(
    below: &Below,
    info: &xr::InstanceCreateInfo,
    handle: &mut xr::Instance,
    may_add: bool,
) -> (xr::Result, GazeExtension) {
    // SAFETY: the arguments are valid, as `# Safety` demands, with the application's structure or an extended copy of it.
    let mut create = |info: &xr::InstanceCreateInfo| unsafe { below.create(info, handle) };
    // SAFETY: `info` is valid, as `# Safety` demands.
    match unsafe { EyeGaze::of(info, below.offered().as_deref()) } {
        EyeGaze::AskedFor { others, is_missing } => {
            if !is_missing {
                let result = create(info);
                if result != xr::Result::ERROR_EXTENSION_NOT_PRESENT {
                    return (result, GazeExtension::Applications);
                }
            }
            (create(&with_extensions(info, &others)), GazeExtension::Missing)
        }
        EyeGaze::Unreadable => (create(info), GazeExtension::Off),
        EyeGaze::Missing | EyeGaze::Added(_) if !may_add => (create(info), GazeExtension::Off),
        EyeGaze::Missing => {
            tracing::info!(
                "no eye tracker: this runtime does not offer XR_EXT_eye_gaze_interaction; OSC packets and preset = \"fixed\" do not need it"
            );
            (create(info), GazeExtension::Off)
        }
        EyeGaze::Added(names) => {
            let result = create(&with_extensions(info, &names));
            if result.into_raw() >= 0 {
                return (result, GazeExtension::Ours);
            }
            tracing::info!(
                "no eye tracker: xrCreateInstance with XR_EXT_eye_gaze_interaction returned {result:?}"
            );
            (create(info), GazeExtension::Off)
        }
    }
}

/// Begins to track an instance, with hooks if it has a `config`.
fn track(
    below: &Below,
    handle: xr::Instance,
    application: String,
    config: Option<LiveConfig>,
    eye_gaze: GazeExtension,
) {
    let get = |name: &CStr| {
        let mut function = None;
        // SAFETY: the next layer's function, a live instance of it, a name and a place for the result.
        let result = unsafe { (below.get_instance_proc_addr)(handle, name.as_ptr(), &mut function) };
        function.filter(|_| result == xr::Result::SUCCESS)
    };
    let hooked = config.and_then(|config| {
        // SAFETY: xrGetInstanceProcAddr returns the function of the name that it is given.
        let next = unsafe { Next::load(get) }
            .inspect_err(|missing| tracing::error!("inert: the runtime has no {}", missing.to_string_lossy()))
            .ok()?;
        let is_offered = config.snapshot().gaze.offer;
        let may_offer = match eye_gaze {
            // Its system then has no eye gaze without `gaze.offer`.
            GazeExtension::Missing => true,
            GazeExtension::Applications => is_offered,
            GazeExtension::Off | GazeExtension::Ours => false,
        };
        let is_known_below = eye_gaze == GazeExtension::Applications;
        let offer = if may_offer { Offer::new(get, &next, handle, is_known_below) } else { None };
        if is_offered && offer.is_some() {
            tracing::info!(
                "the application asks for XR_EXT_eye_gaze_interaction: unless the runtime has an eye tracker, it gets the gaze of gaze.source (gaze.offer = true)"
            );
        }
        Some(Arc::new(Instance {
            handle,
            next,
            application,
            config,
            eye_gaze: matches!(eye_gaze, GazeExtension::Ours | GazeExtension::Applications),
            eye_gaze_is_asked_for: is_known_below,
            actions: InstanceActions::default(),
            offer,
        }))
    });
    let known = Known { next_get_instance_proc_addr: below.get_instance_proc_addr, hooked };
    INSTANCES.insert(handle, Arc::new(known));
}

/// `xrDestroyInstance`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy(handle: xr::Instance) -> xr::Result {
    let Some(next) = hooked(handle).map(|instance| instance.next).or_else(next_of_any) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own argument.
    let below = || unsafe { (next.destroy_instance)(handle) };
    let pass_through = || {
        attempt("xrDestroyInstance", || drop(session::forget_all_of(handle)));
        below()
    };
    guard("xrDestroyInstance", pass_through, |answer| {
        let swapchains = session::forget_all_of(handle);
        let result = answer.record(below());
        drop(swapchains);
        if result == xr::Result::SUCCESS {
            INSTANCES.remove(handle);
        }
        result
    })
}

/// A fixed-size string of OpenXR, up to its end.
pub(super) fn text(characters: &[c_char]) -> String {
    let bytes: Vec<u8> =
        characters.iter().map(|&character| character as u8).take_while(|&byte| byte != 0).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}
