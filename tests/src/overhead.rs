//! `cargo dev bench overhead`: the CPU time that the layer adds to an application that it does nothing for.
//!
//! Four cases, by turns, so that other work of the machine affects all of them alike, and of each the least disturbed turn:
//! nothing of ours; an empty Vulkan layer that passes every call on, the cost of any layer; Parafovea configured to be
//! inert; Parafovea on: for a frame with every technique off, for recording with shading rates, so that its Vulkan half is
//! armed, and active in an OpenXR application.

mod planning;

pub use planning::{Added, planning};

use crate::HarnessError;
use crate::break_even::WITH_RATES;
use crate::measure::Samples;
use crate::record::median;
use crate::run::{Application, LayerMode, Run};
use crate::scenario::{Scenario, ScenarioExt};
use parafovea_test_layers::TestLayer;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::Duration;

/// Layers between the application and the driver.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Case {
    None,
    PassThrough,
    Inert,
    On,
}

impl Case {
    const ALL: [Case; 4] = [Case::None, Case::PassThrough, Case::Inert, Case::On];

    fn name(self) -> &'static str {
        match self {
            Case::None => "none",
            Case::PassThrough => "pass_through",
            Case::Inert => "inert",
            Case::On => "on",
        }
    }

    /// Prepares a run; `on` is the configuration of [`Case::On`].
    fn set_up(self, run: Run, on: &str) -> Run {
        match self {
            Case::None => run,
            Case::PassThrough => run.test_layer(TestLayer::PassThrough),
            Case::Inert => run.layer(LayerMode::On("enabled = false\n".to_owned())),
            Case::On => run.layer(LayerMode::On(on.to_owned())),
        }
    }
}

/// Amount of measurement.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Number of turns of each case.
    pub turns: usize,
    /// Frames of hello_xr in each turn.
    pub frames: u64,
    /// Number of times that the draws are recorded and submitted in each turn.
    pub rounds: u32,
}

impl Effort {
    /// For figures.
    pub const FULL: Self = Self { turns: 15, frames: 200, rounds: 10 };
    /// For figures of planning.
    pub const PLANNING: Self = Self { turns: 9, frames: 200, rounds: 1 };
    /// To see that it works.
    pub const LEAST: Self = Self { turns: 1, frames: 20, rounds: 1 };
}

/// One line of results.
#[derive(Clone, Debug, Serialize)]
pub struct Figure {
    /// `overhead`.
    pub bench: &'static str,
    /// The application, or how it records.
    pub app: String,
    /// `none`, `pass_through`, `inert` or `on`.
    pub case: &'static str,
    /// The measurements.
    pub metric: &'static str,
    /// The median of the turn where it was lowest.
    pub value: f64,
    /// The unit of `value` and `baseline`.
    pub unit: &'static str,
    /// `value` of the case `none`, from the same run.
    pub baseline: f64,
    /// `value / baseline`.
    pub ratio: f64,
    /// Half of the range in which the middle half of the turns' own ratios lies.
    pub spread: f64,
}

/// The layer is armed, and every technique is off.
const ARMED: &str = "preset = \"none\"\n[rates]\nmode = \"fixed\"\ngate = \"off\"\n";

/// CPU time of the whole process for one frame of hello_xr.
///
/// # Errors
/// Errors of the harness, and an application that does not finish.
pub fn hello_xr(effort: Effort) -> Result<Vec<Figure>, HarnessError> {
    let application = Application::hello_xr("Vulkan2")?;
    // Small pictures: the layer adds the same time, and less of the driver's own work hides it.
    let scenario = Scenario::new(effort.frames).sized(64, 64);
    let [frame] = by_turns(effort, |case| {
        let outcome = case.set_up(Run::new(&application, &scenario), ARMED).finish()?;
        let outcome = outcome.expect_frames(effort.frames)?;
        Ok([outcome.record.cpu_ms_of_frames(effort.frames / 10)])
    })?;
    Ok(figures(application.name(), "cpu_per_frame", "ms", &frame))
}

/// Draw calls in a command buffer of [`recording`], and the render passes that they are in.
const DRAWS: u32 = 10_000;
const PASSES: u32 = 50;

/// Recording styles of [`recording`]: the name in the results, and the arguments.
const OPENXR: &str = "--openxr";
const STYLES: [(&str, &[&str]); 4] = [
    ("render-pass", &["--style", "render-pass"]),
    ("dynamic-rendering", &["--style", "dynamic-rendering"]),
    ("render-pass-openxr", &["--style", "render-pass", OPENXR]),
    ("dynamic-rendering-openxr", &["--style", "dynamic-rendering", OPENXR]),
];

/// CPU time of the recording thread for a command buffer of 10,000 draw calls in 50 render passes and for its submit, with
/// render pass objects and with dynamic rendering: in a program that uses Vulkan alone, where the layer is armed when it is
/// on, and in an OpenXR application, where it is active.
///
/// # Errors
/// Errors of the harness, and a program that prints something else than its figures.
pub fn recording(effort: Effort) -> Result<Vec<Figure>, HarnessError> {
    let mut all = Vec::new();
    for (style, arguments) in STYLES {
        let rounds = effort.rounds.to_string();
        let (draws, passes) = (DRAWS.to_string(), PASSES.to_string());
        let amounts = ["record", "--draws", &draws, "--passes", &passes, "--rounds", &rounds];
        let application = Application::ours("parafovea-overhead", &[&amounts, arguments].concat())?;
        // The program ends by itself.
        let scenario = Scenario::new(100_000).sized(64, 64);
        let [record, submit] = by_turns(effort, |case| {
            let outcome = case.set_up(Run::new(&application, &scenario), WITH_RATES).finish()?;
            let times = outcome.output.lines().find_map(|line| serde_json::from_str::<DrawTimes>(line).ok());
            let times = times.ok_or_else(|| outcome.failed("it printed no figures"))?;
            Ok([vec![times.record_ns_per_draw * f64::from(DRAWS) / 1e6], vec![times.submit_ns / 1e6]])
        })?;
        all.extend(figures(style, "record_10000_draws", "ms", &record));
        all.extend(figures(style, "submit", "ms", &submit));
    }
    Ok(all)
}

/// Instructions of the recording thread for the same command buffer in OpenXR applications, by Valgrind's callgrind: other work of the
/// machine does not change them, so one turn is enough.
///
/// # Errors
/// Errors of the harness, where Valgrind is not installed, and where it prints no number.
pub fn recording_instructions() -> Result<Vec<Figure>, HarnessError> {
    let mut all = Vec::new();
    for (style, arguments) in STYLES.into_iter().filter(|(_, arguments)| arguments.contains(&OPENXR)) {
        let mut turns = Turns::default();
        for (case, turn) in Case::ALL.into_iter().zip(&mut turns) {
            turn.push(counted_instructions(case, arguments)? / 1e6);
        }
        all.extend(figures(style, "record_10000_draws", "million instructions", &turns));
    }
    Ok(all)
}

/// Rounds of which instructions are counted.
const COUNTED_ROUNDS: usize = 5;

/// The function that records.
const RECORDING_FUNCTION: &str = "parafovea_overhead::scene::Scene::record";

/// Median of the instructions of a round.
fn counted_instructions(case: Case, style: &[&str]) -> Result<f64, HarnessError> {
    let folder = tempfile::tempdir().map_err(HarnessError::file(&std::env::temp_dir()))?;
    // A file each time the function returns.
    let counts = folder.path().join("counts");
    let file = format!("--callgrind-out-file={}", counts.display());
    let [toggle, dump] =
        ["toggle-collect", "dump-after"].map(|what| format!("--{what}={RECORDING_FUNCTION}"));
    let valgrind = ["--tool=callgrind", &file, &toggle, &dump];

    let (rounds, draws, passes) = (COUNTED_ROUNDS.to_string(), DRAWS.to_string(), PASSES.to_string());
    let amounts = ["record", "--draws", &draws, "--passes", &passes, "--rounds", &rounds];
    let application = Application::ours("parafovea-overhead", &[&amounts, style].concat())?;
    let application = application.under("valgrind", &valgrind)?;
    // The program ends by itself.
    let scenario = Scenario::new(100_000).sized(64, 64);
    let run = Run::new(&application, &scenario).timeout(COUNTED_TIMEOUT);
    let outcome = case.set_up(run, WITH_RATES).finish()?.expect_end()?;
    let numbered = |number: usize| counts.with_extension(number.to_string());
    let files: Vec<PathBuf> = (1..).map(numbered).take_while(|file| file.exists()).collect();
    let counted = |file: &PathBuf| -> Option<f64> {
        let text = std::fs::read_to_string(file).ok()?;
        text.lines().find_map(|line| line.strip_prefix("summary: ")?.parse().ok())
    };
    let counts = files.iter().rev().take(COUNTED_ROUNDS).filter_map(counted).collect();
    median(counts).filter(|&count| count > 0.0).ok_or_else(|| outcome.failed("Valgrind counted nothing"))
}

/// Under Valgrind everything takes some fifty times as long.
const COUNTED_TIMEOUT: Duration = Duration::from_secs(300);

/// Output of `parafovea-overhead`, as far as it is used here.
#[derive(Deserialize)]
struct DrawTimes {
    record_ns_per_draw: f64,
    submit_ns: f64,
}

/// Medians of the turns, by case.
type Turns = [Vec<f64>; Case::ALL.len()];

/// Measures all cases by turns. A turn gives samples of each metric, of which the median counts.
fn by_turns<const METRICS: usize>(
    effort: Effort,
    mut turn: impl FnMut(Case) -> Result<[Vec<f64>; METRICS], HarnessError>,
) -> Result<[Turns; METRICS], HarnessError> {
    let mut medians = std::array::from_fn(|_| Turns::default());
    for _ in 0..effort.turns {
        for (index, case) in Case::ALL.into_iter().enumerate() {
            for (medians, samples) in medians.iter_mut().zip(turn(case)?) {
                medians[index].push(median(samples).unwrap_or(f64::NAN));
            }
        }
    }
    Ok(medians)
}

fn figures(app: &str, metric: &'static str, unit: &'static str, turns: &Turns) -> Vec<Figure> {
    let lowest = |turns: &[f64]| turns.iter().copied().fold(f64::INFINITY, f64::min);
    let samples = |turns: &[f64]| {
        let mut samples = Samples::default();
        turns.iter().for_each(|&median| samples.push(vec![median]));
        samples
    };
    let baseline = lowest(&turns[0]);
    let figure = |(case, own): (Case, &Vec<f64>)| Figure {
        bench: "overhead",
        app: app.to_owned(),
        case: case.name(),
        metric,
        value: lowest(own),
        unit,
        baseline,
        ratio: lowest(own) / baseline,
        spread: samples(own).ratio_to(&samples(&turns[0])).spread,
    };
    Case::ALL.into_iter().zip(turns).map(figure).collect()
}
