//! Eye gaze never costs an application its input: with any use of actions and any runtime, it sees and gets the same with the layer as
//! without, in the same order.
//!
//! Each case runs twice, without the layer and with it. The layer follows the gaze in cases where a gaze is available.

#![allow(clippy::unwrap_used, reason = "clippy.toml allows it in test functions; these are their helpers")]

mod blocking;
mod cases;
mod files;
mod late;
mod programs;
mod traced;

pub use cases::TESTED;

use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use serde_json::Value;
use std::time::Duration;

/// Names of the action sets of the layer begin so.
const OURS: &str = "parafovea_gaze";

/// The layer follows the eyes: there is colour to remove where they do not look.
fn following(lines: &str) -> String {
    format!(
        "preset = \"none\"\n[gaze]\nsource = \"eyes\"\n{lines}\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n"
    )
}

/// A headset whose left select button is pressed for some frames, with the record of all input.
fn scenario(frames: u64) -> Scenario {
    let mut scenario = Scenario::new(frames).sized(64, 64).gazing(12.0, -5.0);
    scenario.output.input = true;
    let path = "/user/hand/left/input/select/click".to_owned();
    let press = |t, down| parafovea_tests::scenario::Input {
        t,
        path: path.clone(),
        value: parafovea_tests::scenario::InputValue::Boolean(down),
    };
    // In the first frames, and in those after a loading screen.
    scenario.input = vec![press(0.02, true), press(0.06, false), press(1.5, true), press(1.53, false)];
    scenario
}

fn run(application: &Application, scenario: &Scenario, config: Option<&str>) -> Outcome {
    let run = Run::new(application, scenario).timeout(Duration::from_secs(60));
    let run = match config {
        Some(config) => run.on(config),
        None => run,
    };
    run.finish().unwrap()
}

/// Requests and answers of the runtime about input, without the layer's own part in them.
fn input_at_the_runtime(outcome: &Outcome) -> Vec<Value> {
    outcome.record.input.iter().filter_map(without_ours).collect()
}

/// A line without the layer's action sets. None if only they are active, or none: the application sees no such line.
fn without_ours(line: &Value) -> Option<Value> {
    let mut line = line.clone();
    let is_ours = |name: &Value| name.as_str().is_some_and(|name| name.starts_with(OURS));
    if let Some(sets) = line.get_mut("sets").and_then(Value::as_array_mut) {
        sets.retain(|set| !is_ours(set));
        if sets.is_empty() {
            return None;
        }
    }
    if let Some(states) = line.get_mut("states").and_then(Value::as_array_mut) {
        states.retain(|state| !is_ours(&state["action"]));
    }
    if let Some(members) = line.as_object_mut() {
        members.remove("session");
    }
    Some(line)
}

/// Number of times that the gaze was located and available.
fn gaze_reads(outcome: &Outcome) -> u64 {
    outcome.record.frames.iter().map(|frame| u64::from(frame.gaze_reads)).sum()
}

/// Mistakes that the runtime saw with the layer, and not without. One of the application's in attaching it sees twice: the layer
/// tries with its action set first, and then as the application made the call.
fn new_errors(reference: &Outcome, outcome: &Outcome) -> Vec<String> {
    let errors = |outcome: &Outcome| -> Vec<String> {
        outcome.record.errors.iter().map(|error| format!("{} {}", error.call, error.result)).collect()
    };
    let mut known = errors(reference);
    let attaching: Vec<String> =
        known.iter().filter(|error| error.starts_with("xrAttachSessionActionSets")).cloned().collect();
    known.extend(attaching);
    let mut new = errors(outcome);
    new.retain(|error| match known.iter().position(|other| other == error) {
        Some(at) => {
            known.swap_remove(at);
            false
        }
        None => true,
    });
    new
}

/// In every attachment of the layer's it comes first: one runtime keeps only the last.
fn assert_ours_is_first(outcome: &Outcome) {
    for line in outcome.record.input.iter().filter(|line| line["kind"] == "actions_attached") {
        let sets = line["sets"].as_array().unwrap();
        let ours = sets.iter().position(|set| set.as_str().unwrap().starts_with(OURS));
        assert!(ours.is_none_or(|at| at == 0), "{line}");
    }
}
