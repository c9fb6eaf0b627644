//! A bug of ours that panics in any hook turns Parafovea's techniques off, and has no other effect.

use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::collections::BTreeSet;

/// Everything that hooks have to do, on a device without shading rates.
const EVERYTHING: &str =
    "preset = \"balanced\"\n[rates]\ngate = \"on\"\n[reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\n";

const FRAMES: u64 = 20;

/// Runs an application in which hooks panic.
fn run(application: &Application, injected: &str) -> Outcome {
    let scenario = Scenario::new(FRAMES).sized(64, 64).gazing(-20.0, 0.0);
    let run = Run::new(application, &scenario).on(EVERYTHING).env("PARAFOVEA_PANIC", injected);
    let outcome = run.finish().unwrap_or_else(|error| panic!("{injected}: {error}"));
    outcome.expect_frames(FRAMES).unwrap_or_else(|error| panic!("{injected}: {error}"))
}

/// The hooks that an application reaches.
fn reached(application: &Application) -> BTreeSet<String> {
    let outcome = run(application, "reached");
    let lines = outcome.log.lines().filter_map(|line| line.split_once("reached "));
    lines.map(|(_, call)| call.to_owned()).collect()
}

/// Place of the panic in a hook.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PanicPoint {
    BeforeCallDown,
    AfterCallDown,
}

fn hello_xr_survives_a_panic_in_each_hook(point: PanicPoint) {
    let application = Application::hello_xr("Vulkan2").unwrap();
    let hooks = reached(&application);
    assert!(hooks.len() >= 40, "only {hooks:?}");
    for call in hooks {
        let (injected, expected) = match point {
            PanicPoint::BeforeCallDown => (call, 1..=1),
            // Not every hook has something to record.
            PanicPoint::AfterCallDown => (format!("{call}:after"), 0..=1),
        };
        let outcome = run(&application, &injected);
        let told = outcome.log.lines().filter(|line| line.contains("internal error in")).count();
        assert!(expected.contains(&told), "{injected}: told {told} times\n{}", outcome.log);
    }
}

#[test]
fn hello_xr_survives_a_panic_before_each_call_down() {
    hello_xr_survives_a_panic_in_each_hook(PanicPoint::BeforeCallDown);
}

#[test]
fn hello_xr_survives_a_panic_after_each_call_down() {
    hello_xr_survives_a_panic_in_each_hook(PanicPoint::AfterCallDown);
}
