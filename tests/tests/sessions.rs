//! Sessions that come and go on one device.

use parafovea_test_layers::FaultReport;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use parafovea_zoo::WINDOW;
use parafovea_zoo::cases::life::Life;
use parafovea_zoo::cases::report::Report;

/// Attenuates the colour of pictures of one format, for which it takes one graphics pipeline.
const CHROMA: &str = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[chroma]\nmode = \"default\"\n";

#[test]
fn sessions_on_one_device_share_pipelines_which_go_with_it() {
    let application = Application::ours("parafovea-cases", &["--soak", "1"]).unwrap();
    let outcome = Run::new(&application, &Scenario::new(0).sized(96, 112))
        .on(CHROMA)
        .faulted(None)
        .validated()
        .finish()
        .unwrap()
        .expect_end()
        .unwrap();
    let lives = outcome.output.lines().filter(|line| serde_json::from_str::<Life>(line).is_ok()).count();
    assert!(lives >= 1, "each of several sessions: {}", outcome.output);
    let sessions = outcome.log.lines().filter(|line| line.contains("session active")).count();
    assert!(sessions >= 2, "{sessions} sessions\n{}", outcome.log);
    let reports: Vec<FaultReport> = outcome.faults().unwrap();
    let made: u64 = reports.iter().filter_map(|report| report.own.get("vkCreateGraphicsPipelines")).sum();
    assert_eq!(made, 1, "of {sessions} sessions");
    // A pipeline that is left is an object that the device still has.
    assert!(outcome.findings.vulkan.is_empty(), "{:?}", outcome.findings.vulkan);
}

/// An application closes both loaders, which let go of all libraries, and opens them again: the layer is loaded each time, and works.
#[test]
fn loaders_may_be_closed_and_opened_again() {
    const LIVES: usize = 3;
    let application = Application::ours("parafovea-cases", &["separate_swapchains", "--lives", "3"]).unwrap();
    // The runtime starts a new record with each life.
    let run = Run::new(&application, &Scenario::new(0).saving(&[6])).validated();
    let [off, on] = [run.clone(), run.on(CHROMA)].map(|run| run.finish().unwrap().expect_end().unwrap());
    let reports = |outcome: &Outcome| -> Vec<Report> {
        outcome.output.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
    };
    assert_eq!(reports(&off).len(), LIVES, "{}", off.output);
    assert_eq!(reports(&off), reports(&on), "{}", on.log);
    assert_eq!(on.log.matches("session active").count(), LIVES, "{}", on.log);
    let new = on.findings.beyond(&off.findings);
    assert!(new.is_empty(), "{new:#?}");
    for view in 0..2 {
        let [off, on] = [&off, &on].map(|outcome| outcome.submitted(view, 6).unwrap());
        assert!(off != on, "view {view} of the last life is as without the layer");
    }
}

/// An application goes on in a window when its session has ended, with the pass that had a mask.
#[test]
fn a_window_after_the_session_is_at_full_rate() {
    const RINGS: &str = "[gaze]\nsource = \"centre\"\n[rates]\ngate = \"on\"\n[chroma]\nmode = \"off\"\n";
    const FRAMES: u64 = 24;
    let frames = FRAMES.to_string();
    let arguments = ["--style", "offscreen-tonemap", "--frames", &frames, "--window-frames", "5"];
    let application = Application::ours("parafovea-zoo", &arguments).unwrap();
    let run = Run::new(&application, &Scenario::new(FRAMES).saving(&[FRAMES - 1])).validated();
    let [off, on] =
        [run.clone(), run.on(RINGS)].map(|run| run.finish().unwrap().expect_frames(FRAMES).unwrap());
    let window = |outcome: &Outcome| {
        let line = outcome.output.lines().find_map(|line| line.strip_prefix(WINDOW).map(str::to_owned));
        line.unwrap_or_else(|| panic!("{}", outcome.output))
    };
    let [shown_off, shown_on] = [&off, &on].map(|outcome| outcome.submitted(0, FRAMES - 1).unwrap());
    assert!(shown_off != shown_on, "the session had no mask\n{}", on.log);
    assert_eq!(window(&off), window(&on), "{}", on.log);
    let new = on.findings.beyond(&off.findings);
    assert!(new.is_empty(), "{new:#?}");
}
