//! `cargo dev bench overhead --driver NAME`: the CPU time that the layer adds to the application's thread on a real driver over a
//! no-op kernel shim, which renders nothing: only planning and recording are left.
//!
//! The headset is that of the design's budget: 2 x 2160 x 2160 pixels at 90 Hz. The head turns and moves all the time, and the eyes make
//! three saccades a second. The application works for [`WORK_US`] between locating its views and drawing them, as the thread of a game does
//! that is busy enough for our time to matter. The layer's kernels are compiled on a thread within the run-up.
//!
//! Frames follow each other at two [`Pace`]s, because the time of the same instructions differs by up to five times between warm and cold
//! caches.

use super::Effort;
use crate::HarnessError;
use crate::record::median;
use crate::run::{Application, Run};
use crate::scenario::{ClockMode, Head, Scenario, ScenarioExt};
use serde::Serialize;

/// Width and height of an eye buffer, pixels.
const SIDE: u32 = 2160;

/// The application's own work of a frame before it draws, microseconds: a tenth of a frame.
const WORK_US: u64 = 1000;

/// Time between the begins of two frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pace {
    /// A frame begins when the last one has ended: the application works without a pause, and the code of a frame stays in the caches. This
    /// repeats best from one hour of a shared machine to another.
    BackToBack,
    /// A frame begins when the headset is due: the application sleeps for most of the frame, and the caches are cold after it. The time
    /// depends on the machine's other work.
    Headset,
}

impl Pace {
    const ALL: [Self; 2] = [Self::BackToBack, Self::Headset];

    fn name(self) -> &'static str {
        match self {
            Self::BackToBack => "back to back",
            Self::Headset => "90 Hz",
        }
    }

    fn clock(self) -> ClockMode {
        match self {
            Self::BackToBack => ClockMode::Simulated,
            Self::Headset => ClockMode::Real,
        }
    }

    /// Frames that count for each of an effort: short ones are cheap, and a percentile needs many.
    fn repeats(self) -> u64 {
        match self {
            Self::BackToBack => 5,
            Self::Headset => 1,
        }
    }

    /// Frames before the first that counts, two seconds: kernels are compiled, maps made, passes recognised and rates coarsened by then.
    fn run_up(self) -> u64 {
        match self {
            Self::BackToBack => 2_000_000 / WORK_US,
            Self::Headset => 180,
        }
    }
}

/// Frames from one saccade to the next.
const PERIOD: usize = 30;

/// The case without work for the layer.
const INERT: &str = "inert";

/// Techniques, their configuration, and the budget of the design, milliseconds; none where the design has none.
const CASES: [(&str, &str, Option<f64>); 7] = [
    (INERT, "enabled = false\n", None),
    ("armed", "preset = \"none\"\n[rates]\nmode = \"fixed\"\ngate = \"off\"\n", None),
    ("rates", "preset = \"none\"\n[rates]\nmode = \"fixed\"\ngate = \"on\"\n", Some(0.10)),
    ("chroma", "preset = \"none\"\n[chroma]\nmode = \"default\"\n", Some(0.05)),
    (
        "audio-visual",
        "preset = \"none\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n",
        None,
    ),
    ("re-use", "preset = \"none\"\n[rates]\ngate = \"on\"\n[reuse]\nmode = \"on\"\n", None),
    (
        "everything",
        "preset = \"none\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n\
         [reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\n",
        Some(0.30),
    ),
];

/// One case: CPU time of the application's thread for a frame, beyond that without the layer.
#[derive(Clone, Debug, Serialize)]
pub struct Added {
    /// `overhead`.
    pub bench: &'static str,
    /// The driver's device.
    pub app: String,
    /// The techniques that are on.
    pub case: &'static str,
    /// `back to back`, without a pause between frames, or `90 Hz`, as a headset demands frames.
    pub pace: &'static str,
    /// `added_cpu_per_frame`.
    pub metric: &'static str,
    /// Median over all turns of the difference between the medians of a turn's frames, milliseconds: processes differ by more than frames of
    /// one process, in the places of their memory and on their cores.
    pub value: f64,
    /// `ms`.
    pub unit: &'static str,
    /// Median over all turns of the difference between the 99th percentiles of a turn's frames, milliseconds: as for `value`, turns that the
    /// machine's other work disturbs do not count.
    pub p99: f64,
    /// The 99th percentile of all frames with the layer less that of all frames without it, milliseconds: disturbances of the machine's worst
    /// frames are in both, and do not cancel out.
    pub p99_of_all: f64,
    /// The worst place between two saccades: the most of the differences between the medians over all frames at the same place, milliseconds.
    /// A peak of the layer returns with each saccade, a disturbance of the machine does not.
    pub worst_place: f64,
    /// Median of a frame without the layer, milliseconds.
    pub baseline: f64,
    /// `(baseline + value) / baseline`.
    pub ratio: f64,
    /// The most that the design allows for `value`, milliseconds.
    pub budget: Option<f64>,
}

/// The layer's added time of a frame, case by case, by turns, at each [`Pace`]; `prepare` chooses driver and library.
///
/// # Errors
/// Errors of the harness, and an application that does not finish.
pub fn planning(
    device: &str,
    wanted: &[String],
    effort: Effort,
    prepare: impl Fn(Run) -> Run,
) -> Result<Vec<Added>, HarnessError> {
    let mut added = Vec::new();
    for pace in Pace::ALL {
        added.extend(at_pace(pace, device, wanted, effort, &prepare)?);
    }
    Ok(added)
}

fn at_pace(
    pace: Pace,
    device: &str,
    wanted: &[String],
    effort: Effort,
    prepare: impl Fn(Run) -> Run,
) -> Result<Vec<Added>, HarnessError> {
    let run_up = pace.run_up();
    let frames = run_up + effort.frames * pace.repeats();
    let (size, count, work) = (SIDE.to_string(), frames.to_string(), WORK_US.to_string());
    let arguments = ["--style", "render-pass", "--size", &size, "--frames", &count, "--work", &work];
    let application = Application::ours("parafovea-zoo", &arguments)?;
    let scenario = moving(frames, pace.clock());
    let folder = tempfile::tempdir().map_err(HarnessError::file(&std::env::temp_dir()))?;
    let gaze_file = folder.path().join("gaze.txt");
    std::fs::write(&gaze_file, saccades(frames)).map_err(HarnessError::file(&gaze_file))?;
    let gaze = format!("[gaze]\nsource = \"file\"\nfile = {gaze_file:?}\n");
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|wanted| wanted == name);
    let cases: Vec<_> = CASES.into_iter().filter(|(name, ..)| is_wanted(name)).collect();
    let mut off = vec![Vec::new(); effort.turns];
    let mut on = vec![off.clone(); cases.len()];
    for turn in 0..effort.turns {
        // Another case after another one in each turn: the case before matters to the first frames of a run.
        for place in 0..=cases.len() {
            match (turn + place) % (cases.len() + 1) {
                0 => off[turn] = times(prepare(Run::new(&application, &scenario)), [run_up, frames], false)?,
                place => {
                    let (case, config, _) = cases[place - 1];
                    let run = prepare(Run::new(&application, &scenario)).on(&format!("{config}{gaze}"));
                    on[place - 1][turn] = times(run, [run_up, frames], case != INERT)?;
                }
            }
        }
    }
    let median = |times: &[f64]| median(times.to_vec()).unwrap_or(f64::NAN);
    let baseline = median(&off.concat());
    let worst_without = percentile_99(off.concat());
    let added = |(case, budget): (&'static str, Option<f64>), on: &[Vec<f64>]| {
        let by_turn = |of: &dyn Fn(&[f64]) -> f64| {
            let differences: Vec<f64> = on.iter().zip(&off).map(|(on, off)| of(on) - of(off)).collect();
            median(&differences)
        };
        let value = by_turn(&median);
        Added {
            bench: "overhead",
            app: device.to_owned(),
            case,
            pace: pace.name(),
            metric: "added_cpu_per_frame",
            value,
            unit: "ms",
            p99: by_turn(&|times| percentile_99(times.to_vec())),
            p99_of_all: percentile_99(on.concat()) - worst_without,
            worst_place: worst_place(on, &off),
            baseline,
            ratio: (baseline + value) / baseline,
            budget,
        }
    };
    Ok(cases.iter().zip(&on).map(|((case, _, budget), on)| added((*case, *budget), on)).collect())
}

/// Times of frames after the run-up, of so many in all; an error where the layer is not active and `is_active` wants it to be.
fn times(run: Run, [run_up, frames]: [u64; 2], is_active: bool) -> Result<Vec<f64>, HarnessError> {
    let outcome = run.finish()?.expect_frames(frames)?;
    if is_active && !outcome.log.contains("session active") {
        return Err(outcome.failed("the layer is not active, so its time cannot be measured"));
    }
    Ok(outcome.record.thread_cpu_ms_of_frames(run_up))
}

fn percentile_99(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let place = (values.len() * 99 / 100).min(values.len().saturating_sub(1));
    values.get(place).copied().unwrap_or(f64::NAN)
}

/// The most that frames at one place of [`PERIOD`] take longer in the turns `on` than in the turns `off`, by their medians; NaN without
/// frames.
fn worst_place(on: &[Vec<f64>], off: &[Vec<f64>]) -> f64 {
    let at = |turns: &[Vec<f64>], place: usize| {
        let frames = turns.iter().flat_map(|turn| turn.iter().skip(place).step_by(PERIOD)).copied();
        median(frames.collect()).unwrap_or(f64::NAN)
    };
    (0..PERIOD).map(|place| at(on, place) - at(off, place)).fold(f64::NAN, f64::max)
}

/// A head that turns all the time, for so many frames.
fn moving(frames: u64, clock: ClockMode) -> Scenario {
    let mut scenario = Scenario::new(frames).sized(SIDE, SIDE);
    scenario.clock.refresh_hz = 90.0;
    scenario.clock.mode = clock;
    let seconds = frames as f64 / scenario.clock.refresh_hz;
    let times =
        |step_s: f64| (0..).map(move |i| f64::from(i) * step_s).take_while(move |t| *t < seconds + 1.0);
    // Up to 40 degrees a second, as when someone looks around, on the spot: faster translation switches re-use off.
    scenario.head = times(0.1)
        .map(|t| Head {
            t,
            position: [0.002 * (1.7 * t as f32).sin(), 0.0, 0.002 * (2.3 * t as f32).cos()],
            yaw_deg: 25.0 * (1.5 * t as f32).sin(),
            pitch_deg: 8.0 * (1.1 * t as f32).cos(),
            roll_deg: 0.0,
        })
        .collect();
    scenario
}

/// A gaze file: fixations of 0.3 s, and saccades of 33 ms between them, in directions that the golden angle spreads. The eye tracker is
/// not asked before half a minute in an application without input.
fn saccades(frames: u64) -> String {
    let count = frames.div_ceil(PERIOD as u64) + 1;
    let fixation = |number: u64| {
        let (t, angle) = (number as f64 / 3.0, 2.4 * number as f32);
        let (left, up) = (12.0 * angle.cos(), 8.0 * angle.sin());
        format!("{t},{left},{up}\n{},{left},{up}\n", t + 0.3)
    };
    (0..count).map(fixation).collect()
}

#[cfg(test)]
mod tests {
    use super::{PERIOD, worst_place};

    #[test]
    fn a_peak_at_each_saccade_is_the_worst_place_and_a_disturbance_is_not() {
        let turn = |added: f64, peak: f64| -> Vec<f64> {
            (0..200).map(|frame| 1.0 + added + if frame % PERIOD == 3 { peak } else { 0.0 }).collect()
        };
        let off = vec![turn(0.0, 0.0); 3];
        let mut on = vec![turn(0.06, 0.08); 3];
        on[1][40] += 5.0;
        assert!((worst_place(&on, &off) - 0.14).abs() < 1e-9);
        assert!(worst_place(&[], &[]).is_nan());
    }
}
