//! A stand-in for the runtime below, as little of it as the tests need. It notes the arguments of its calls.

pub mod actions;
pub mod frames;
pub mod log;
pub mod vulkan_half;

use openxr_sys as xr;
use openxr_sys::{Handle, pfn};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_void};
use std::mem::transmute;
use std::sync::atomic::{AtomicU64, Ordering};

/// Handles are never used twice, so that tests in one process stay apart.
static HANDLES: AtomicU64 = AtomicU64::new(1);

thread_local! {
    /// The extensions of each xrCreateInstance of this thread, with their results.
    pub static CREATED: RefCell<Vec<(Vec<CString>, xr::Result)>> = const { RefCell::new(Vec::new()) };
    /// Results for an instance with eye gaze, and for one without.
    pub static ANSWERS: RefCell<[xr::Result; 2]> = const { RefCell::new([xr::Result::SUCCESS; 2]) };
    /// The extensions that the stand-in lists; it does not answer without any.
    pub static LISTED: RefCell<Vec<&'static CStr>> = const { RefCell::new(Vec::new()) };
    /// Functions that the stand-in lacks.
    pub static MISSING: RefCell<Vec<&'static str>> = const { RefCell::new(Vec::new()) };
    /// The action sets of each xrAttachSessionActionSets of this thread.
    pub static ATTACHED: RefCell<Vec<Vec<u64>>> = const { RefCell::new(Vec::new()) };
}

/// The function of a name, from a list of functions with their types.
macro_rules! table {
    ($wanted:expr; $($name:literal $type:ident $function:ident;)*) => {
        match $wanted {
            // SAFETY: any function pointer may be carried as PFN_xrVoidFunction.
            $($name => Some(unsafe {
                std::mem::transmute::<openxr_sys::pfn::$type, openxr_sys::pfn::VoidFunction>($function)
            }),)*
            _ => None,
        }
    };
}
use table;

/// A handle that was never used before.
pub fn new_handle() -> u64 {
    HANDLES.fetch_add(1, Ordering::Relaxed)
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_instance(
    info: *const xr::InstanceCreateInfo,
    _list: *const xr::ApiLayerCreateInfo,
    instance: *mut xr::Instance,
) -> xr::Result {
    // SAFETY: the layer passes valid structures.
    let extensions: Vec<CString> = unsafe {
        let names = (*info).enabled_extension_names;
        (0..(*info).enabled_extension_count as usize)
            .map(|at| CStr::from_ptr(*names.add(at)).to_owned())
            .collect()
    };
    let has_eye_gaze = extensions.iter().any(|name| name.as_c_str() == c"XR_EXT_eye_gaze_interaction");
    let result = ANSWERS.with_borrow(|answers| answers[usize::from(!has_eye_gaze)]);
    CREATED.with_borrow_mut(|created| created.push((extensions, result)));
    if result == xr::Result::SUCCESS {
        // SAFETY: as above.
        unsafe { *instance = xr::Instance::from_raw(new_handle()) };
    }
    result
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn enumerate_extensions(
    _: *const c_char,
    capacity: u32,
    count: *mut u32,
    extensions: *mut xr::ExtensionProperties,
) -> xr::Result {
    LISTED.with_borrow(|listed| {
        // SAFETY: the layer passes an array of `capacity` structures.
        unsafe {
            *count = listed.len() as u32;
            for (at, name) in listed.iter().enumerate().take(capacity as usize) {
                let name = name.to_bytes_with_nul().iter().map(|&byte| byte as c_char);
                (*extensions.add(at)).extension_name.iter_mut().zip(name).for_each(|(to, from)| *to = from);
            }
        }
        if listed.is_empty() { xr::Result::ERROR_RUNTIME_FAILURE } else { xr::Result::SUCCESS }
    })
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_session(
    _: xr::Instance,
    _: *const xr::SessionCreateInfo,
    session: *mut xr::Session,
) -> xr::Result {
    // SAFETY: the layer passes a place for the handle.
    unsafe { *session = xr::Session::from_raw(new_handle()) };
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn destroy_instance(_: xr::Instance) -> xr::Result {
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn attach(_: xr::Session, info: *const xr::SessionActionSetsAttachInfo) -> xr::Result {
    // SAFETY: the layer passes a valid structure.
    let sets = unsafe { std::slice::from_raw_parts((*info).action_sets, (*info).count_action_sets as usize) };
    ATTACHED.with_borrow_mut(|attached| attached.push(sets.iter().map(|set| set.into_raw()).collect()));
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn end_frame(_: xr::Session, _: *const xr::FrameEndInfo) -> xr::Result {
    xr::Result::ERROR_HANDLE_INVALID
}

/// Stands for every function that the tests never call.
///
/// # Safety
///
/// As the call.
unsafe extern "system" fn never_called() {}

/// # Safety
///
/// As the call.
unsafe extern "system" fn get_instance_proc_addr(
    _: xr::Instance,
    name: *const c_char,
    function: *mut Option<pfn::VoidFunction>,
) -> xr::Result {
    // SAFETY: the name is a string.
    let name = unsafe { CStr::from_ptr(name) }.to_str().unwrap();
    let address = match name {
        "xrEnumerateInstanceExtensionProperties" => {
            enumerate_extensions as pfn::EnumerateInstanceExtensionProperties as *const ()
        }
        "xrCreateSession" => create_session as pfn::CreateSession as *const (),
        "xrDestroyInstance" => destroy_instance as pfn::DestroyInstance as *const (),
        "xrAttachSessionActionSets" => attach as pfn::AttachSessionActionSets as *const (),
        "xrEndFrame" => end_frame as pfn::EndFrame as *const (),
        "xrNoSuchFunction" => return xr::Result::ERROR_FUNCTION_UNSUPPORTED,
        name if MISSING.with_borrow(|missing| missing.contains(&name)) => {
            return xr::Result::ERROR_FUNCTION_UNSUPPORTED;
        }
        name => {
            frames::function(name).or_else(|| actions::function(name)).unwrap_or(never_called) as *const ()
        }
    };
    // SAFETY: the address of a function, carried as PFN_xrVoidFunction and cast back by its name; there is a place for it.
    unsafe { *function = Some(transmute::<*const (), pfn::VoidFunction>(address)) };
    xr::Result::SUCCESS
}

/// The pointer that the stand-in gives for functions that the tests never call.
pub fn next_pointer() -> *const c_void {
    never_called as *const c_void
}

/// The loader's list: this layer, and the stand-in as the end of it.
pub fn layer_list() -> (Box<xr::ApiLayerNextInfo>, xr::ApiLayerCreateInfo) {
    let mut next = Box::new(xr::ApiLayerNextInfo {
        struct_type: xr::ApiLayerNextInfo::TYPE,
        struct_version: 1,
        struct_size: size_of::<xr::ApiLayerNextInfo>(),
        layer_name: [0; xr::MAX_API_LAYER_NAME_SIZE],
        next_get_instance_proc_addr: Some(get_instance_proc_addr),
        next_create_api_layer_instance: Some(create_instance),
        next: std::ptr::null_mut(),
    });
    let list = xr::ApiLayerCreateInfo {
        struct_type: xr::ApiLayerCreateInfo::TYPE,
        struct_version: 1,
        struct_size: size_of::<xr::ApiLayerCreateInfo>(),
        loader_instance: std::ptr::null_mut(),
        settings_file_location: [0; xr::API_LAYER_MAX_SETTINGS_PATH_SIZE],
        next_info: &raw mut *next,
    };
    (next, list)
}
