//! A mistake of the application: the specification's error, and why it is one.

use openxr_sys as xr;

/// Injected failure of a call.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fault {
    /// Result of the call.
    pub result: xr::Result,
    /// The violation, with the values at hand.
    pub message: String,
    /// The section of the OpenXR specification, or the extension, that has the rule.
    pub section: &'static str,
}

/// Outcome of a call: a success code, or a fault.
pub(crate) type Outcome = Result<xr::Result, Fault>;

impl Fault {
    /// A fault with any of the specification's errors.
    pub fn new(result: xr::Result, section: &'static str, message: impl Into<String>) -> Self {
        Self { result, message: message.into(), section }
    }

    /// `XR_ERROR_VALIDATION_FAILURE`: broken valid usage that has no error of its own.
    pub fn validation(section: &'static str, message: impl Into<String>) -> Self {
        Self::new(xr::Result::ERROR_VALIDATION_FAILURE, section, message)
    }

    /// `XR_ERROR_CALL_ORDER_INVALID`.
    pub fn order(section: &'static str, message: impl Into<String>) -> Self {
        Self::new(xr::Result::ERROR_CALL_ORDER_INVALID, section, message)
    }

    /// `XR_ERROR_RUNTIME_FAILURE`: the mock itself, its scenario or the device failed.
    pub fn runtime(message: impl Into<String>) -> Self {
        Self::new(xr::Result::ERROR_RUNTIME_FAILURE, section::RETURN_CODES, message)
    }
}

/// The result's name as the headers spell it.
pub(crate) fn result_name(result: xr::Result) -> String {
    named(
        "XR",
        &format!("{result:?}"),
        result.into_raw(),
        if result.into_raw() < 0 { "FAILURE" } else { "SUCCESS" },
    )
}

/// The result of that name.
pub(crate) fn result_named(name: &str) -> Option<xr::Result> {
    // Core results are small numbers; results of extensions start at 1000000000, in steps of 1000 for each extension.
    let core = (-200..=200).map(xr::Result::from_raw);
    core.into_iter().find(|result| result_name(*result) == name)
}

/// The structure type's name as the headers spell it.
pub(crate) fn structure_name(ty: xr::StructureType) -> String {
    named("XR_TYPE", &format!("{ty:?}"), ty.into_raw(), "STRUCTURE_TYPE")
}

/// `openxr-sys` prints the number of a value that it does not know: the specification has a form for these.
fn named(prefix: &str, name: &str, raw: i32, unknown: &str) -> String {
    if name.parse::<i32>().is_ok() {
        let prefix = prefix.strip_suffix("_TYPE").unwrap_or(prefix);
        format!("{prefix}_UNKNOWN_{unknown}_{raw}")
    } else {
        format!("{prefix}_{name}")
    }
}

/// Titles of sections of the OpenXR 1.1 specification that faults refer to.
pub(crate) mod section {
    pub const API_VERSIONS: &str = "API Version Numbers and Semantics";
    pub const VALID_USAGE: &str = "Valid Usage";
    pub const BUFFER_SIZES: &str = "Buffer Size Parameters";
    pub const STRUCTURES: &str = "Structure Types";
    pub const CHAINS: &str = "Next Pointer Chains";
    pub const HANDLES: &str = "Object Handle Types";
    pub const RETURN_CODES: &str = "Return Codes";
    pub const FUNCTION_POINTERS: &str = "Command Function Pointers";
    pub const INSTANCE: &str = "Instance";
    pub const INSTANCE_LIFECYCLE: &str = "Instance Lifecycle";
    pub const SYSTEM: &str = "System";
    pub const FORM_FACTOR: &str = "Form Factors";
    pub const PATHS: &str = "Semantic Paths";
    pub const REFERENCE_SPACES: &str = "Reference Spaces";
    pub const ACTION_SPACES: &str = "Action Spaces";
    pub const LOCATING: &str = "Locating Spaces";
    pub const COORDINATES: &str = "Common Object Types and Conventions: Poses";
    pub const VIEW_CONFIGURATIONS: &str = "View Configurations";
    pub const SESSION_CREATION: &str = "Session Creation";
    pub const SESSION_CONTROL: &str = "Session Control";
    pub const SWAPCHAINS: &str = "Swapchain Image Management";
    pub const VIEWS: &str = "View and Projection State";
    pub const FRAMES: &str = "Frame Synchronization";
    pub const SUBMISSION: &str = "Frame Submission";
    pub const COMPOSITION: &str = "Composition Layer Types";
    pub const ACTION_SETS: &str = "Action Sets";
    pub const ACTIONS: &str = "Creating Actions";
    pub const BINDINGS: &str = "Suggested Bindings";
    pub const PROFILES: &str = "Current Interaction Profile";
    pub const ACTION_STATE: &str = "Reading Input Action State";
    pub const SYNC: &str = "Input Action State Synchronization";
    pub const VULKAN: &str = "XR_KHR_vulkan_enable, XR_KHR_vulkan_enable2";
    pub const DEPTH: &str = "XR_KHR_composition_layer_depth";
    pub const FORMAT_LIST: &str = "XR_KHR_vulkan_swapchain_format_list";
    pub const VISIBILITY_MASK: &str = "XR_KHR_visibility_mask";
    pub const DEBUG_UTILS: &str = "XR_EXT_debug_utils";
    pub const TIMESPEC: &str = "XR_KHR_convert_timespec_time";
}
