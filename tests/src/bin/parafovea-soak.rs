//! `cargo dev soak [--minutes N]`: an application that starts and ends sessions over and over, of changing sizes, with a gaze that
//! comes and goes, a runtime that fails the layer now and then, and a configuration that is edited; beside it the same without the
//! layer. Fails if the layer's process takes more and more memory, threads or file descriptors.

use parafovea_tests::HarnessError;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Answer, Fault, Gaze, Scenario, ScenarioExt};
use parafovea_zoo::cases::life::Life;
use std::process::ExitCode;
use std::time::{Duration, Instant};

const MINUTES: u64 = 30;

/// Allowed growth, after warm-up, of the memory of the process with the layer beyond that without it, bytes.
const MOST_GROWTH: i64 = 1 << 20;

/// Interval between edits of the configuration.
const EDITS: Duration = Duration::from_secs(3);

/// Edits of the configuration, in turn; the third is a mistake.
const CONFIGS: [&str; 5] = [
    "[gaze]\nattach_alone_after_s = 1\n[rates]\ngate = \"on\"\n[reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\n",
    "[gaze]\nattach_alone_after_s = 1\n[rates]\nmode = \"audio-visual\"\ngate = \"on\"\n[audio]\nsource = \"file\"\nfile = \"/nonexistent.wav\"\n",
    "[rates]\nmode = 7\n",
    "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[chroma]\nmode = \"default\"\n",
    "enabled = false\n",
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let minutes = match &arguments[..] {
        [] => Some(MINUTES),
        [option, minutes] if option == "--minutes" => minutes.parse().ok(),
        _ => None,
    };
    let Some(minutes) = minutes.filter(|&minutes| minutes > 0) else {
        eprintln!("usage: cargo dev soak [--minutes N]");
        return ExitCode::from(2);
    };
    match soak(Duration::from_secs(60 * minutes)) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// A gaze that is lost for a while now and then, and calls of the layer's own that fail.
fn scenario() -> Scenario {
    let mut scenario = Scenario::new(0).sized(96, 112);
    scenario.output.record = false;
    let gaze = |step: u32| Gaze {
        t: f64::from(step),
        yaw_deg: f32::from((step % 7) as u8) * 8.0 - 24.0,
        pitch_deg: f32::from((step % 5) as u8) * 6.0 - 12.0,
        tracked: step % 4 != 3,
    };
    scenario.gaze = (0..20_000).map(gaze).collect();
    let fault = |number: u64| Fault {
        call: ["xrLocateSpace", "xrLocateViews"][number as usize % 2].to_owned(),
        result: if number.is_multiple_of(4) { "XR_ERROR_RUNTIME_FAILURE".to_owned() } else { String::new() },
        answer: Answer::Untracked,
        late_ms: 0,
        from_frame: 500 * number,
        skip: 0,
        count: 20,
    };
    scenario.fault = (1..400).map(fault).collect();
    scenario
}

fn soak(time: Duration) -> Result<bool, HarnessError> {
    let seconds = time.as_secs().to_string();
    let application = Application::ours("parafovea-cases", &["--soak", &seconds])?;
    let run = Run::new(&application, &scenario()).timeout(time + Duration::from_secs(120));
    let off = run.clone().start()?;
    let on = run.on(CONFIGS[0]).with_audio_library()?.start()?;
    let start = Instant::now();
    for config in CONFIGS.iter().cycle().skip(1) {
        if start.elapsed() >= time {
            break;
        }
        std::thread::sleep(EDITS);
        let file = on.config_file();
        std::fs::write(&file, config).map_err(|source| HarnessError::File { path: file, source })?;
    }
    let (off, on) = (off.finish()?.expect_end()?, on.finish()?.expect_end()?);
    let [off, on] = [("without the layer", &off), ("with the layer", &on)]
        .map(|(name, outcome)| Trend::of(name, outcome));
    let (Some(off), Some(on)) = (off, on) else { return Ok(false) };
    Ok(on.is_flat(&off))
}

/// Growth of a process's resources, from a fifth of its time to the end.
struct Trend {
    growth: i64,
    first: Life,
    last: Life,
}

impl Trend {
    /// Prints it, too.
    fn of(name: &str, outcome: &Outcome) -> Option<Self> {
        let lives = outcome.output.lines().filter_map(|line| serde_json::from_str::<Life>(line).ok());
        let lives: Vec<Life> = lives.collect();
        let part = lives.len() / 5;
        if part == 0 {
            eprintln!("{name}: too short, only {} runs of the application", lives.len());
            return None;
        }
        let [first, last] = [&lives[part..2 * part], &lives[lives.len() - part..]].map(typical);
        let growth = last.resident as i64 - first.resident as i64;
        println!(
            "{name}: {} runs of the application, then {} to {} kB resident ({:+} kB), {} to {} threads, {} to {} descriptors",
            lives.len(),
            first.resident / 1024,
            last.resident / 1024,
            growth / 1024,
            first.threads,
            last.threads,
            first.descriptors,
            last.descriptors,
        );
        Some(Self { growth, first, last })
    }

    /// Whether it holds no more in the end than before, next to a process without the layer.
    fn is_flat(&self, off: &Self) -> bool {
        let more = self.growth - off.growth;
        println!("with the layer {:+} kB more than without", more / 1024);
        more < MOST_GROWTH
            && self.last.threads <= self.first.threads
            && self.last.descriptors <= self.first.descriptors
    }
}

/// The median of each.
fn typical(lives: &[Life]) -> Life {
    let median = |value: fn(&Life) -> u64| {
        let mut values: Vec<u64> = lives.iter().map(value).collect();
        values.sort_unstable();
        values[values.len() / 2]
    };
    Life {
        seconds: 0.0,
        resident: median(|life| life.resident),
        threads: median(|life| life.threads),
        descriptors: median(|life| life.descriptors),
    }
}
