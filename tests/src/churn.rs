//! Churn: an application that starts and ends sessions on one device, and makes and destroys swapchains, targets, render passes and framebuffers
//! of changing sizes, with every technique on. The layer's objects and memory at rest, when no object of the application is left, must not grow, nor
//! may its peak memory in a session.

use crate::HarnessError;
use crate::run::{Application, Outcome, Run};
use crate::scenario::{Gaze, Head, Scenario, ScenarioExt};
use parafovea_test_layers::{LiveObjects, ShadingRateProfile};
use std::fmt::Write;
use std::time::Duration;

/// Rates by contrast, re-use and chroma attenuation, never dropped.
const CONFIG: &str = "preset = \"balanced\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n\
    [reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n";

/// Parts of a run; the first is the run-up, in which kernels are compiled and pools filled.
const WINDOWS: usize = 5;

/// Fewest sessions in a part, for a median.
const FEWEST: usize = 3;

/// Allowed growth of the layer's device memory at rest, bytes: one allocation that rate images share.
const MOST_AT_REST: u64 = 1 << 20;

/// Allowed growth of the layer's objects at rest: one kernel's objects, which a format may need late.
const MOST_OBJECTS: u64 = 8;

/// Allowed ratio of the most device memory in a session, last part to second: sizes are random, and these are medians.
const MOST_RATIO: f64 = 1.25;

/// Allowed growth of the process's memory beyond that of the process without the layer, bytes: as in `cargo dev soak`.
const MOST_RESIDENT: i64 = 4 << 20;

/// Backend that the device offers to a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// The device unchanged: masks.
    Mask,
    /// The device with shading rates of a stand-in.
    Attachment,
}

impl Backend {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Backend::Mask => "mask",
            Backend::Attachment => "rate attachment",
        }
    }
}

/// Runs with and without the layer at the same time, for `time`; with all styles of the churn, or with one.
///
/// # Errors
/// Errors of the harness, and an application that fails.
pub fn churn(
    backend: Backend,
    time: Duration,
    seed: u64,
    style: Option<&str>,
) -> Result<Churn, HarnessError> {
    let (seconds, seed) = (time.as_secs().to_string(), seed.to_string());
    let mut arguments = vec!["--churn", &seconds, "--seed", &seed];
    arguments.extend(style.into_iter().flat_map(|style| ["--style", style]));
    let application = Application::ours("parafovea-zoo", &arguments)?;
    let run = Run::new(&application, &scenario()).timeout(2 * time + Duration::from_secs(120));
    let run = match backend {
        Backend::Mask => run,
        Backend::Attachment => run.shading_rates(ShadingRateProfile::NvkTuring),
    };
    let run = run.live_counted();
    let off = run.clone().start()?;
    let on = run.on(CONFIG).start()?;
    let (off, on) = (off.finish()?.expect_end()?, on.finish()?.expect_end()?);
    Ok(Churn { backend, off: at_rest(&off)?, on: at_rest(&on)?, log: on.log })
}

/// A head that turns and a gaze that jumps.
fn scenario() -> Scenario {
    let mut scenario = Scenario::new(0).sized(128, 128);
    scenario.output.record = false;
    let head = |step: u32| Head {
        t: f64::from(step),
        position: [0.0; 3],
        yaw_deg: f32::from((step % 9) as u8) * 8.0 - 32.0,
        pitch_deg: 0.0,
        roll_deg: 0.0,
    };
    let gaze = |step: u32| Gaze {
        t: f64::from(step) * 0.5,
        yaw_deg: f32::from((step % 7) as u8) * 8.0 - 24.0,
        pitch_deg: f32::from((step % 5) as u8) * 6.0 - 12.0,
        tracked: step % 16 != 3,
    };
    scenario.head = (0..20_000).map(head).collect();
    scenario.gaze = (0..40_000).map(gaze).collect();
    scenario
}

/// The lines of a run at which the application had nothing but its device. The most memory of each is that since the last.
fn at_rest(outcome: &Outcome) -> Result<Vec<LiveObjects>, HarnessError> {
    let mut most = 0;
    let mut rests = Vec::new();
    for mut line in outcome.live_objects()? {
        most = line.own.most_memory.max(most);
        if line.application.objects.get("image").is_none_or(|&count| count == 0) {
            line.own.most_memory = std::mem::take(&mut most);
            rests.push(line);
        }
    }
    Ok(rests)
}

/// Counts of two runs at rest, after each session.
pub struct Churn {
    /// Backend of both runs.
    pub backend: Backend,
    /// Without the layer.
    pub off: Vec<LiveObjects>,
    /// With it.
    pub on: Vec<LiveObjects>,
    /// Its log.
    pub log: String,
}

/// Medians of a part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Window {
    sessions: usize,
    seconds: u64,
    memory: u64,
    most_memory: u64,
    objects: u64,
    resident: u64,
    threads: u64,
    descriptors: u64,
}

fn windows(rests: &[LiveObjects]) -> Vec<Window> {
    let part = rests.len() / WINDOWS;
    if part < FEWEST {
        return Vec::new();
    }
    rests.chunks(part).take(WINDOWS).map(Window::of).collect()
}

impl Window {
    fn of(rests: &[LiveObjects]) -> Self {
        let median = |value: &dyn Fn(&LiveObjects) -> u64| {
            let mut values: Vec<u64> = rests.iter().map(value).collect();
            values.sort_unstable();
            values[values.len() / 2]
        };
        Self {
            sessions: rests.len(),
            seconds: rests.last().map_or(0, |last| last.seconds as u64),
            memory: median(&|live| live.own.memory),
            most_memory: median(&|live| live.own.most_memory),
            objects: median(&|live| live.own.count()),
            resident: median(&|live| live.resident),
            threads: median(&|live| live.threads),
            descriptors: median(&|live| live.descriptors),
        }
    }
}

impl Churn {
    /// A table of both runs: medians of parts.
    pub fn table(&self) -> String {
        let mut table = format!(
            "{}\n| run | until s | sessions | memory at rest, KiB | most in a session, KiB | objects at rest | process, MiB | threads | descriptors |\n\
             |---|---|---|---|---|---|---|---|---|\n",
            self.backend.name(),
        );
        for (name, rests) in [("with the layer", &self.on), ("without", &self.off)] {
            for window in windows(rests) {
                let Window {
                    sessions,
                    seconds,
                    memory,
                    most_memory,
                    objects,
                    resident,
                    threads,
                    descriptors,
                } = window;
                let (memory, most_memory) = (memory / 1024, most_memory / 1024);
                let resident = resident as f64 / f64::from(1 << 20);
                // Writing to a string cannot fail.
                let _ = writeln!(
                    table,
                    "| {name} | {seconds} | {sessions} | {memory} | {most_memory} | {objects} | {resident:.1} | {threads} | {descriptors} |",
                );
            }
        }
        let holdings = |name: &str, rest: Option<&LiveObjects>| {
            let objects = rest.map(|rest| &rest.own.objects).into_iter().flatten();
            let kinds: Vec<String> = objects
                .filter(|(_, count)| **count > 0)
                .map(|(kind, count)| format!("{kind} {count}"))
                .collect();
            format!("\nObjects of the layer at rest, {name}: {}", kinds.join(", "))
        };
        table += &holdings("after the first part", self.on.get(self.on.len() / WINDOWS));
        table += &holdings("at the end", self.on.last());
        table + "\n"
    }

    /// Quantities that grew beyond their bounds from the second part to the last; empty if none did.
    pub fn growth(&self) -> Vec<String> {
        let (on, off) = (windows(&self.on), windows(&self.off));
        let ([_, first, .., last], [_, off_first, .., off_last]) = (&on[..], &off[..]) else {
            return vec![format!("too short: {} and {} sessions", self.on.len(), self.off.len())];
        };
        let mut grown = Vec::new();
        let mut check = |is_flat: bool, what: &str, from: u64, to: u64| {
            if !is_flat {
                grown.push(format!("{what} grew from {from} to {to}"));
            }
        };
        let is_memory_flat = last.memory <= first.memory + MOST_AT_REST;
        check(is_memory_flat, "device memory at rest, bytes,", first.memory, last.memory);
        let is_most_flat = last.most_memory as f64 <= first.most_memory as f64 * MOST_RATIO;
        check(
            is_most_flat,
            "the most device memory in a session, bytes,",
            first.most_memory,
            last.most_memory,
        );
        check(last.objects <= first.objects + MOST_OBJECTS, "objects at rest", first.objects, last.objects);
        check(last.threads <= first.threads, "threads", first.threads, last.threads);
        check(last.descriptors <= first.descriptors, "descriptors", first.descriptors, last.descriptors);
        let growth = |first: &Window, last: &Window| last.resident as i64 - first.resident as i64;
        let is_resident_flat = growth(first, last) <= growth(off_first, off_last).max(0) + MOST_RESIDENT;
        check(is_resident_flat, "memory of the process, bytes,", first.resident, last.resident);
        grown
    }
}
