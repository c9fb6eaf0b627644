//! `cargo dev bench reuse [--size PIXELS] [--frames N] [--speeds A,B | --moves A,B] [--scene NAME] [--moving | --paces A,B] [--gaze]`:
//! errors of re-use while the head turns, or moves to the right by so many metres a second, as the mean squared error and the mean of FLIP
//! outside of 10 degrees, and as flicker, 8 to 30 Hz, in each ring, in paper B's mode and turned with the head; and the energy of the
//! latter's flicker by the former's. With `--moves` the application submits depth, but for the mode "on, without depth", and rates are
//! attachments of the stand-in for devices that have them. With `--moving` the scene moves too, with `--paces` so many times as fast as it
//! is meant, and with `--gaze` the eyes do, three times a second.

use glam::{Quat, Vec3};
use parafovea_core::geometry::Fov;
use parafovea_models::errors::{Eye, Frame, Judge, Metric, Picture, RING_NAMES, Report, Viewing};
use parafovea_test_layers::ShadingRateProfile;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Gaze, Head, Scenario, ScenarioExt};
use std::error::Error;
use std::process::ExitCode;

/// Frames until passes are known, every swapchain image has had its turn, and so has the eye tracker.
const RUN_UP: u64 = 40;
const HZ: f64 = 90.0;
/// The rings outside of 10 degrees, as [`Report::row`] counts them.
const OUTSIDE: [usize; 3] = [3, 4, 5];
const ARGUMENTS: &str = "--size, --frames, --speeds, --moves, --scene, --moving, --paces, --gaze";
/// Frames from one saccade to the next.
const FIXATION: u64 = 30;

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
    /// Degrees a second, or metres a second where [`Self::has_moves`].
    speeds: Vec<f32>,
    /// Whether the head moves, and does not turn.
    has_moves: bool,
    scene: String,
    /// Speeds of the scene relative to its normal speed.
    paces: Vec<f64>,
    /// Whether the eyes move.
    has_gaze: bool,
}

impl Request {
    fn read(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let speeds = vec![0.0, 30.0, 60.0, 100.0, 200.0];
        let mut request = Self {
            size: 512,
            frames: 30,
            speeds,
            has_moves: false,
            scene: "courtyard".to_owned(),
            paces: vec![0.0],
            has_gaze: false,
        };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().unwrap_or_default();
            let number = |value: String| {
                value.parse().map_err(|_| format!("{argument} needs a whole number, not `{value}`"))
            };
            match argument.as_str() {
                // `cargo bench` adds it.
                "--bench" => {}
                "--moving" => request.paces = vec![1.0],
                "--gaze" => request.has_gaze = true,
                "--scene" => request.scene = value(),
                "--paces" => {
                    let paces: Result<_, _> = value().split(',').map(str::parse).collect();
                    request.paces = paces.map_err(|error| format!("--paces: {error}"))?;
                }
                "--size" => request.size = number(value())?,
                "--frames" => request.frames = number(value())?.into(),
                "--speeds" | "--moves" => {
                    request.has_moves = argument == "--moves";
                    let speeds: Result<_, _> = value().split(',').map(str::parse).collect();
                    request.speeds = speeds.map_err(|error| format!("{argument}: {error}"))?;
                }
                other => return Err(format!("unknown argument `{other}`; allowed: {ARGUMENTS}")),
            }
        }
        Ok(request)
    }

    fn measure(&self) -> Result<(), Box<dyn Error>> {
        let rings = OUTSIDE.map(|ring| format!("flicker at {} degrees |", RING_NAMES[ring])).join(" ");
        let unit = if self.has_moves { "metres" } else { "degrees" };
        println!("| {unit} a second | pace | mode | mean squared error | FLIP | {rings}");
        println!("|---|---|---|---|---|{}", "---|".repeat(OUTSIDE.len()));
        for (&speed, &pace) in
            self.speeds.iter().flat_map(|speed| self.paces.iter().map(move |pace| (speed, pace)))
        {
            let scenario = self.scenario(speed);
            let off = finish(self.run(pace, false, &scenario)?, &scenario)?;
            let mut energies = Vec::new();
            for (mode, has_depth) in self.modes() {
                let run = self.run(pace, *has_depth, &scenario)?;
                let run = if self.has_moves { run.shading_rates(ShadingRateProfile::NvkTuring) } else { run };
                let on = finish(run.on(&self.config(mode)), &scenario)?;
                let mode = if self.has_moves && !has_depth {
                    format!("{mode}, without depth")
                } else {
                    (*mode).to_owned()
                };
                let report = self.judge(&scenario, &off, &on)?;
                // Code values, as people know them.
                let squared = outside(&report, Metric::Squared).map(|mean| mean * 255.0 * 255.0);
                let flip = outside(&report, Metric::Flip);
                let flicker = OUTSIDE.map(|ring| report.row(Metric::Flicker, ring).mean);
                let cells = [(squared, 1), (flip, 4)].into_iter().chain(flicker.map(|mean| (mean, 4)));
                let cells: Vec<String> = cells.map(|(mean, digits)| cell(mean, digits)).collect();
                println!("| {speed} | {pace} | {mode} | {} |", cells.join(" | "));
                energies.push(flicker.map(|mean| mean.map(|mean| mean * mean)));
            }
            let [paper, .., ours] = &energies[..] else { continue };
            let ratios = paper.iter().zip(ours).map(|(paper, ours)| Some(ours.as_ref()? / paper.as_ref()?));
            let ratios: Vec<String> = ratios.map(|ratio| cell(ratio, 2)).collect();
            println!("| {speed} | {pace} | energy, on / paper | | | {} |", ratios.join(" | "));
        }
        Ok(())
    }

    /// One side of a comparison: the mode, and whether the application submits depth.
    fn modes(&self) -> &'static [(&'static str, bool)] {
        match self.has_moves {
            true => &[("paper", false), ("on", false), ("on", true)],
            false => &[("paper", false), ("on", false)],
        }
    }

    fn run(&self, pace: f64, has_depth: bool, scenario: &Scenario) -> Result<Run, Box<dyn Error>> {
        let pace = pace.to_string();
        let mut arguments = vec!["--scene", &self.scene, "--pace", &pace];
        arguments.extend(has_depth.then_some("--depth-layer"));
        Ok(Run::new(&Application::ours("parafovea-scene", &arguments)?, scenario))
    }

    /// A head that turns to the left, or moves to the right.
    fn scenario(&self, speed: f32) -> Scenario {
        let frames = RUN_UP + self.frames;
        let saved: Vec<u64> = (RUN_UP..frames).collect();
        let mut scenario = Scenario::new(frames).sized(self.size, self.size).saving(&saved);
        scenario.clock.refresh_hz = HZ;
        let head = |t: f64| {
            let way = speed * (t - RUN_UP as f64 / HZ) as f32;
            let (x, yaw_deg) = if self.has_moves { (way, 0.0) } else { (0.0, way) };
            Head { t, position: [x, 0.0, 0.0], yaw_deg, pitch_deg: 0.0, roll_deg: 0.0 }
        };
        scenario.head = vec![head(0.0), head(frames as f64 / HZ)];
        if self.has_gaze {
            scenario.gaze = (0..frames.div_ceil(FIXATION)).flat_map(fixation).collect();
        }
        scenario
    }

    fn config(&self, mode: &str) -> String {
        let source = if self.has_gaze { "eyes" } else { "centre" };
        let rates =
            if self.has_moves { "mode = \"off\"\nbackend = \"attachment\"" } else { "backend = \"mask\"" };
        format!(
            "preset = \"none\"\n[gaze]\nsource = \"{source}\"\n[rates]\n{rates}\ngate = \"on\"\n[reuse]\nmode = \"{mode}\"\n"
        )
    }

    fn judge(&self, scenario: &Scenario, off: &Outcome, on: &Outcome) -> Result<Report, Box<dyn Error>> {
        let mut judge = Judge::new(Viewing { refresh_hz: HZ as f32, ..Viewing::default() })?;
        for &frame in &scenario.output.save_frames {
            let shown = |outcome: &Outcome| -> Result<Frame, Box<dyn Error>> {
                let eye = |view: usize| -> Result<Option<Eye>, Box<dyn Error>> {
                    let degrees = scenario.views[view].fov_deg;
                    let edges = [degrees.left, degrees.right, degrees.up, degrees.down];
                    let [left, right, up, down] = edges.map(f32::to_radians);
                    let shown = outcome.submitted(view, frame)?;
                    let picture = Picture::from_srgb8(shown.width, shown.height, &shown.pixels);
                    let fov = Fov { left, right, up, down };
                    Ok(picture.map(|picture| Eye { picture, fov, gaze: self.gaze(frame), age: None }))
                };
                Ok(Frame { time_s: frame as f64 / HZ, eyes: [eye(0)?, eye(1)?] })
            };
            judge.push(&shown(off)?, &shown(on)?)?;
        }
        Ok(judge.finish())
    }

    /// Direction of the gaze in a frame, in the space of the views.
    fn gaze(&self, frame: u64) -> Vec3 {
        if !self.has_gaze {
            return Vec3::NEG_Z;
        }
        let Gaze { yaw_deg, pitch_deg, .. } = fixation(frame / FIXATION)[0];
        let turn =
            Quat::from_rotation_y(yaw_deg.to_radians()) * Quat::from_rotation_x(pitch_deg.to_radians());
        turn * Vec3::NEG_Z
    }
}

/// The beginning and the end of a fixation, of which there are three a second; a saccade takes a frame.
fn fixation(number: u64) -> [Gaze; 2] {
    const PLACES: [(f32, f32); 5] = [(-12.0, 4.0), (9.0, -8.0), (2.0, 11.0), (14.0, 0.0), (-6.0, -10.0)];
    let (yaw_deg, pitch_deg) = PLACES[(number % 5) as usize];
    let at = |frame: u64| Gaze { t: (frame as f64 - 0.5) / HZ, yaw_deg, pitch_deg, tracked: true };
    let first = number * FIXATION;
    [Gaze { t: (first as f64 - 0.5).max(0.0) / HZ, ..at(0) }, at(first + FIXATION - 1)]
}

fn finish(run: Run, scenario: &Scenario) -> Result<Outcome, Box<dyn Error>> {
    Ok(run.finish()?.expect_frames(scenario.session.frames)?)
}

fn cell(value: Option<f64>, digits: usize) -> String {
    match value {
        None => "too few frames".to_owned(),
        // Of nothing, by nothing.
        Some(value) if value.is_nan() => "-".to_owned(),
        Some(value) => format!("{value:.digits$}"),
    }
}

/// The mean over all pixels outside of 10 degrees; none of flicker in a short run.
fn outside(report: &Report, metric: Metric) -> Option<f64> {
    let rows = OUTSIDE.map(|ring| report.row(metric, ring));
    let pixels: u64 = rows.iter().map(|row| row.pixels).sum();
    let sum: f64 = rows.iter().filter_map(|row| Some(row.mean? * row.pixels as f64)).sum();
    (pixels > 0).then(|| sum / pixels as f64)
}
