//! Actions, paths and events of the stand-in.

use super::{new_handle, table};
use openxr_sys as xr;
use openxr_sys::{Handle, pfn};
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::ffi::{CStr, CString, c_char};

thread_local! {
    /// Calls of action functions, in order.
    pub static ACTIONS: RefCell<Vec<&'static str>> = const { RefCell::new(Vec::new()) };
    /// The actions of each xrSuggestInteractionProfileBindings.
    pub static SUGGESTED: RefCell<Vec<Vec<xr::Action>>> = const { RefCell::new(Vec::new()) };
    /// The action sets of each xrSyncActions.
    pub static SYNCED: RefCell<Vec<Vec<xr::ActionSet>>> = const { RefCell::new(Vec::new()) };
    /// Results of the next calls of xrSyncActions; the calls after them succeed.
    pub static SYNC_RESULTS: RefCell<VecDeque<xr::Result>> = const { RefCell::new(VecDeque::new()) };
    /// Whether each pose action is active.
    pub static IS_ACTIVE: Cell<bool> = const { Cell::new(false) };
    /// The current interaction profile of every user path.
    pub static PROFILE: Cell<xr::Path> = const { Cell::new(xr::Path::NULL) };
    /// Sessions whose interaction profiles have changed: waiting events.
    pub static CHANGED: RefCell<VecDeque<xr::Session>> = const { RefCell::new(VecDeque::new()) };
    /// The action spaces.
    pub static GAZE_SPACES: RefCell<Vec<xr::Space>> = const { RefCell::new(Vec::new()) };
    static PATHS: RefCell<Vec<CString>> = const { RefCell::new(Vec::new()) };
}

/// The function of that name, if it is here.
pub fn function(name: &str) -> Option<pfn::VoidFunction> {
    table! { name;
        "xrPollEvent" PollEvent poll_event;
        "xrStringToPath" StringToPath string_to_path;
        "xrPathToString" PathToString path_to_string;
        "xrCreateActionSet" CreateActionSet create_action_set;
        "xrDestroyActionSet" DestroyActionSet destroy_action_set;
        "xrCreateAction" CreateAction create_action;
        "xrDestroyAction" DestroyAction destroy_action;
        "xrSuggestInteractionProfileBindings" SuggestInteractionProfileBindings suggest;
        "xrSyncActions" SyncActions sync_actions;
        "xrGetActionStatePose" GetActionStatePose get_pose;
        "xrGetCurrentInteractionProfile" GetCurrentInteractionProfile get_current_profile;
        "xrCreateActionSpace" CreateActionSpace create_action_space;
    }
}

fn note(call: &'static str) {
    ACTIONS.with_borrow_mut(|calls| calls.push(call));
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn poll_event(_: xr::Instance, event: *mut xr::EventDataBuffer) -> xr::Result {
    let Some(session) = CHANGED.with_borrow_mut(VecDeque::pop_front) else {
        return xr::Result::EVENT_UNAVAILABLE;
    };
    let ty = xr::EventDataInteractionProfileChanged::TYPE;
    let changed = xr::EventDataInteractionProfileChanged { ty, next: std::ptr::null(), session };
    // SAFETY: the layer passes a valid buffer, which is larger than every event, and as aligned.
    unsafe { event.cast::<xr::EventDataInteractionProfileChanged>().write(changed) };
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn string_to_path(
    _: xr::Instance,
    text: *const c_char,
    path: *mut xr::Path,
) -> xr::Result {
    // SAFETY: the layer passes a string, and a place for the path.
    let (text, path) = unsafe { (CStr::from_ptr(text), &mut *path) };
    PATHS.with_borrow_mut(|paths| {
        let known = paths.iter().position(|known| known.as_c_str() == text);
        let at = known.unwrap_or_else(|| {
            paths.push(text.to_owned());
            paths.len() - 1
        });
        *path = xr::Path::from_raw(at as u64 + 1);
    });
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn path_to_string(
    _: xr::Instance,
    path: xr::Path,
    capacity: u32,
    length: *mut u32,
    text: *mut c_char,
) -> xr::Result {
    let known = |paths: &Vec<CString>| paths.get((path.into_raw() as usize).wrapping_sub(1)).cloned();
    let Some(known) = PATHS.with_borrow(known) else { return xr::Result::ERROR_PATH_INVALID };
    // SAFETY: the layer passes a place for the length, and a buffer of that capacity.
    unsafe {
        *length = known.count_bytes() as u32 + 1;
        for (at, byte) in known.as_bytes_with_nul().iter().enumerate().take(capacity as usize) {
            *text.add(at) = *byte as c_char;
        }
    }
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_action_set(
    _: xr::Instance,
    _: *const xr::ActionSetCreateInfo,
    set: *mut xr::ActionSet,
) -> xr::Result {
    note("xrCreateActionSet");
    // SAFETY: the layer passes a place for the handle.
    unsafe { *set = xr::ActionSet::from_raw(new_handle()) };
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn destroy_action_set(_: xr::ActionSet) -> xr::Result {
    note("xrDestroyActionSet");
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_action(
    _: xr::ActionSet,
    _: *const xr::ActionCreateInfo,
    action: *mut xr::Action,
) -> xr::Result {
    note("xrCreateAction");
    // SAFETY: the layer passes a place for the handle.
    unsafe { *action = xr::Action::from_raw(new_handle()) };
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn destroy_action(_: xr::Action) -> xr::Result {
    note("xrDestroyAction");
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn suggest(
    _: xr::Instance,
    suggestion: *const xr::InteractionProfileSuggestedBinding,
) -> xr::Result {
    note("xrSuggestInteractionProfileBindings");
    // SAFETY: the layer passes a valid structure with an array of that many bindings.
    let bindings = unsafe {
        let suggestion = &*suggestion;
        std::slice::from_raw_parts(
            suggestion.suggested_bindings,
            suggestion.count_suggested_bindings as usize,
        )
    };
    let actions = bindings.iter().map(|binding| binding.action).collect();
    SUGGESTED.with_borrow_mut(|suggested| suggested.push(actions));
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn sync_actions(_: xr::Session, info: *const xr::ActionsSyncInfo) -> xr::Result {
    note("xrSyncActions");
    // SAFETY: the layer passes a valid structure with an array of that many sets.
    let sets = unsafe {
        let info = &*info;
        (0..info.count_active_action_sets as usize).map(|at| (*info.active_action_sets.add(at)).action_set)
    };
    SYNCED.with_borrow_mut(|synced| synced.push(sets.collect()));
    SYNC_RESULTS.with_borrow_mut(VecDeque::pop_front).unwrap_or(xr::Result::SUCCESS)
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn get_pose(
    _: xr::Session,
    _: *const xr::ActionStateGetInfo,
    state: *mut xr::ActionStatePose,
) -> xr::Result {
    // SAFETY: the layer passes a valid structure.
    unsafe { (*state).is_active = IS_ACTIVE.get().into() };
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn get_current_profile(
    _: xr::Session,
    _: xr::Path,
    profile: *mut xr::InteractionProfileState,
) -> xr::Result {
    // SAFETY: the layer passes a valid structure.
    unsafe { (*profile).interaction_profile = PROFILE.get() };
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_action_space(
    _: xr::Session,
    _: *const xr::ActionSpaceCreateInfo,
    space: *mut xr::Space,
) -> xr::Result {
    let made = xr::Space::from_raw(new_handle());
    GAZE_SPACES.with_borrow_mut(|spaces| spaces.push(made));
    // SAFETY: the layer passes a place for the handle.
    unsafe { *space = made };
    xr::Result::SUCCESS
}
