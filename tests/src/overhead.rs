//! `cargo dev bench overhead`: the CPU time that the layer adds to an application that it does nothing for.
//!
//! Four cases, by turns, so that what else the machine does falls on all of them alike: nothing of ours; an empty
//! Vulkan layer that passes every call on, which is what any layer costs; Parafovea told to be inert; Parafovea on,
//! with every technique off.

use crate::HarnessError;
use crate::record::median;
use crate::run::{Application, LayerMode, Run};
use crate::scenario::{Scenario, ScenarioExt};
use parafovea_test_layers::TestLayer;
use serde::Serialize;

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
            Case::On => run.layer(LayerMode::On("[chroma]\nmode = \"off\"\n".to_owned())),
        }
    }
}

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// How often all cases have their turn.
    pub rounds: usize,
    /// Frames of hello_xr in each turn.
    pub frames: u64,
}

impl Effort {
    /// For figures.
    pub const FULL: Self = Self { rounds: 5, frames: 300 };
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
    /// The median.
    pub value: f64,
    /// The unit of `value` and `baseline`.
    pub unit: &'static str,
    /// The median of the case `none`, from the same turns.
    pub baseline: f64,
    /// `value / baseline`.
    pub ratio: f64,
}

/// CPU time of one frame of hello_xr.
///
/// # Errors
/// Those of the harness, and an application that does not come to its end.
pub fn hello_xr(effort: Effort) -> Result<Vec<Figure>, HarnessError> {
    let application = Application::hello_xr("Vulkan2")?;
    // Small pictures: what the layer adds is the same, and less of the driver's own work hides it.
    let scenario = Scenario::new(effort.frames).sized(64, 64);
    by_turns(effort, |case| {
        let outcome =
            case.set_up(Run::new(&application, &scenario)).finish()?.expect_frames(effort.frames)?;
        Ok(outcome.record.cpu_ms_of_frames())
    })
    .map(|medians| figures("hello_xr", "cpu_per_frame", "ms", medians))
}

fn by_turns(
    effort: Effort,
    mut turn: impl FnMut(Case) -> Result<Vec<f64>, HarnessError>,
) -> Result<[f64; 4], HarnessError> {
    let mut values: [Vec<f64>; 4] = Default::default();
    for _ in 0..effort.rounds {
        for (case, values) in Case::ALL.into_iter().zip(&mut values) {
            values.extend(turn(case)?);
        }
    }
    Ok(values.map(|values| median(values).unwrap_or(f64::NAN)))
}

fn figures(app: &str, metric: &'static str, unit: &'static str, medians: [f64; 4]) -> Vec<Figure> {
    let baseline = medians[0];
    let figure = |(case, value): (Case, f64)| Figure {
        bench: "overhead",
        app: app.to_owned(),
        case: case.name(),
        metric,
        value,
        unit,
        baseline,
        ratio: value / baseline,
    };
    Case::ALL.into_iter().zip(medians).map(figure).collect()
}
