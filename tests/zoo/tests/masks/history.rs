//! A history that was blended while the eyes looked elsewhere: how soon it is, where they look now, as without the layer.

use super::Effort;
use crate::trial::skip_unless_run;
use libtest_mimic::Failed;
use parafovea_tests::detail::View;
use parafovea_tests::run::{Application, LayerMode, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

/// The eyes land in this frame, long after rates are coarse.
const STEP: u64 = 84;

/// Frames after the step.
const AFTER: u64 = 15;

/// Gaze directions before and after the step: degrees to the left and upwards.
const GAZES: [[f32; 2]; 2] = [[-18.0, 3.0], [18.0, -3.0]];

/// Duration of the eye movement, frames: 0.1 s.
const FLIGHT: f64 = 9.0;

/// The new place, degrees around the gaze.
const PLACE_DEG: f32 = 10.0;

/// Most that the place may differ after that time, as the root of the mean squared difference in code values.
const CLOSE: f64 = 2.0;

/// Least that it differs in the frame of the step: else nothing was coarse there.
const DIFFERENT: f64 = 4.0;

pub fn check() -> Result<(), Failed> {
    let effort = Effort { frames: STEP + AFTER + 1, size: 192 };
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("gaze.txt");
    let [rest, new] = GAZES;
    let scenario = Scenario::new(effort.frames).sized(effort.size, effort.size);
    let scenario = scenario.saving(&[STEP, STEP + AFTER]);
    let at = |frame: f64| frame / scenario.clock.refresh_hz;
    let line = |frame: f64, [left, up]: [f32; 2]| format!("{},{left},{up}\n", at(frame));
    let step = STEP as f64;
    std::fs::write(&file, line(0.0, rest) + &line(step - FLIGHT, rest) + &line(step - 0.5, new))?;
    let config = format!(
        "[gaze]\nsource = \"file\"\nfile = {file:?}\n[rates]\ngate = \"on\"\n[chroma]\nmode = \"off\"\n"
    );
    let run = |mode: LayerMode| -> Result<_, Failed> {
        let (size, frames) = (effort.size.to_string(), effort.frames.to_string());
        let arguments = ["--style", "taa", "--size", &size, "--frames", &frames];
        let application = Application::ours("parafovea-zoo", &arguments)?;
        let outcome = Run::new(&application, &scenario).layer(mode).finish()?;
        skip_unless_run(&outcome);
        Ok(outcome.expect_frames(effort.frames)?)
    };
    let (off, on) = (run(LayerMode::Off)?, run(LayerMode::On(config))?);
    for eye in 0..2 {
        let by = |frame: u64| -> Result<f64, Failed> {
            let compared = View::compare(&off.submitted(eye, frame)?, &on.submitted(eye, frame)?, new)?;
            Ok(compared.within(PLACE_DEG).root_mean_square())
        };
        let (first, last) = (by(STEP)?, by(STEP + AFTER)?);
        println!(
            "eye {eye}: {first:.2} code values in the frame of the step, {last:.2} {AFTER} frames later"
        );
        assert!(first > DIFFERENT, "eye {eye}: {first}\n{}", on.log);
        assert!(last < CLOSE, "eye {eye}: {last}, {first} in the frame of the step");
    }
    Ok(())
}
