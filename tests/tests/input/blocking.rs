//! An application that holds a lock around vkQueueSubmit, above a runtime whose xrLocateSpace waits for that lock, as one does
//! that asks another process: neither waits for the other because of us.

use super::{following, gaze_reads, scenario};
use parafovea_test_layers::ShadingRateProfile;
use parafovea_tests::run::{Application, Run};
use std::time::Duration;

fn check(case: &str) {
    let folder = tempfile::tempdir().unwrap();
    let lock = folder.path().join("queue.lock");
    std::fs::write(&lock, "").unwrap();
    let arguments = [case, "--submit-lock", lock.to_str().unwrap()];
    let application = Application::ours("parafovea-cases", &arguments).unwrap();
    let mut scenario = scenario(1000);
    scenario.quirks.locate_lock.clone_from(&lock);
    let config =
        following("").replace("preset = \"none\"", "preset = \"balanced\"") + "[rates]\ngate = \"on\"\n";
    let run = Run::new(&application, &scenario).shading_rates(ShadingRateProfile::NvkTuring).on(&config);
    let outcome = run.timeout(Duration::from_secs(60)).finish().unwrap();
    assert!(!outcome.timed_out, "a thread waits for ever\n{}", outcome.log);
    assert_eq!(outcome.exit_code, Some(0), "{}\n{}", outcome.output, outcome.log);
    assert!(gaze_reads(&outcome) > 4, "{}", outcome.log);
}

#[test]
fn a_lock_around_submits_and_a_runtime_that_blocks_do_not_meet() {
    check("own_actions");
}

#[test]
fn a_runtime_that_blocks_one_thread_does_not_block_the_one_that_submits() {
    check("locates_views_on_another_thread");
}
