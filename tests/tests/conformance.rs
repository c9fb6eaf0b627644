//! Conformance of the offered gaze (`gaze.offer`): the checks of Khronos' conformance suite (OpenXR-CTS) for a runtime with
//! XR_EXT_eye_gaze_interaction pass on the mock runtime without it, with the layer, through the real loader. The suite itself is not built
//! here; the statements are the specification's, checked by the application's cases (`tests/zoo/cases/cases/conformance`), each with its
//! section. That a runtime can fulfil them all is checked on the mock runtime with the extension, without the layer.
//!
//! | Suite | Statements | Case |
//! |---|---|---|
//! | XR_EXT_eye_gaze_interaction-system_support_optional, not enabled | the property stays false ("Device enumeration"); profile and user path are not supported ("Suggested Bindings", "Creating Actions") | `conforms_without_eye_gaze` |
//! | the same, enabled: paths | made, never null, the same again ("Semantic Paths") | `conforms_before_a_session` |
//! | the same: action set and bindings, destroyed | succeed ("Action Sets", "Creating Actions", "Suggested Bindings") | `conforms_in_suggestions` |
//! | the same: attach, action space, with a simple controller | succeed ("Action Sets", "Action Spaces") | `conforms_in_attaching`, `conforms_in_states` |
//! | XR_EXT_eye_gaze_interaction (interactive): localisation | active with a source, bound to the gaze, a name of the user path ("Eye gaze input", "Bound Sources") | `conforms_in_states` |
//! | XR_EXT_eye_gaze_interaction-interactive_gaze_only | both tracked bits or none; a valid pose has a sample time above 0 ("Eye gaze input") | `conforms_in_states` |
//! | xrGetSystemProperties | no system; system, name and limits; chains stay as they are ("System Properties", "Next Pointer Chains") | `conforms_before_a_session` |
//! | xrEnumerateInstanceExtensionProperties | listed once, with a version ("Extensions") | `conforms_before_a_session` |
//! | xrCreateAction | subaction paths: twice, unknown, none ("Creating Actions") | `conforms_in_suggestions` |
//! | xrSuggestInteractionProfileBindings, and by availability | called twice, duplicates, nothing, another type, unknown handles, paths and profiles, after attaching ("Suggested Bindings") | `conforms_in_suggestions`, `conforms_in_attaching` |
//! | xrAttachSessionActionSets | nothing, twice; every dependent function before it; immutability ("Action Sets") | `conforms_in_attaching` |
//! | xrGetCurrentInteractionProfile | no path, another path, another type; the event; two profiles at once ("Current Interaction Profile") | `conforms_in_attaching`, `conforms_in_states` |
//! | Action spaces | type, path and pose; offsets; with and without a path; no time; they outlive their action ("Action Spaces", "Locating Spaces") | `conforms_in_attaching`, `conforms_in_states` |
//! | Pose states | change by xrSyncActions alone, active by any source ("Input Action State Synchronization", "Reading Input Action State") | `conforms_in_states`, `conforms_with_two_profiles`, `keeps_states_until_it_synchronises` |
//! | xrEnumerateBoundSourcesForAction, xrGetInputSourceLocalizedName | two calls, every component, none, no path, no action ("Bound Sources", "Buffer Size Parameters") | `conforms_in_states` |
//!
//! Not simulated: that a person sees a ray where the person looks. [`crate::offer`] checks its numbers instead.

use crate::offer::{config, constant, report, start, with_eye_gaze, without_eye_gaze};
use crate::osc::{free_address, told};
use parafovea_tests::osc::{Sender, message};
use parafovea_tests::scenario::{Hand, Scenario};

/// Cases of the application that are tested here alone.
pub const TESTED: &[&str] = &[
    "conforms_before_a_session",
    "conforms_in_suggestions",
    "conforms_in_attaching",
    "conforms_in_states",
    "conforms_with_two_profiles",
    "keeps_states_until_it_synchronises",
    "conforms_without_eye_gaze",
];

/// The case finds nothing that differs from the specification.
fn assert_conforms(case: &str, scenario: &Scenario, config: Option<&str>, what: &str) {
    let outcome = start(&[case], scenario, config).finish().unwrap();
    let report = report(&outcome);
    assert_eq!(report.unexpected, Vec::<String>::new(), "{case}, {what}:\n{}", outcome.log);
    assert!(report.calls.len() + report.facts.len() > 3, "{case}, {what}: {report:#?}");
    assert_eq!(outcome.exit_code, Some(0), "{case}, {what}:\n{}\n{}", outcome.output, outcome.log);
}

/// On a runtime that has eye gaze, without the layer; and with the layer on one without the extension, and on one that lists it and has no
/// eye tracker.
fn check(case: &str, change: impl Fn(&mut Scenario)) {
    let folder = tempfile::tempdir().unwrap();
    let offers = config(folder.path(), &constant(), true);
    let mut without_tracker = with_eye_gaze();
    without_tracker.system.eye_gaze = false;
    for (what, mut scenario, config) in [
        ("runtime with eye gaze, no layer", with_eye_gaze(), None),
        ("runtime without the extension", without_eye_gaze(), Some(&offers)),
        ("runtime without an eye tracker", without_tracker, Some(&offers)),
    ] {
        change(&mut scenario);
        assert_conforms(case, &scenario, config.map(String::as_str), what);
    }
}

#[test]
fn extension_paths_and_properties_conform() {
    check("conforms_before_a_session", |_| {});
}

#[test]
fn suggestions_conform() {
    check("conforms_in_suggestions", |_| {});
}

#[test]
fn attaching_conforms() {
    check("conforms_in_attaching", |_| {});
}

#[test]
fn states_sources_and_spaces_conform() {
    check("conforms_in_states", |_| {});
}

/// Also where the controllers are off.
#[test]
fn an_action_of_hand_and_eyes_is_active_by_either() {
    for hands in [vec![Hand::Left, Hand::Right], Vec::new()] {
        check("conforms_with_two_profiles", |scenario| scenario.system.hands = hands.clone());
    }
}

#[test]
fn a_tracker_that_ends_changes_states_at_the_next_synchronisation() {
    let address = free_address();
    let mut scenario = without_eye_gaze();
    scenario.session.frames = 1_000_000;
    let config = format!("[gaze]\noffer = true\nosc_listen = \"{address}\"\n");
    let running = start(&["keeps_states_until_it_synchronises"], &scenario, Some(&config)).start().unwrap();
    let packets = vec![message("/tracking/eye/CenterPitchYaw", &[4.0, -7.0])];
    let sender = Sender::tracker(address, packets).unwrap();
    told(&running, |status| status.gaze.is_given);
    drop(sender);
    let outcome = running.finish().unwrap();
    assert_eq!(report(&outcome).unexpected, Vec::<String>::new(), "{}", outcome.log);
    assert_eq!(outcome.exit_code, Some(0), "{}\n{}", outcome.output, outcome.log);
}

/// Whether the layer uses the runtime's eye gaze for itself, offers it to others, or neither.
#[test]
fn nothing_of_the_extension_is_there_for_who_does_not_enable_it() {
    let folder = tempfile::tempdir().unwrap();
    let offers = config(folder.path(), &constant(), true);
    let follows = "[gaze]\nsource = \"eyes\"\nattach_alone_after_s = 1\n";
    for (what, scenario, config) in [
        ("runtime with eye gaze, no layer", with_eye_gaze(), None),
        ("the layer follows the runtime's gaze", with_eye_gaze(), Some(follows)),
        ("the layer offers a gaze beside the runtime's", with_eye_gaze(), Some(offers.as_str())),
        ("the layer offers a gaze", without_eye_gaze(), Some(offers.as_str())),
        ("the layer offers none", without_eye_gaze(), Some("preset = \"fixed\"\n")),
    ] {
        assert_conforms("conforms_without_eye_gaze", &scenario, config, what);
    }
}
