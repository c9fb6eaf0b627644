//! Every case of `parafovea-cases` about input, and runtimes that are not as they should be.

use super::{assert_ours_is_first, following, gaze_reads, input_at_the_runtime, new_errors, run, scenario};
use parafovea_tests::run::{Application, Outcome};
use parafovea_tests::scenario::{Gaze, Scenario};
use parafovea_zoo::cases::report::Report;

/// A case with its expectations of the layer.
struct Case {
    /// The case of the application.
    application: &'static str,
    arguments: &'static [&'static str],
    /// Lines of the configuration, about the gaze.
    gaze: &'static str,
    /// Whether the layer gets a gaze.
    is_followed: bool,
    /// Violations by the layer that the runtime sees and the application does not.
    errors: &'static [&'static str],
    /// Lines of the log.
    log: &'static str,
    /// Whether the number of the application's calls is random.
    has_own_pace: bool,
    scenario: fn(&mut Scenario),
}

impl Case {
    const fn new(application: &'static str) -> Self {
        Self {
            application,
            arguments: &[],
            gaze: "",
            is_followed: true,
            errors: &[],
            log: "",
            has_own_pace: false,
            scenario: |_| {},
        }
    }

    fn check(&self) {
        let mut arguments = vec![self.application];
        arguments.extend(self.arguments);
        let application = Application::ours("parafovea-cases", &arguments).unwrap();
        let mut scenario = scenario(1000);
        (self.scenario)(&mut scenario);
        let reference = run(&application, &scenario, None);
        let outcome = run(&application, &scenario, Some(&following(self.gaze)));

        let (expected, seen) = (report(&reference), report(&outcome));
        assert_eq!(reference.exit_code, Some(0), "{}", reference.output);
        assert_eq!(expected.unexpected, Vec::<String>::new());
        for (at, (line, other)) in expected.trace.iter().zip(&seen.trace).enumerate() {
            assert_eq!(
                line,
                other,
                "{at} after {:#?}\n{}",
                &seen.trace[at.saturating_sub(20)..at],
                outcome.log
            );
        }
        assert_eq!(expected, seen, "{}", outcome.log);
        assert_eq!(outcome.exit_code, Some(0), "{}\n{}", outcome.output, outcome.log);
        assert_eq!(new_errors(&reference, &outcome), self.errors, "{}", outcome.log);
        if !self.has_own_pace {
            assert_eq!(input_at_the_runtime(&reference), input_at_the_runtime(&outcome));
        }
        assert_ours_is_first(&outcome);
        let own_reads = gaze_reads(&outcome).checked_sub(gaze_reads(&reference));
        assert_eq!(own_reads.is_some_and(|reads| reads > 0), self.is_followed, "{}", outcome.log);
        assert!(outcome.log.contains(self.log), "{}", outcome.log);
    }
}

fn report(outcome: &Outcome) -> Report {
    let report = outcome.output.lines().find_map(|line| serde_json::from_str(line).ok());
    report.unwrap_or_else(|| panic!("no report:\n{}\n{}", outcome.output, outcome.log))
}

macro_rules! cases {
    ($($name:ident $({ $($field:ident: $value:expr),* $(,)? })?,)*) => {
        /// Names of the cases of the application that have a test of the same name here.
        pub const TESTED: &[&str] = &[$(stringify!($name)),*];

        $(#[test]
        fn $name() {
            Case { $($($field: $value,)*)? ..Case::new(stringify!($name)) }.check();
        })*
    };
}

cases! {
    attaches_early,
    attaches_after_a_loading_screen,
    has_no_input_before_all_is_loaded,
    asks_for_paths_and_waits { gaze: "attach_alone_after_s = 1" },
    never_attaches { gaze: "attach_alone_after_s = 1", is_followed: false },
    has_no_input { gaze: "attach_alone_after_s = 1" },
    attaches_twice,
    attaches_nothing_first,
    makes_spaces_before_attaching,
    adds_to_an_attached_set,
    never_synchronises { log: "does not synchronise" },
    synchronises_late,
    synchronises_before_attaching,
    synchronises_nothing,
    has_sets_of_different_priority,
    has_sets_of_the_same_priority,
    tells_hands_apart,
    synchronises_on_another_thread { has_own_pace: true },
    locates_views_on_another_thread,
    attaches_the_same_sets_to_each_session,
    makes_new_sets_for_each_session,
    drops_sessions_unused,
    looks_at_the_gaze_itself,
    looks_at_the_gaze_with_priority,
    looks_at_the_gaze_in_two_sets,
    finds_the_gaze_in_every_space,
    tells_eyes_from_hands,
    suggests_gaze_without_its_extension,
    suggests_gaze_in_each_session,
}

macro_rules! variants {
    ($($name:ident: $application:literal { $($field:ident: $value:expr),* $(,)? },)*) => {
        $(#[test]
        fn $name() {
            Case { $($field: $value,)* ..Case::new($application) }.check();
        })*
    };
}

/// The extension, as the runtime lists or refuses it.
fn gaze_extension() -> Vec<String> {
    vec!["XR_EXT_eye_gaze_interaction".to_owned()]
}

variants! {
    has_no_input_where_nothing_may_be_attached_alone: "has_no_input" {
        gaze: "attach_alone_after_s = 0",
        is_followed: false,
    },
    wine_asks_what_there_is: "attaches_early" {
        arguments: &["--name", "wineopenxr test instance"],
        is_followed: false,
    },
    the_runtime_has_no_eye_gaze: "attaches_early" {
        is_followed: false,
        scenario: |scenario| scenario.system.extensions_off = gaze_extension(),
        errors: &["xrCreateInstance XR_ERROR_EXTENSION_NOT_PRESENT"],
        log: "EXTENSION_NOT_PRESENT",
    },
    the_runtime_lists_eye_gaze_and_refuses_it: "attaches_early" {
        is_followed: false,
        scenario: |scenario| scenario.quirks.refused_extensions = gaze_extension(),
        errors: &["xrCreateInstance XR_ERROR_EXTENSION_NOT_PRESENT"],
        log: "EXTENSION_NOT_PRESENT",
    },
    the_runtime_has_eye_gaze_and_does_not_list_it: "attaches_early" {
        scenario: |scenario| scenario.quirks.unlisted_extensions = gaze_extension(),
    },
    the_runtime_lacks_a_function_for_layers: "attaches_early" {
        scenario: |scenario| {
            scenario.quirks.missing_functions = vec!["xrEnumerateApiLayerProperties".to_owned()];
        },
    },
    the_runtime_keeps_only_the_last_action_set: "attaches_early" {
        is_followed: false,
        scenario: |scenario| scenario.quirks.only_last_set = true,
    },
    the_runtime_activates_what_is_attached_and_nothing_is_synchronised: "never_synchronises" {
        scenario: |scenario| scenario.quirks.active_from_attachment = true,
    },
    the_runtime_activates_what_is_attached_and_the_eyes_are_seen_late: "never_synchronises" {
        scenario: |scenario| {
            scenario.quirks.active_from_attachment = true;
            let at = |t, tracked| Gaze { t, tracked, ..scenario.gaze[0] };
            scenario.gaze = vec![at(0.0, false), at(1.4, true)];
        },
    },
    the_runtime_activates_what_is_attached_before_it_is_synchronised: "synchronises_late" {
        scenario: |scenario| scenario.quirks.active_from_attachment = true,
    },
    the_runtime_keeps_what_is_active_where_nothing_is_synchronised: "synchronises_nothing" {
        scenario: |scenario| scenario.quirks.active_from_attachment = true,
    },
    the_runtime_refuses_spaces_before_attaching: "makes_spaces_before_attaching" {
        scenario: |scenario| scenario.quirks.no_early_spaces = true,
    },
    the_runtime_denies_its_eye_tracker: "attaches_early" {
        is_followed: false,
        scenario: |scenario| scenario.tracker.reported = false,
        log: "without an eye tracker",
    },
    the_headset_has_no_eye_tracker: "has_no_input" {
        gaze: "attach_alone_after_s = 1",
        is_followed: false,
        scenario: |scenario| scenario.system.eye_gaze = false,
        log: "without an eye tracker",
    },
    the_eye_tracker_never_becomes_active: "looks_at_the_gaze_itself" {
        is_followed: false,
        scenario: |scenario| scenario.tracker.active = false,
    },
    the_eyes_are_never_seen: "looks_at_the_gaze_with_priority" {
        is_followed: false,
        scenario: |scenario| scenario.gaze = vec![Gaze { tracked: false, ..scenario.gaze[0] }],
    },
    the_eyes_are_lost_for_long: "attaches_after_a_loading_screen" {
        scenario: |scenario| {
            let at = |t, tracked| Gaze { t, tracked, ..scenario.gaze[0] };
            scenario.gaze = vec![at(0.0, true), at(1.48, false), at(1.5, true)];
        },
    },
    the_gaze_is_outside_of_the_views: "attaches_early" {
        scenario: |scenario| scenario.gaze = vec![Gaze { yaw_deg: 62.0, ..scenario.gaze[0] }],
        log: "a gaze sample was rejected: the gaze is outside",
    },
    the_gaze_comes_out_of_the_back_of_the_head: "attaches_early" {
        scenario: |scenario| scenario.tracker.backwards = true,
        log: "a gaze sample was rejected: the gaze points backwards",
    },
    the_gaze_has_no_time: "attaches_early" {
        scenario: |scenario| scenario.tracker.sample_time = false,
    },
    the_application_has_no_focus_at_first: "attaches_early" {
        scenario: |scenario| scenario.session.focused_from = 6,
    },
    the_application_has_no_focus_for_long: "synchronises_late" {
        scenario: |scenario| scenario.session.focused_from = 133,
    },
    nobody_holds_a_controller: "attaches_early" {
        scenario: |scenario| scenario.system.hands = Vec::new(),
    },
    nobody_holds_a_controller_and_nothing_is_synchronised: "synchronises_late" {
        scenario: |scenario| scenario.system.hands = Vec::new(),
    },
}
