//! The OpenXR half above a stand-in for the runtime, called as a loader calls it. Parts that need a Vulkan device
//! are tested with the mock runtime.

pub(in crate::xr) mod fake;
mod plan;

use super::{instance, proc_addr};
use openxr_sys as xr;
use openxr_sys::{Handle, pfn};
use std::ffi::{CStr, c_char, c_void};
use std::mem::transmute;
use std::ptr;

fn create_instance(extensions: &[*const c_char]) -> Result<xr::Instance, xr::Result> {
    create_instance_of(c"", extensions)
}

fn create_instance_of(application: &CStr, extensions: &[*const c_char]) -> Result<xr::Instance, xr::Result> {
    // SAFETY: the structure is plain data, for which all zero is a valid value.
    let mut info: xr::InstanceCreateInfo = unsafe { std::mem::zeroed() };
    info.ty = xr::InstanceCreateInfo::TYPE;
    let name = application.to_bytes().iter().map(|&byte| byte as c_char);
    info.application_info.application_name.iter_mut().zip(name).for_each(|(to, from)| *to = from);
    info.enabled_extension_count = extensions.len() as u32;
    info.enabled_extension_names = extensions.as_ptr();
    let (_next, list) = fake::layer_list();
    let mut handle = xr::Instance::NULL;
    // SAFETY: valid structures, and a place for the handle.
    match unsafe { instance::create(&info, &list, &mut handle) } {
        xr::Result::SUCCESS => Ok(handle),
        error => Err(error),
    }
}

fn function(instance: xr::Instance, name: &CStr) -> Result<pfn::VoidFunction, xr::Result> {
    let mut found = None;
    // SAFETY: a handle, a name and a place for the function.
    match unsafe { proc_addr::get(instance, name.as_ptr(), &mut found) } {
        xr::Result::SUCCESS => Ok(found.unwrap()),
        error => Err(error),
    }
}

fn answer(with_eye_gaze: xr::Result, without: xr::Result) {
    fake::ANSWERS.set([with_eye_gaze, without]);
}

fn created() -> Vec<(Vec<String>, xr::Result)> {
    let text =
        |names: Vec<std::ffi::CString>| names.into_iter().map(|name| name.into_string().unwrap()).collect();
    fake::CREATED.take().into_iter().map(|(names, result)| (text(names), result)).collect()
}

const VULKAN: &CStr = c"XR_KHR_vulkan_enable2";

#[test]
fn eye_gaze_is_asked_for_once() {
    create_instance(&[VULKAN.as_ptr()]).unwrap();
    let names = vec!["XR_KHR_vulkan_enable2".to_owned(), "XR_EXT_eye_gaze_interaction".to_owned()];
    assert_eq!(created(), [(names, xr::Result::SUCCESS)]);
}

#[test]
fn without_eye_gaze_the_instance_is_what_the_application_asked_for() {
    answer(xr::Result::ERROR_EXTENSION_NOT_PRESENT, xr::Result::SUCCESS);
    let handle = create_instance(&[VULKAN.as_ptr()]).unwrap();
    assert_eq!(created()[1], (vec!["XR_KHR_vulkan_enable2".to_owned()], xr::Result::SUCCESS));
    assert!(!instance::hooked(handle).unwrap().eye_gaze);
}

#[test]
fn a_runtime_that_does_not_list_eye_gaze_is_asked_all_the_same() {
    fake::LISTED.set(vec![VULKAN]);
    let handle = create_instance(&[VULKAN.as_ptr()]).unwrap();
    assert_eq!(created().len(), 1);
    assert!(instance::hooked(handle).unwrap().eye_gaze);
}

#[test]
fn a_runtime_that_lists_eye_gaze_but_refuses_it_is_used_without() {
    fake::LISTED.set(vec![VULKAN, c"XR_EXT_eye_gaze_interaction"]);
    answer(xr::Result::ERROR_EXTENSION_NOT_PRESENT, xr::Result::SUCCESS);
    let handle = create_instance(&[VULKAN.as_ptr()]).unwrap();
    assert_eq!(created().len(), 2);
    assert!(!instance::hooked(handle).unwrap().eye_gaze);
}

#[test]
fn protons_test_instance_is_left_alone() {
    let handle = create_instance_of(c"wineopenxr test instance", &[VULKAN.as_ptr()]).unwrap();
    assert_eq!(created(), [(vec!["XR_KHR_vulkan_enable2".to_owned()], xr::Result::SUCCESS)]);
    assert!(instance::hooked(handle).is_none(), "no hooks");
}

#[test]
fn a_panic_after_the_instance_was_made_makes_no_second_one() {
    fake::MISSING.set(vec!["xrLocateSpace"]);
    // The line about the missing function comes after the call down.
    let plant = |line: &str| assert!(!line.starts_with("inert:"), "planted after the call below");
    let handle = fake::log::with(plant, || create_instance(&[])).unwrap();
    fake::MISSING.take();
    assert_eq!(created().len(), 1);
    assert!(instance::find(handle).is_some() && instance::hooked(handle).is_none(), "inert, and known");
}

#[test]
fn the_runtimes_own_refusal_reaches_the_application() {
    answer(xr::Result::ERROR_RUNTIME_FAILURE, xr::Result::ERROR_LIMIT_REACHED);
    assert_eq!(create_instance(&[]), Err(xr::Result::ERROR_LIMIT_REACHED));
    assert_eq!(created().len(), 2);
}

#[test]
fn a_caller_that_is_no_loader_is_refused() {
    let (_next, mut list) = fake::layer_list();
    list.next_info = ptr::null_mut();
    let mut handle = xr::Instance::NULL;
    // SAFETY: null pointers are allowed here, and refused.
    unsafe {
        let refused = xr::Result::ERROR_INITIALIZATION_FAILED;
        assert_eq!(instance::create(ptr::null(), &list, &mut handle), refused);
        assert_eq!(instance::create(ptr::null(), ptr::null(), &mut handle), refused);
    }
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_between(
    _: *const xr::InstanceCreateInfo,
    _: *const xr::ApiLayerCreateInfo,
    _: *mut xr::Instance,
) -> xr::Result {
    xr::Result::ERROR_RUNTIME_FAILURE
}

#[test]
fn the_last_entry_of_a_layer_that_is_listed_again_counts() {
    let name = super::LAYER_NAME.to_bytes().iter().map(|&byte| byte as c_char);
    let (mut last, mut list) = fake::layer_list();
    last.layer_name.iter_mut().zip(name).for_each(|(to, from)| *to = from);
    let mut between = Box::new(xr::ApiLayerNextInfo {
        next_get_instance_proc_addr: Some(proc_addr::get),
        next_create_api_layer_instance: Some(instance::create),
        next: &raw mut *last,
        ..*last
    });
    between.layer_name = [0; xr::MAX_API_LAYER_NAME_SIZE];
    let mut first = Box::new(xr::ApiLayerNextInfo {
        next_create_api_layer_instance: Some(create_between),
        next: &raw mut *between,
        ..*last
    });
    list.next_info = &raw mut *first;

    // SAFETY: the structure is plain data, for which all zero is a valid value.
    let mut info: xr::InstanceCreateInfo = unsafe { std::mem::zeroed() };
    info.ty = xr::InstanceCreateInfo::TYPE;
    let mut handle = xr::Instance::NULL;
    // SAFETY: valid structures, and a place for the handle.
    assert_eq!(unsafe { instance::create(&info, &list, &mut handle) }, xr::Result::SUCCESS);
    let pointer = function(handle, c"xrGetViewConfigurationProperties").unwrap() as *const c_void;
    assert_eq!(pointer, fake::next_pointer());
}

#[test]
fn only_hooked_functions_are_ours() {
    let handle = create_instance(&[]).unwrap();
    let next = fake::next_pointer();
    assert_ne!(function(handle, c"xrEndFrame").unwrap() as *const c_void, next);
    assert_eq!(function(handle, c"xrGetViewConfigurationProperties").unwrap() as *const c_void, next);
    assert_eq!(function(handle, c"xrNoSuchFunction"), Err(xr::Result::ERROR_FUNCTION_UNSUPPORTED));
}

#[test]
fn the_runtime_answers_for_handles_that_nobody_knows() {
    let handle = create_instance(&[]).unwrap();
    // SAFETY: the name gives the type; the stand-in does not look at the structure.
    let end_frame =
        unsafe { transmute::<pfn::VoidFunction, pfn::EndFrame>(function(handle, c"xrEndFrame").unwrap()) };
    // SAFETY: as above.
    let result = unsafe { end_frame(xr::Session::from_raw(u64::MAX), ptr::null()) };
    assert_eq!(result, xr::Result::ERROR_HANDLE_INVALID);
}

#[test]
fn a_session_that_is_not_vulkan_keeps_its_action_sets_to_itself() {
    let handle = create_instance(&[]).unwrap();
    let info = xr::SessionCreateInfo {
        ty: xr::SessionCreateInfo::TYPE,
        next: ptr::null(),
        create_flags: xr::SessionCreateFlags::EMPTY,
        system_id: xr::SystemId::from_raw(1),
    };
    let sets = [xr::ActionSet::from_raw(77)];
    let attach_info = xr::SessionActionSetsAttachInfo {
        ty: xr::SessionActionSetsAttachInfo::TYPE,
        next: ptr::null(),
        count_action_sets: 1,
        action_sets: sets.as_ptr(),
    };
    let mut session = xr::Session::NULL;
    // SAFETY: the names give the types; the arguments are valid.
    unsafe {
        let create =
            transmute::<pfn::VoidFunction, pfn::CreateSession>(function(handle, c"xrCreateSession").unwrap());
        assert_eq!(create(handle, &info, &mut session), xr::Result::SUCCESS);
        let attach = function(handle, c"xrAttachSessionActionSets").unwrap();
        let attach = transmute::<pfn::VoidFunction, pfn::AttachSessionActionSets>(attach);
        assert_eq!(attach(session, &attach_info), xr::Result::SUCCESS);
    }
    assert_eq!(fake::ATTACHED.take(), [vec![77]]);
}

#[test]
fn a_destroyed_instance_is_forgotten() {
    let handle = create_instance(&[]).unwrap();
    // SAFETY: the name gives the type.
    let destroy = unsafe {
        transmute::<pfn::VoidFunction, pfn::DestroyInstance>(function(handle, c"xrDestroyInstance").unwrap())
    };
    // SAFETY: a live instance.
    assert_eq!(unsafe { destroy(handle) }, xr::Result::SUCCESS);
    assert_eq!(function(handle, c"xrEndFrame"), Err(xr::Result::ERROR_HANDLE_INVALID));
}
