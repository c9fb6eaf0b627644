//! Decisions of the benefit gate on a style of the zoo whose frames have planted costs: the layer as it is, on the mock runtime with time that
//! passes frame by frame, above a test layer that answers timestamp queries.

use crate::HarnessError;
use crate::run::{Application, Run};
use crate::scenario::{Scenario, ScenarioExt};
use parafovea_test_layers::PlantedCosts;

/// Frames a second of the runtime.
pub const HZ: u64 = 90;

/// Seconds of a run.
pub const SECONDS: u64 = 30;

/// GPU time of a frame without the technique, nanoseconds.
const BASE_NS: f64 = 5e6;

/// Standard deviation of the cost of a frame, as a share of it.
const NOISE: f64 = 0.1;

/// The eyes rest, so that each switch is seen, and nothing but rates can change a frame's cost.
const CONFIG: &str = "[gaze]\nsource = \"centre\"\n[rates]\nmode = \"fixed\"\ngate = \"auto\"\n[chroma]\nmode = \"off\"\n\
    [reuse]\nmode = \"off\"\n";

/// One run.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// Whether the gate keeps rates at the end.
    pub is_kept: bool,
    /// Whether that is so for a gain, and not so for none and for a slowdown.
    pub is_right: bool,
    /// Time of the last switch, seconds; 0: there was none.
    pub last_switch_s: f64,
    /// Switches of rates after they were on first.
    pub switches: usize,
    /// Share of the frames without rates, after they were on first.
    pub off: f64,
    /// Lines of the log with the gate's decisions.
    pub verdicts: Vec<String>,
}

/// Runs 30 s of frames of the style `render-pass` whose rates save the share `gain` of their cost.
///
/// # Errors
/// Errors of the harness; frames without rates, or without answers to queries.
pub fn decide(gain: f64, seed: u64) -> Result<Decision, HarnessError> {
    let frames = SECONDS * HZ;
    let count = frames.to_string();
    let arguments = ["--style", "render-pass", "--size", "64", "--frames", &count];
    let application = Application::ours("parafovea-zoo", &arguments)?;
    let mut scenario = Scenario::new(frames).sized(64, 64);
    scenario.clock.refresh_hz = HZ as f64;
    let planted = PlantedCosts { base_ns: BASE_NS, gain, noise: NOISE, seed };
    let outcome = Run::new(&application, &scenario).on(CONFIG).planted(&planted).finish()?;
    let outcome = outcome.expect_frames(frames)?;
    let costs = outcome.costs()?;
    let Some((first, switches)) = costs.changes.split_first() else {
        return Err(outcome.failed("rates were never on"));
    };
    if costs.answers == 0 {
        return Err(outcome.failed("no query was asked for"));
    }
    let line =
        |line: &&str| line.contains("shading rates: dropped") || line.contains("shading rates: resumed");
    let verdicts: Vec<String> = outcome.log.lines().filter(line).map(str::to_owned).collect();
    let is_kept = verdicts.last().is_none_or(|last| last.contains("resumed"));
    let ends = costs.changes.iter().skip(1).copied().chain([costs.frames]);
    // Rates are on from each change of an even number on.
    let on: u64 = costs.changes.iter().zip(ends).step_by(2).map(|(from, to)| to - from).sum();
    let after = costs.frames - first;
    Ok(Decision {
        is_kept,
        is_right: is_kept == (gain > 0.0),
        last_switch_s: switches.last().map_or(0.0, |frame| *frame as f64 / HZ as f64),
        switches: switches.len(),
        off: 1.0 - on as f64 / after.max(1) as f64,
        verdicts,
    })
}
