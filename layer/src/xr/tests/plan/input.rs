//! The application's actions and profiles beside the layer's action set.

use super::*;
use crate::xr::tests::fake::actions::{CHANGED, IS_ACTIVE, PROFILE, SUGGESTED, SYNC_RESULTS, SYNCED};
use std::ffi::CStr;

/// Frames without a synchronisation after which the layer synchronises, and some more.
const PATIENCE: usize = 105;

const SIMPLE: &CStr = c"/interaction_profiles/khr/simple_controller";
const SELECT: &CStr = c"/user/hand/left/input/select/click";

const FAILURE: xr::Result = xr::Result::ERROR_RUNTIME_FAILURE;

fn instance_of(application: &Application) -> xr::Instance {
    session::find(application.session).unwrap().instance.handle
}

fn path(instance: xr::Instance, text: &CStr) -> xr::Path {
    let mut path = xr::Path::NULL;
    // SAFETY: a live instance, a string and a place for the path.
    assert_eq!(unsafe { actions::string_to_path(instance, text.as_ptr(), &mut path) }, xr::Result::SUCCESS);
    path
}

fn suggest(instance: xr::Instance, profile: &CStr, bindings: &[(xr::Action, &CStr)]) {
    let bindings: Vec<_> = bindings
        .iter()
        .map(|(action, text)| xr::ActionSuggestedBinding { action: *action, binding: path(instance, text) })
        .collect();
    let suggestion = xr::InteractionProfileSuggestedBinding {
        ty: xr::InteractionProfileSuggestedBinding::TYPE,
        next: ptr::null(),
        interaction_profile: path(instance, profile),
        count_suggested_bindings: bindings.len() as u32,
        suggested_bindings: bindings.as_ptr(),
    };
    // SAFETY: a live instance and a valid structure.
    assert_eq!(unsafe { actions::suggest_bindings(instance, &suggestion) }, xr::Result::SUCCESS);
}

/// An application with a button, whose eyes nobody sees.
fn with_button() -> Application {
    EYES.set(None);
    let application = Application::new();
    suggest(instance_of(&application), SIMPLE, &[(xr::Action::from_raw(fake::new_handle()), SELECT)]);
    ACTIONS.take();
    application
}

fn sync(application: &Application, sets: &[xr::ActionSet]) -> xr::Result {
    let active =
        |set: &xr::ActionSet| xr::ActiveActionSet { action_set: *set, subaction_path: xr::Path::NULL };
    let active: Vec<_> = sets.iter().map(active).collect();
    let info = xr::ActionsSyncInfo {
        ty: xr::ActionsSyncInfo::TYPE,
        next: ptr::null(),
        count_active_action_sets: active.len() as u32,
        active_action_sets: active.as_ptr(),
    };
    // SAFETY: a live session and a valid structure.
    unsafe { actions::sync(application.session, &info) }
}

fn profile(application: &Application) -> xr::Path {
    let mut state = xr::InteractionProfileState {
        ty: xr::InteractionProfileState::TYPE,
        next: ptr::null_mut(),
        interaction_profile: xr::Path::NULL,
    };
    let user = path(instance_of(application), c"/user/hand/left");
    // SAFETY: a live session and a valid structure.
    let result = unsafe { actions::get_current_profile(application.session, user, &mut state) };
    assert_eq!(result, xr::Result::SUCCESS);
    state.interaction_profile
}

/// Whether an event about the profiles is waiting, which is taken.
fn has_event(application: &Application) -> bool {
    // SAFETY: plain data, for which all zero is a valid value; a live instance and a valid buffer.
    unsafe {
        let mut event: xr::EventDataBuffer = std::mem::zeroed();
        event.ty = xr::EventDataBuffer::TYPE;
        actions::poll_event(instance_of(application), &mut event) == xr::Result::SUCCESS
            && event.ty == xr::EventDataInteractionProfileChanged::TYPE
    }
}

/// The runtime chooses a profile, because the layer synchronises ahead of the application.
fn chosen_ahead() -> (Application, xr::Path) {
    let application = with_button();
    (0..PATIENCE).for_each(|_| application.frame());
    assert!(!SYNCED.take().is_empty(), "ahead of the application");
    let chosen = path(instance_of(&application), SIMPLE);
    PROFILE.set(chosen);
    CHANGED.with_borrow_mut(|changed| changed.push_back(application.session));
    assert!(!has_event(&application) && profile(&application) == xr::Path::NULL, "too early");
    (application, chosen)
}

#[test]
fn a_layer_that_cannot_synchronise_hides_no_profile() {
    let (application, chosen) = chosen_ahead();
    SYNC_RESULTS.with_borrow_mut(|results| results.push_back(FAILURE));
    application.frame();
    assert_eq!(profile(&application), chosen);
    assert!(has_event(&application), "kept back until now");
    assert!(!has_event(&application));
}

#[test]
fn a_synchronisation_that_works_without_the_layer_alone_hides_no_profile() {
    let (application, chosen) = chosen_ahead();
    SYNC_RESULTS.with_borrow_mut(|results| results.push_back(FAILURE));
    assert_eq!(sync(&application, &[xr::ActionSet::from_raw(5)]), xr::Result::SUCCESS);
    assert_eq!(SYNCED.take().last().unwrap(), &[xr::ActionSet::from_raw(5)]);
    assert_eq!(profile(&application), chosen);
    assert!(has_event(&application), "kept back until now");
}

/// Runtimes check little without the focus.
#[test]
fn a_synchronisation_without_the_focus_does_not_prove_that_the_layers_works() {
    let application = with_button();
    let set = [xr::ActionSet::from_raw(5)];
    SYNC_RESULTS.set([xr::Result::SESSION_NOT_FOCUSED, FAILURE].into());
    assert_eq!(sync(&application, &set), xr::Result::SESSION_NOT_FOCUSED);
    assert_eq!(sync(&application, &set), xr::Result::SUCCESS, "without the layer's set");
    assert_eq!(SYNCED.take().iter().map(Vec::len).collect::<Vec<_>>(), [2, 2, 1]);
    // Later failures are the application's.
    let application = with_button();
    SYNC_RESULTS.set([xr::Result::SUCCESS, FAILURE].into());
    assert_eq!([(); 2].map(|()| sync(&application, &set)), [xr::Result::SUCCESS, FAILURE]);
}

#[test]
fn nothing_is_synchronised_where_the_gaze_is_there_without() {
    let synced = || {
        let application = Application::new();
        (0..PATIENCE).for_each(|_| application.frame());
        SYNCED.take().len()
    };
    EYES.set(None);
    IS_ACTIVE.set(true);
    assert_eq!(synced(), 0, "actions are active from their attachment; the eyes are closed");
    IS_ACTIVE.set(false);
    look(5.0);
    assert_eq!(synced(), 0, "the gaze is located");
    EYES.set(None);
    assert_eq!(synced(), PATIENCE - 99, "from frame 100 on");
}

#[test]
fn no_action_set_is_synchronised_where_the_runtime_keeps_the_gaze() {
    let application = with_button();
    let mut sets_of = |is_active| {
        IS_ACTIVE.set(is_active);
        assert_eq!(sync(&application, &[]), xr::Result::SUCCESS);
        SYNCED.take().iter().map(Vec::len).collect::<Vec<_>>()
    };
    assert_eq!([true, true].map(&mut sets_of), [[0], [0]]);
    assert_eq!(sets_of(false), [0, 1], "the specification: no action is active");
    assert_eq!(sets_of(false), [1]);
    // Older versions of Monado refuse the call.
    let application = with_button();
    SYNC_RESULTS.set([xr::Result::ERROR_VALIDATION_FAILURE].into());
    assert_eq!(sync(&application, &[]), xr::Result::ERROR_VALIDATION_FAILURE);
}

#[test]
fn destroyed_actions_reach_no_suggestion_of_the_layer() {
    let instance = create_instance(&[c"XR_EXT_eye_gaze_interaction".as_ptr()]).unwrap();
    // SAFETY: plain data, for which all zero is a valid value.
    let (set_info, action_info) = unsafe { (std::mem::zeroed(), std::mem::zeroed()) };
    let make = || {
        let (mut set, mut action) = (xr::ActionSet::NULL, xr::Action::NULL);
        // SAFETY: a live instance, structures that the stand-in does not read, and places for the handles.
        unsafe {
            assert_eq!(actions::create_action_set(instance, &set_info, &mut set), xr::Result::SUCCESS);
            assert_eq!(actions::create_action(set, &action_info, &mut action), xr::Result::SUCCESS);
        }
        (set, action)
    };
    let [(set, of_set), (_, destroyed), (kept, action)] = [make(), make(), make()];
    let pose = c"/user/eyes_ext/input/gaze_ext/pose";
    let gaze = c"/interaction_profiles/ext/eye_gaze_interaction";
    suggest(instance, gaze, &[(of_set, pose), (destroyed, pose), (action, pose)]);
    // SAFETY: live handles.
    unsafe {
        assert_eq!(actions::destroy_action_set(set), xr::Result::SUCCESS);
        assert_eq!(actions::destroy_action(destroyed), xr::Result::SUCCESS);
    }
    SUGGESTED.take();
    let session = session_of(instance);
    let info = xr::SessionActionSetsAttachInfo {
        ty: xr::SessionActionSetsAttachInfo::TYPE,
        next: ptr::null(),
        count_action_sets: 1,
        action_sets: &kept,
    };
    // SAFETY: valid arguments.
    assert_eq!(unsafe { actions::attach(session, &info) }, xr::Result::SUCCESS);
    let suggested = SUGGESTED.take();
    let [with_ours] = suggested.as_slice() else { panic!("{suggested:?}") };
    assert!(with_ours.len() == 2 && with_ours[0] == action, "{with_ours:?}");
}
