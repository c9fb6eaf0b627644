//! `cargo dev bench overhead`: the CPU time that the layer adds to an application that it does nothing for.
//!
//! Four cases, by turns, so that what else the machine does falls on all of them alike, and of each the turn that it
//! disturbed least: nothing of ours; an empty Vulkan layer that passes every call on, which is what any layer costs;
//! Parafovea told to be inert; Parafovea on, with every technique off.

use crate::HarnessError;
use crate::record::median;
use crate::run::{Application, LayerMode, Run};
use crate::scenario::{Scenario, ScenarioExt};
use parafovea_test_layers::TestLayer;
use serde::{Deserialize, Serialize};

/// What stands between the application and the driver.
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

    fn set_up(self, run: Run) -> Run {
        match self {
            Case::None => run,
            Case::PassThrough => run.test_layer(TestLayer::PassThrough),
            Case::Inert => run.layer(LayerMode::On("enabled = false\n".to_owned())),
            Case::On => run.layer(LayerMode::On("preset = \"none\"\n".to_owned())),
        }
    }
}

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// How often all cases have their turn.
    pub turns: usize,
    /// Frames of hello_xr in each turn.
    pub frames: u64,
    /// How often the draws are recorded and submitted in each turn.
    pub rounds: u32,
}

impl Effort {
    /// For figures.
    pub const FULL: Self = Self { turns: 15, frames: 200, rounds: 10 };
    /// To see that it works.
    pub const LEAST: Self = Self { turns: 1, frames: 20, rounds: 1 };
}

/// One line of results.
#[derive(Clone, Debug, Serialize)]
pub struct Figure {
    /// `overhead`.
    pub bench: &'static str,
    /// The application.
    pub app: String,
    /// `none`, `pass_through`, `inert` or `on`.
    pub case: &'static str,
    /// What was measured.
    pub metric: &'static str,
    /// The median of the turn where it was lowest.
    pub value: f64,
    /// The unit of `value` and `baseline`.
    pub unit: &'static str,
    /// `value` of the case `none`, from the same run.
    pub baseline: f64,
    /// `value / baseline`.
    pub ratio: f64,
}

/// CPU time of the whole process for one frame of hello_xr.
///
/// # Errors
/// Those of the harness, and an application that does not come to its end.
pub fn hello_xr(effort: Effort) -> Result<Vec<Figure>, HarnessError> {
    let application = Application::hello_xr("Vulkan2")?;
    // Small pictures: what the layer adds is the same, and less of the driver's own work hides it.
    let scenario = Scenario::new(effort.frames).sized(64, 64);
    let [frame] = by_turns(effort, |case| {
        let outcome =
            case.set_up(Run::new(&application, &scenario)).finish()?.expect_frames(effort.frames)?;
        Ok([outcome.record.cpu_ms_of_frames()])
    })?;
    Ok(figures(&application, "cpu_per_frame", "ms", frame))
}

/// Draw calls in a command buffer of [`draws`].
const DRAWS: u32 = 10_000;

/// CPU time of the recording thread for a command buffer of 10,000 draw calls and for its submit, in a program that
/// uses Vulkan alone: on, the layer is armed.
///
/// # Errors
/// Those of the harness, and a program that prints something else than its figures.
pub fn draws(effort: Effort) -> Result<Vec<Figure>, HarnessError> {
    let arguments = ["--draws", &DRAWS.to_string(), "--rounds", &effort.rounds.to_string()];
    let application = Application::ours("parafovea-overhead", &arguments)?;
    let scenario = Scenario::new(1);
    let [record, submit] = by_turns(effort, |case| {
        let outcome = case.set_up(Run::new(&application, &scenario)).finish()?;
        let times = outcome.output.lines().find_map(|line| serde_json::from_str::<DrawTimes>(line).ok());
        let times = times.ok_or_else(|| outcome.failed("it printed no figures"))?;
        Ok([vec![times.record_ns_per_draw * f64::from(DRAWS) / 1e6], vec![times.submit_ns / 1e6]])
    })?;
    let mut all = figures(&application, "record_10000_draws", "ms", record);
    all.extend(figures(&application, "submit", "ms", submit));
    Ok(all)
}

/// What `parafovea-overhead` prints, as far as it is used here.
#[derive(Deserialize)]
struct DrawTimes {
    record_ns_per_draw: f64,
    submit_ns: f64,
}

/// Measures all cases by turns. A turn gives samples of each metric; of their medians the lowest come back, by metric
/// and case.
fn by_turns<const METRICS: usize>(
    effort: Effort,
    mut turn: impl FnMut(Case) -> Result<[Vec<f64>; METRICS], HarnessError>,
) -> Result<[[f64; Case::ALL.len()]; METRICS], HarnessError> {
    let mut lowest = [[f64::INFINITY; Case::ALL.len()]; METRICS];
    for _ in 0..effort.turns {
        for (index, case) in Case::ALL.into_iter().enumerate() {
            for (lowest, samples) in lowest.iter_mut().zip(turn(case)?) {
                lowest[index] = lowest[index].min(median(samples).unwrap_or(f64::INFINITY));
            }
        }
    }
    Ok(lowest)
}

fn figures(
    application: &Application,
    metric: &'static str,
    unit: &'static str,
    values: [f64; Case::ALL.len()],
) -> Vec<Figure> {
    let baseline = values[0];
    let figure = |(case, value): (Case, f64)| Figure {
        bench: "overhead",
        app: application.name().to_owned(),
        case: case.name(),
        metric,
        value,
        unit,
        baseline,
        ratio: value / baseline,
    };
    Case::ALL.into_iter().zip(values).map(figure).collect()
}
