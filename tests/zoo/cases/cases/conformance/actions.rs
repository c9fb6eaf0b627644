//! Actions for the gaze: creation, bindings, attachment, and refused calls.

use super::{Calls, EYES, NOBODYS, Outcome, malformed};
use crate::app::App;
use crate::cases::FRAMES;
use crate::controls::{GAZE_POSE, LEFT_SELECT, SIMPLE};
use crate::session::{IDENTITY, Session};
use openxr_sys as xr;
use openxr_sys::Handle;

/// Sections: XR_EXT_eye_gaze_interaction, "Eye gaze input"; Input, "Action Sets", "Creating Actions" and "Suggested Bindings".
pub fn conforms_in_suggestions(app: &App) -> Outcome {
    let calls = Calls::new(app);
    let (set, gaze) = calls.gaze()?;
    let pose = calls.path(GAZE_POSE)?;
    let suggest = |what: &str, bindings: &[(xr::Action, xr::Path)], expected| {
        calls.expect("Suggested Bindings", what, calls.suggest(bindings)?, expected);
        Outcome::Ok(())
    };
    suggest("the same again", &[(gaze, pose)], xr::Result::SUCCESS)?;
    suggest("the same many times at once", &[(gaze, pose); 16], xr::Result::SUCCESS)?;
    // A runtime converts between types where it can, and else binds nothing.
    for ty in [xr::ActionType::BOOLEAN_INPUT, xr::ActionType::VIBRATION_OUTPUT] {
        let other = calls.controls.action(set, ty, &[])?;
        suggest("an action of another type", &[(other, pose)], xr::Result::SUCCESS)?;
    }
    suggest("nothing", &[], xr::Result::ERROR_VALIDATION_FAILURE)?;
    let wrong = calls.suggest_as(xr::ActionsSyncInfo::TYPE, super::GAZE, &[(gaze, pose)])?;
    calls.expect(
        "Suggested Bindings",
        "a structure of another type",
        wrong,
        xr::Result::ERROR_VALIDATION_FAILURE,
    );
    let nobodys = xr::Action::from_raw(NOBODYS);
    suggest("an action that is none", &[(nobodys, pose)], xr::Result::ERROR_HANDLE_INVALID)?;
    for binding in [
        "/invalid",
        EYES,
        "/user/eyes_ext/input",
        "/user/eyes_ext/input/gaze_ext/click",
        "/user/eyes_ext/input/gaze_ext/pose/x",
        "/user/eyes_ext/output/gaze_ext/pose",
        "/user/hand/left/input/gaze_ext/pose",
        LEFT_SELECT,
    ] {
        let path = calls.path(binding)?;
        suggest(binding, &[(gaze, path)], xr::Result::ERROR_PATH_UNSUPPORTED)?;
        suggest(binding, &[(gaze, pose), (gaze, path)], xr::Result::ERROR_PATH_UNSUPPORTED)?;
    }
    for path in [xr::Path::NULL, xr::Path::from_raw(NOBODYS << 32)] {
        suggest("a path that is none", &[(gaze, path)], xr::Result::ERROR_PATH_INVALID)?;
    }
    let of_simple =
        calls.suggest_as(xr::InteractionProfileSuggestedBinding::TYPE, SIMPLE, &[(gaze, pose)])?;
    calls.expect("Suggested Bindings", "to a hand", of_simple, xr::Result::ERROR_PATH_UNSUPPORTED);
    for other in ["/interaction_profiles/ext/eye_gaze_interaction/x", "/interaction_profiles/ext"] {
        let result =
            calls.suggest_as(xr::InteractionProfileSuggestedBinding::TYPE, other, &[(gaze, pose)])?;
        calls.expect("Suggested Bindings", other, result, xr::Result::ERROR_PATH_UNSUPPORTED);
    }
    let eyes = calls.path(EYES)?;
    let create = |what: &str, name, users: &[xr::Path], expected| {
        calls.expect("Creating Actions", what, calls.create_action(set, name, users), expected);
    };
    let unsupported = xr::Result::ERROR_PATH_UNSUPPORTED;
    create("of the eyes", c"of_eyes", &[eyes], xr::Result::SUCCESS);
    create("of eyes and hand", c"of_both", &[eyes, calls.path("/user/hand/left")?], xr::Result::SUCCESS);
    create("of the eyes twice", c"twice", &[eyes, eyes], unsupported);
    create("of nobody", c"of_nobody", &[eyes, calls.path("/user/invalid")?], unsupported);
    create("of no path", c"of_no_path", &[eyes, xr::Path::NULL], xr::Result::ERROR_PATH_INVALID);
    // SAFETY: action and set are live, and not used any more but to see that they are gone.
    let (action, later, set_result) = unsafe {
        let functions = &app.xr.functions;
        let action = (functions.destroy_action)(gaze);
        let later = calls.suggest(&[(gaze, pose)])?;
        (action, later, (functions.destroy_action_set)(set))
    };
    calls.expect("Creating Actions", "destroy the action", action, xr::Result::SUCCESS);
    calls.expect("Object Handle Types", "it is no action now", later, xr::Result::ERROR_HANDLE_INVALID);
    calls.expect("Action Sets", "destroy the set", set_result, xr::Result::SUCCESS);
    // Another life, after the first.
    calls.gaze().map(drop)
}

/// Sections: Input, "Action Sets", "Suggested Bindings", "Current Interaction Profile", "Reading Input Action State", "Input Action State
/// Synchronization"; Spaces, "Action Spaces".
pub fn conforms_in_attaching(app: &App) -> Outcome {
    let calls = Calls::new(app);
    let (set, gaze) = calls.gaze()?;
    let button = calls.controls.action(set, xr::ActionType::BOOLEAN_INPUT, &[])?;
    let (eyes, pose) = (calls.path(EYES)?, calls.path(GAZE_POSE)?);
    let session = Session::start(app)?;
    let handle = session.handle;
    let not_attached = xr::Result::ERROR_ACTIONSET_NOT_ATTACHED;
    for (section, result) in [
        ("Reading Input Action State", calls.pose(handle, gaze, xr::Path::NULL).0),
        ("Input Action State Synchronization", calls.sync(handle, &[set])),
        ("Current Interaction Profile", calls.profile(handle, eyes).0),
        ("Bound Sources", calls.sources(handle, gaze, 0).0),
        ("Bound Sources", calls.name_of(handle, pose, 1, 0).0),
    ] {
        calls.expect(section, "before attaching", result, not_attached);
    }
    let nothing = calls.attach(handle, &[]);
    calls.expect("Action Sets", "attach nothing", nothing, xr::Result::ERROR_VALIDATION_FAILURE);
    calls.expect("Action Sets", "attach", calls.attach(handle, &[set]), xr::Result::SUCCESS);
    let late = xr::Result::ERROR_ACTIONSETS_ALREADY_ATTACHED;
    calls.expect("Action Sets", "attach again", calls.attach(handle, &[set]), late);
    calls.expect("Suggested Bindings", "after attaching", calls.suggest(&[(gaze, pose)])?, late);
    calls.expect("Creating Actions", "in an attached set", calls.create_action(set, c"late", &[]), late);

    let no_path = xr::Path::NULL;
    let (result, space) = calls.create_space(handle, (gaze, no_path), IDENTITY);
    calls.expect("Action Spaces", "a space of the gaze", result, xr::Result::SUCCESS);
    let (result, _) = calls.create_space(handle, (button, no_path), IDENTITY);
    calls.expect("Action Spaces", "of a button", result, xr::Result::ERROR_ACTION_TYPE_MISMATCH);
    let (result, _) = calls.create_space(handle, (gaze, eyes), IDENTITY);
    calls.expect("Action Spaces", "of a user it is not for", result, xr::Result::ERROR_PATH_UNSUPPORTED);
    let (result, _) = calls.create_space(handle, (gaze, no_path), malformed());
    calls.expect("Action Spaces", "with a pose that is none", result, xr::Result::ERROR_POSE_INVALID);
    // SAFETY: the space is live, and used no more.
    let result = unsafe { (app.xr.functions.destroy_space)(space) };
    calls.expect("Action Spaces", "destroy it", result, xr::Result::SUCCESS);

    let ask = |what: &str, user, expected| {
        calls.expect("Current Interaction Profile", what, calls.profile(handle, user).0, expected);
    };
    ask("of the eyes", eyes, xr::Result::SUCCESS);
    ask("of no path", no_path, xr::Result::ERROR_PATH_INVALID);
    ask("of a part of the eyes", pose, xr::Result::ERROR_PATH_UNSUPPORTED);
    ask("of nobody", calls.path("/user/invalid")?, xr::Result::ERROR_PATH_UNSUPPORTED);
    let (result, _) = calls.profile_as(xr::ActionCreateInfo::TYPE, handle, eyes);
    let failure = xr::Result::ERROR_VALIDATION_FAILURE;
    calls.expect("Current Interaction Profile", "in a structure of another type", result, failure);
    session.frames(FRAMES, |frame| session.submit(frame, &[]))?;
    session.finish()
}
