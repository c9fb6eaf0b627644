//! Configuration files that are wrong, and files that change while the application runs.

use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{ClockMode, Scenario, ScenarioExt};
use std::time::{Duration, Instant};

const FRAMES: u64 = 10;

/// Runs hello_xr with a configuration file; it must finish. Returns the log's lines that name the file.
fn lines_about(config: &str) -> Vec<String> {
    let application = Application::hello_xr("Vulkan2").unwrap();
    let run = Run::new(&application, &Scenario::new(FRAMES).sized(64, 64)).on(config);
    let outcome = run.finish().unwrap().expect_frames(FRAMES).unwrap();
    outcome.log.lines().filter(|line| line.contains("config.toml")).map(str::to_owned).collect()
}

/// Exactly one line complains, and it has all of `parts`.
fn assert_one_complaint(config: &str, parts: &[&str]) {
    let lines = lines_about(config);
    let complaints: Vec<_> =
        lines.iter().filter(|line| line.contains("ERROR") || line.contains("WARN")).collect();
    assert_eq!(complaints.len(), 1, "{lines:#?}");
    for part in parts {
        assert!(complaints[0].contains(part), "{part} is not in: {}", complaints[0]);
    }
}

#[test]
fn a_right_file_causes_no_complaint() {
    let lines = lines_about("[chroma]\nmode = \"default\"\n");
    assert!(!lines.iter().any(|line| line.contains("ERROR") || line.contains("WARN")), "{lines:#?}");
}

#[test]
fn a_wrong_key_is_named() {
    assert_one_complaint("[chroma]\nplato_deg = 5\n", &["config.toml", "plato_deg", "plateau_deg"]);
}

#[test]
fn a_wrong_type_is_named() {
    assert_one_complaint(
        "[chroma]\nplateau_deg = \"wide\"\n",
        &["config.toml", "chroma.plateau_deg", "wide"],
    );
}

#[test]
fn a_value_out_of_range_is_named_with_the_range() {
    assert_one_complaint(
        "[chroma]\nplateau_deg = 300\n",
        &["config.toml", "chroma.plateau_deg", "300", "1.1", "30"],
    );
}

#[test]
fn invalid_toml_is_named_with_its_line() {
    assert_one_complaint("[chroma]\nmode = \n", &["config.toml", "2"]);
}

#[test]
fn ten_megabytes_are_refused() {
    assert_one_complaint(&"# nothing\n".repeat(1 << 20), &["config.toml"]);
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let application = Application::hello_xr("Vulkan2").unwrap();
    let folder = tempfile::tempdir().unwrap();
    // A folder cannot be read as a file, not even by root.
    let run = Run::new(&application, &Scenario::new(FRAMES).sized(64, 64)).on("");
    let outcome = run.env("PARAFOVEA_CONFIG", folder.path()).finish().unwrap().expect_frames(FRAMES).unwrap();
    let name = folder.path().to_str().unwrap();
    let complaints: Vec<_> = outcome.log.lines().filter(|line| line.contains(name)).collect();
    assert_eq!(complaints.len(), 1, "{}", outcome.log);
}

#[test]
fn an_edit_applies_within_a_second() {
    const CHROMA: &str = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[chroma]\nmode = \"default\"\n";
    /// The edit is made once this frame is submitted ...
    const BEFORE: u64 = 60;
    /// ... and holds a second of frames later, with half a second for a busy machine to make it.
    const AFTER: u64 = BEFORE + 90 + 45;
    let application = Application::hello_xr("Vulkan2").unwrap();
    let mut scenario = Scenario::new(AFTER + 5).sized(96, 96).in_real_time().saving(&[BEFORE, AFTER]);
    let running = Run::new(&application, &scenario).on(CHROMA).start().unwrap();
    wait_until(|| running.has_submitted(1, BEFORE));
    std::fs::write(running.config_file(), "preset = \"none\"\n").unwrap();
    let edited = running.finish().unwrap().expect_frames(AFTER + 5).unwrap();

    scenario.clock.mode = ClockMode::Simulated;
    let reference = Run::new(&application, &scenario).finish().unwrap();
    let picture = |outcome: &Outcome, frame| outcome.submitted(0, frame).unwrap();
    assert_ne!(picture(&reference, BEFORE), picture(&edited, BEFORE), "before the edit\n{}", edited.log);
    assert_eq!(picture(&reference, AFTER), picture(&edited, AFTER), "after the edit\n{}", edited.log);
}

#[test]
fn an_edit_that_needs_new_swapchains_or_a_restart_is_logged() {
    const BEFORE: &str = "preset = \"none\"\n[rates]\nmode = \"fixed\"\ngate = \"on\"\n[gaze]\nsource = ";
    let application = Application::hello_xr("Vulkan2").unwrap();
    let scenario = Scenario::new(150).sized(96, 96).in_real_time().saving(&[30]);
    for (edited, reason) in [
        ("\"centre\"\n[chroma]\nmode = \"default\"\n", "takes effect in swapchains that the"),
        ("\"eyes\"\n", "follows the runtime's eye tracker, which takes effect"),
    ] {
        let run = Run::new(&application, &scenario).on(&format!("{BEFORE}\"centre\"\n"));
        let running = run.start().unwrap();
        wait_until(|| running.has_submitted(1, 30));
        std::fs::write(running.config_file(), format!("{BEFORE}{edited}")).unwrap();
        let outcome = running.finish().unwrap().expect_frames(150).unwrap();
        assert_eq!(outcome.log.matches(reason).count(), 1, "{reason}: {}", outcome.log);
    }
}

pub fn wait_until(mut condition: impl FnMut() -> bool) {
    let start = Instant::now();
    while !condition() {
        assert!(start.elapsed() < Duration::from_secs(60), "waited in vain");
        std::thread::sleep(Duration::from_millis(10));
    }
}
