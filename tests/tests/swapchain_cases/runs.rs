//! One run of one case.

use super::Case;
use parafovea_tests::picture::Picture;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{FovDegrees, Scenario, ScenarioExt};
use parafovea_zoo::cases::report::Report;
use std::collections::BTreeMap;
use std::time::Duration;

/// More frames than any case runs: the application ends its sessions itself.
const FRAMES: u64 = 1000;

/// Frames whose sub-images are saved: all that a case submits, and of the long one its beginning and its end.
const SAVED: u64 = 140;

/// A run that has ended.
pub struct Finished {
    pub outcome: Outcome,
    pub report: Report,
    pub scenario: Scenario,
    /// The sub-images as the runtime got them, by frame of the record, layer and view.
    pub pictures: BTreeMap<(u64, u32, u32), Picture>,
}

/// Runs a case, under validation if it may be: straight on the runtime, or with the layer and this configuration.
pub fn run(case: &Case, config: Option<&str>) -> Finished {
    let mut arguments = vec![case.name];
    arguments.extend(case.arguments);
    let application = Application::ours("parafovea-cases", &arguments).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenario(case, folder.path().to_str().unwrap());
    let mut run = Run::new(&application, &scenario).timeout(Duration::from_secs(60));
    if case.validated {
        run = run.validated();
    }
    if !case.openxr_validation {
        run = run.env("XR_ENABLE_API_LAYERS", "");
    }
    if let Some(config) = config {
        run = run.on(config);
        if config == super::ANALYZED {
            run = run.faulted(None);
        }
    }
    let outcome = run.finish().unwrap();
    let report = outcome.output.lines().find_map(|line| serde_json::from_str(line).ok());
    let report: Report = report.unwrap_or_else(|| panic!("no report:\n{}\n{}", outcome.output, outcome.log));
    let pictures = load(folder.path(), &outcome);
    Finished { outcome, report, scenario, pictures }
}

/// Eyes as a headset has them: each sees further outwards, and the gaze rests aside.
fn scenario(case: &Case, folder: &str) -> Scenario {
    let mut scenario = Scenario::new(FRAMES).sized(96, 80).gazing(12.0, -5.0);
    scenario.views[0].fov_deg = FovDegrees { left: -52.0, right: 40.0, up: 42.0, down: -47.0 };
    scenario.views[1].fov_deg = FovDegrees { left: -40.0, right: 52.0, up: 42.0, down: -47.0 };
    let saved: Vec<u64> = (0..SAVED).collect();
    scenario = scenario.saving(&saved);
    scenario.output.dir = folder.into();
    (case.scenario)(&mut scenario);
    scenario
}

fn load(folder: &std::path::Path, outcome: &Outcome) -> BTreeMap<(u64, u32, u32), Picture> {
    let mut pictures = BTreeMap::new();
    for frame in outcome.record.frames.iter().filter(|frame| frame.index < SAVED) {
        for (layer, content) in (0..).zip(&frame.layers) {
            for view in 0..views(content) {
                let path = folder.join(format!("submitted_{layer}_{view}_{}.png", frame.index));
                pictures.insert((frame.index, layer, view), Picture::load(&path).unwrap());
            }
        }
    }
    pictures
}

/// Sub-images of a recorded layer.
fn views(layer: &serde_json::Value) -> u32 {
    layer["views"].as_array().map_or(1, |views| views.len() as u32)
}
