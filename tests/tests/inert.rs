//! A configuration that asks for nothing leaves an application's Vulkan calls as they are.

use parafovea_test_layers::{FaultReport, ShadingRateProfile};
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

const FRAMES: u64 = 12;

fn applications() -> [Application; 3] {
    let frames = FRAMES.to_string();
    let style = ["--style", "dynamic-rendering", "--size", "64", "--frames", &frames];
    [
        Application::hello_xr("Vulkan2").unwrap(),
        Application::ours("parafovea-scene", &[]).unwrap(),
        Application::ours("parafovea-zoo", &style).unwrap(),
    ]
}

/// The application over a device with shading rates, with the calls counted that come down to it.
fn run(application: &Application, config: Option<&str>) -> Outcome {
    let run = Run::new(application, &Scenario::new(FRAMES).sized(64, 64))
        .shading_rates(ShadingRateProfile::NvkTuring)
        .faulted(None);
    let run = match config {
        Some(config) => run.on(config),
        None => run,
    };
    run.finish().unwrap().expect_frames(FRAMES).unwrap()
}

/// Calls of the application by name, less those whose count depends on the device's speed: wgpu, which our scene draws
/// with, makes a command pool for an encoder unless an earlier submission has ended by then and left its own.
fn steady_calls(report: &FaultReport) -> BTreeMap<&str, u64> {
    let by_speed = ["vkCreateCommandPool", "vkAllocateCommandBuffers", "vkResetCommandPool"];
    let calls = report.application.iter().map(|(name, count)| (name.as_str(), *count));
    calls.filter(|(name, _)| !by_speed.contains(name)).collect()
}

#[test]
fn a_configuration_without_work_is_a_pass_through_layer() {
    for application in applications() {
        let name = application.name().to_owned();
        let without = run(&application, None).faults().unwrap();
        for config in ["preset = \"none\"\n", "enabled = false\n", "[rates]\nbackend = \"off\"\n"] {
            let outcome = run(&application, Some(config));
            let line = "Vulkan device: inert: the configuration enables nothing";
            assert!(outcome.log.contains(line), "{name}, {config}:\n{}", outcome.log);
            let with = outcome.faults().unwrap();
            for (with, without) in with.iter().zip(&without) {
                assert!(with.own.is_empty(), "{name}, {config}: calls of our own: {:?}", with.own);
                assert_eq!(steady_calls(with), steady_calls(without), "{name}, {config}");
            }
            assert_eq!(with.len(), without.len(), "{name}, {config}");
        }
        let armed = run(&application, Some("[gaze]\nsource = \"centre\"\n")).faults().unwrap();
        assert!(armed.iter().any(|report| !report.own.is_empty()), "{name}: the layer does nothing at all");
    }
}

/// A device is armed when it is created or not at all, so a later edit that needs an armed device asks for a restart.
#[test]
fn an_edit_that_needs_another_device_asks_for_a_restart() {
    let application = Application::hello_xr("Vulkan2").unwrap();
    let scenario = Scenario::new(400).sized(64, 64).in_real_time();
    let run = || Run::new(&application, &scenario).on("preset = \"none\"\n");
    // The half that sees the edit may be another copy of the library than the one that armed the device.
    for run in [run(), run().from_copies()] {
        let running = run.start().unwrap();
        let wait_for = |line: &str| {
            let start = Instant::now();
            while !running.log().contains(line) {
                assert!(start.elapsed() < Duration::from_secs(60), "{line} in\n{}", running.log());
                std::thread::sleep(Duration::from_millis(10));
            }
        };
        wait_for("session inert");
        std::fs::write(running.config_file(), "preset = \"balanced\"\n").unwrap();
        wait_for("enables shading rates, which takes effect after a restart of the application");
    }
}
