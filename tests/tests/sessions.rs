//! Sessions that come and go on one device.

use parafovea_cases::life::Life;
use parafovea_test_layers::FaultReport;
use parafovea_tests::run::{Application, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

/// Attenuates the colour of pictures of one format, for which it takes one graphics pipeline.
const CHROMA: &str = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[chroma]\nmode = \"default\"\n";

#[test]
fn sessions_on_one_device_share_pipelines_which_go_with_it() {
    let application = Application::ours("parafovea-cases", &["--soak", "1"]).unwrap();
    let outcome = Run::new(&application, &Scenario::new(0))
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
