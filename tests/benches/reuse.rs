//! `cargo dev bench reuse [--size PIXELS] [--frames N] [--speeds A,B] [--moving]`: what re-use does to pictures while the head turns,
//! as the mean squared error, the mean of FLIP and the flicker outside of 10 degrees, in paper B's mode and turned with the head.
//! With `--moving` the scene moves too.

use glam::Vec3;
use parafovea_core::geometry::Fov;
use parafovea_errors::{Eye, Frame, Judge, Metric, Picture, Report, Viewing};
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Head, Scenario, ScenarioExt};
use std::error::Error;
use std::process::ExitCode;

/// Frames until passes are known and every swapchain image has had its turn.
const RUN_UP: u64 = 20;
const HZ: f64 = 90.0;
/// The rings outside of 10 degrees, as [`Report::row`] counts them.
const OUTSIDE: [usize; 3] = [3, 4, 5];
const MODES: [&str; 2] = ["paper", "on"];
const ARGUMENTS: &str = "--size, --frames, --speeds, --moving";

fn main() -> ExitCode {
    let done = Request::read(std::env::args().skip(1)).map_err(Into::into);
    match done.and_then(|request| request.measure()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

struct Request {
    size: u32,
    frames: u64,
    /// Degrees a second.
    speeds: Vec<f32>,
    is_moving: bool,
}

impl Request {
    fn read(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let speeds = vec![0.0, 30.0, 60.0, 100.0, 200.0];
        let mut request = Self { size: 512, frames: 30, speeds, is_moving: false };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().unwrap_or_default();
            let number = |value: String| {
                value.parse().map_err(|_| format!("{argument} needs a whole number, not `{value}`"))
            };
            match argument.as_str() {
                // `cargo bench` adds it.
                "--bench" => {}
                "--moving" => request.is_moving = true,
                "--size" => request.size = number(value())?,
                "--frames" => request.frames = number(value())?.into(),
                "--speeds" => {
                    let speeds: Result<_, _> = value().split(',').map(str::parse).collect();
                    request.speeds = speeds.map_err(|error| format!("--speeds: {error}"))?;
                }
                other => return Err(format!("unknown argument `{other}`; there are {ARGUMENTS}")),
            }
        }
        Ok(request)
    }

    fn measure(&self) -> Result<(), Box<dyn Error>> {
        println!("| degrees a second | mode | mean squared error | FLIP | flicker, 8 to 30 Hz |");
        println!("|---|---|---|---|---|");
        let arguments: &[&str] = if self.is_moving { &[] } else { &["--still"] };
        let application = Application::ours("parafovea-scene", arguments)?;
        for &speed in &self.speeds {
            let scenario = self.scenario(speed);
            let run = Run::new(&application, &scenario);
            let off = finish(run.clone(), &scenario)?;
            for mode in MODES {
                let on = finish(run.clone().on(&config(mode)), &scenario)?;
                let report = judge(&scenario, &off, &on)?;
                let outside = |metric: Metric, scale: f64, digits: usize| {
                    let mean = outside(&report, metric);
                    mean.map_or("too few frames".to_owned(), |mean| format!("{:.digits$}", mean * scale))
                };
                // Code values, as people know them.
                let squared = outside(Metric::Squared, 255.0 * 255.0, 1);
                let (flip, flicker) = (outside(Metric::Flip, 1.0, 4), outside(Metric::Flicker, 1.0, 4));
                println!("| {speed} | {mode} | {squared} | {flip} | {flicker} |");
            }
        }
        Ok(())
    }

    /// A head that turns to the left.
    fn scenario(&self, speed: f32) -> Scenario {
        let frames = RUN_UP + self.frames;
        let saved: Vec<u64> = (RUN_UP..frames).collect();
        let mut scenario = Scenario::new(frames).sized(self.size, self.size).saving(&saved);
        scenario.clock.refresh_hz = HZ;
        let head = |t: f64| Head {
            t,
            position: [0.0; 3],
            yaw_deg: speed * (t - RUN_UP as f64 / HZ) as f32,
            pitch_deg: 0.0,
            roll_deg: 0.0,
        };
        scenario.head = vec![head(0.0), head(frames as f64 / HZ)];
        scenario
    }
}

fn config(mode: &str) -> String {
    format!(
        "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nbackend = \"mask\"\ngate = \"on\"\n[reuse]\nmode = \"{mode}\"\n"
    )
}

fn finish(run: Run, scenario: &Scenario) -> Result<Outcome, Box<dyn Error>> {
    Ok(run.finish()?.expect_frames(scenario.session.frames)?)
}

fn judge(scenario: &Scenario, off: &Outcome, on: &Outcome) -> Result<Report, Box<dyn Error>> {
    let mut judge = Judge::new(Viewing { refresh_hz: HZ as f32, ..Viewing::default() })?;
    for &frame in &scenario.output.save_frames {
        let frame = |outcome: &Outcome| -> Result<Frame, Box<dyn Error>> {
            let eye = |view: usize| -> Result<Option<Eye>, Box<dyn Error>> {
                let degrees = scenario.views[view].fov_deg;
                let edges = [degrees.left, degrees.right, degrees.up, degrees.down];
                let [left, right, up, down] = edges.map(f32::to_radians);
                let shown = outcome.submitted(view, frame)?;
                let picture = Picture::from_srgb8(shown.width, shown.height, &shown.pixels);
                let fov = Fov { left, right, up, down };
                Ok(picture.map(|picture| Eye { picture, fov, gaze: Vec3::NEG_Z, age: None }))
            };
            Ok(Frame { time_s: frame as f64 / HZ, eyes: [eye(0)?, eye(1)?] })
        };
        judge.push(&frame(off)?, &frame(on)?)?;
    }
    Ok(judge.finish())
}

/// The mean over all pixels outside of 10 degrees; none of flicker in a short run.
fn outside(report: &Report, metric: Metric) -> Option<f64> {
    let rows = OUTSIDE.map(|ring| report.row(metric, ring));
    let pixels: u64 = rows.iter().map(|row| row.pixels).sum();
    let sum: f64 = rows.iter().filter_map(|row| Some(row.mean? * row.pixels as f64)).sum();
    (pixels > 0).then(|| sum / pixels as f64)
}
