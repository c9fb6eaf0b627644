//! A cell of the matrix, and how it is judged.

use super::technique::Technique;
use parafovea_test_layers::{VulkanFault, Whose};
use parafovea_tests::picture::Picture;
use parafovea_tests::run::{Outcome, complaints, is_of_late_hello_xr};
use parafovea_tests::scenario::{Fault, Scenario};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, LazyLock, Mutex};
use std::time::Duration;

/// Of every run; the last few are shown after the session was asked to end.
pub const FRAMES: u64 = 16;

/// Pictures that are compared: before techniques begin, amidst, and at the end.
pub const SAVED: [u64; 3] = [1, 8, 14];

/// Longer than any of these runs takes, and shorter than a hang.
const PATIENCE: Duration = Duration::from_secs(60);

/// The fault below the layer.
#[derive(Clone, Debug)]
pub enum Below {
    Vulkan(VulkanFault),
    OpenXr(Vec<Fault>),
    /// Extensions that the runtime lacks.
    ExtensionsOff(Vec<String>),
}

/// A fault while a technique works.
pub struct Cell {
    pub technique: &'static Technique,
    pub below: Below,
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.technique.name)?;
        match &self.below {
            Below::Vulkan(VulkanFault { call, result, whose, skip, count }) => {
                write!(f, "{call} {result} {whose:?} skip {skip} count {count}")
            }
            Below::OpenXr(faults) => {
                for Fault { call, result, answer, late_ms, from_frame, skip, count } in faults {
                    write!(
                        f,
                        "{call} {result} {answer:?} late {late_ms} from {from_frame} skip {skip} count {count}; "
                    )?;
                }
                Ok(())
            }
            Below::ExtensionsOff(names) => write!(f, "without {names:?}"),
        }
    }
}

/// Observations of an application, and its images.
#[derive(Debug)]
pub struct Seen {
    exit_code: Option<i32>,
    timed_out: bool,
    frames: usize,
    /// Its output, line by line, without parts that differ from run to run.
    output: Vec<String>,
    log: String,
    rules: Vec<String>,
    pictures: BTreeMap<(usize, u64), PictureOf>,
    /// Calls that the fault happened to.
    hits: u64,
}

/// A picture that prints as nothing.
pub struct PictureOf(Picture);

impl fmt::Debug for PictureOf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("picture")
    }
}

/// References: each is run once.
type References = BTreeMap<String, Arc<Mutex<Option<Arc<Seen>>>>>;
static REFERENCES: LazyLock<Mutex<References>> = LazyLock::new(Mutex::default);

fn reference(key: String, make: impl FnOnce() -> Seen) -> Arc<Seen> {
    let slot = REFERENCES.lock().unwrap().entry(key).or_default().clone();
    slot.lock().unwrap().get_or_insert_with(|| Arc::new(make())).clone()
}

impl Cell {
    /// The call that fails; of several, the first.
    pub fn call(&self) -> &str {
        match &self.below {
            Below::Vulkan(fault) => &fault.call,
            Below::OpenXr(faults) => faults.first().map_or("none", |fault| &fault.call),
            Below::ExtensionsOff(_) => "extensions of the runtime",
        }
    }

    fn scenario(&self) -> Scenario {
        let mut scenario = Technique::scenario();
        match &self.below {
            Below::Vulkan(_) => {}
            Below::OpenXr(faults) => scenario.fault.clone_from(faults),
            Below::ExtensionsOff(names) => scenario.system.extensions_off.clone_from(names),
        }
        scenario
    }

    /// Runs the application with or without the layer, and with or without the fault.
    fn see(&self, is_on: bool, is_faulty: bool) -> Seen {
        let scenario = if is_faulty { self.scenario() } else { Technique::scenario() };
        let fault = match &self.below {
            Below::Vulkan(fault) if is_faulty => Some(fault),
            _ => None,
        };
        let mut run = self.technique.run(&scenario).faulted(fault).timeout(PATIENCE);
        if is_on {
            run = run.on(self.technique.config);
        }
        if std::env::var_os("PARAFOVEA_FAULTS_VALIDATED").is_some() {
            run = run.validated();
        }
        Seen::of(&run.finish().unwrap())
    }

    /// Runs it, and returns its violations.
    pub fn check(&self) -> Result<(), String> {
        let technique = self.technique;
        let key = format!("{} {} {}", technique.has_actions, technique.has_rates, technique.has_two_queues);
        let healthy = reference(key.clone(), || self.see(false, false));
        let shown = reference(technique.name.to_owned(), || self.see(true, false));
        let below = match &self.below {
            // Without the layer there are no calls of its own that could fail.
            Below::Vulkan(fault) if fault.whose == Whose::Own => healthy.clone(),
            below => reference(format!("{key} {below:?}"), || self.see(false, true)),
        };
        let seen = self.see(true, true);
        let wrong = self.judge(&seen, &below, &healthy, &shown);
        let warnings = || seen.log.lines().filter(|line| !line.contains(" INFO "));
        wrong.map_err(|reason| warnings().fold(reason, |all, line| format!("{all}\n    {line}")))
    }

    fn judge(&self, seen: &Seen, below: &Seen, healthy: &Seen, shown: &Seen) -> Result<(), String> {
        let fail = |what: &str, seen: &dyn fmt::Debug, wanted: &dyn fmt::Debug| {
            Err(format!("{what}: {seen:?} instead of {wanted:?}"))
        };
        if seen.timed_out {
            return Err("it hangs".to_owned());
        }
        if seen.hits == 0 && self.must_happen() {
            return Err("the fault never happens".to_owned());
        }
        // An error of a virtual swapchain comes later, or, where one frame can do without, not at all.
        let may_do_without = self.technique.is_virtual && self.is_of_swapchain();
        let is_as_healthy = seen.exit_code == Some(0) && seen.frames == healthy.frames;
        if !(may_do_without && is_as_healthy) {
            if seen.exit_code != below.exit_code {
                let last = |seen: &Seen| (seen.exit_code, seen.output.last().cloned());
                return fail("exit code", &last(seen), &last(below));
            }
            if seen.frames != below.frames {
                return fail("frames", &seen.frames, &below.frames);
            }
            if seen.output != below.output && !may_do_without {
                let not_in = |one: &Seen, other: &Seen| -> Vec<String> {
                    one.output.iter().filter(|line| !other.output.contains(line)).cloned().collect()
                };
                return fail("output", &not_in(seen, below), &not_in(below, seen));
            }
        }
        let new: Vec<_> = seen
            .rules
            .iter()
            .filter(|rule| !below.rules.contains(rule) && !shown.rules.contains(rule))
            .collect();
        if !new.is_empty() {
            return fail("findings", &new, &"none");
        }
        told_once(&seen.log)?;
        // The application goes on, and no picture can be shown.
        if self.is_refused_all_work() {
            return Ok(());
        }
        for (at, picture) in &seen.pictures {
            if let Some(reference) = below.pictures.get(at) {
                let as_shown = shown.pictures.get(at).unwrap_or(reference);
                is_right(&picture.0, &reference.0, &as_shown.0)
                    .map_err(|reason| format!("{at:?}: {reason}"))?;
            }
        }
        Ok(())
    }

    /// Whether the fault is sure to happen: the number of some calls depends on the speed of the device.
    fn must_happen(&self) -> bool {
        match &self.below {
            Below::Vulkan(fault) => fault.skip == 0,
            Below::OpenXr(_) => true,
            Below::ExtensionsOff(_) => false,
        }
    }

    /// Whether none of the layer's command buffers ever reaches the device, so that draws to a virtual swapchain cannot be shown.
    fn is_refused_all_work(&self) -> bool {
        let Below::Vulkan(fault) = &self.below else { return false };
        let needed = ["vkBeginCommandBuffer", "vkEndCommandBuffer", "vkQueueSubmit"];
        self.technique.is_virtual
            && (fault.whose, fault.count) == (Whose::Own, u64::MAX)
            && needed.contains(&fault.call.as_str())
    }

    fn is_of_swapchain(&self) -> bool {
        let Below::OpenXr(faults) = &self.below else { return false };
        faults.iter().any(|fault| fault.call.ends_with("SwapchainImage"))
    }
}

/// A cause is logged once, with any consequences.
fn told_once(log: &str) -> Result<(), String> {
    let told = complaints(log).len();
    if told > 1 {
        return Err(format!("told {told} times"));
    }
    Ok(())
}

/// An image is right if it equals the one without the layer, or its error is no larger than the technique's own.
fn is_right(picture: &Picture, off: &Picture, on: &Picture) -> Result<(), String> {
    let error = |picture: &Picture| {
        let squares = picture.pixels.iter().zip(&off.pixels).flat_map(|(one, other)| {
            (0..4).map(|channel| f64::from(one[channel].abs_diff(other[channel])).powi(2))
        });
        squares.sum::<f64>() / picture.pixels.len() as f64
    };
    let (has, may) = (error(picture), error(on));
    if picture.pixels.len() != off.pixels.len() || has > may + 0.01 {
        return Err(format!("the picture has a squared error of {has}, and {may} without the fault"));
    }
    Ok(())
}

impl Seen {
    pub fn of(outcome: &Outcome) -> Self {
        let picture = |view, frame| Some(((view, frame), PictureOf(outcome.submitted(view, frame).ok()?)));
        let faults = outcome.faults().unwrap_or_default();
        let findings = outcome.findings.vulkan.iter().chain(&outcome.findings.openxr);
        // hello_xr prints messages of the Vulkan loader and lists of capabilities, and has two threads that print, now and then
        // into each other's lines.
        let is_told = |line: &String| {
            let noise = [
                "[Loader Message]",
                "[Validation]",
                "[Info",
                "any key",
                "INFO: (INSTANCE",
                "Core Validation",
                "VALIDATION LAYER",
            ];
            line != "[" && noise.iter().all(|noise| !line.contains(noise)) && !is_of_late_hello_xr(line)
        };
        let output = outcome.output.lines().map(without_numbers).filter(is_told).collect();
        Self {
            exit_code: outcome.exit_code,
            timed_out: outcome.timed_out,
            frames: outcome.record.frames.len(),
            output,
            log: outcome.log.clone(),
            rules: findings.map(|finding| finding.rule.clone()).collect(),
            pictures: SAVED
                .iter()
                .flat_map(|&frame| (0..2).filter_map(move |view| picture(view, frame)))
                .collect(),
            hits: outcome.record.injected + faults.iter().map(|report| report.failed).sum::<u64>(),
        }
    }
}

/// Times, handles and process numbers differ in every run.
fn without_numbers(text: &str) -> String {
    let words = text.split_inclusive(|character: char| !character.is_ascii_alphanumeric());
    let is_number = |word: &&str| word.starts_with(|first: char| first.is_ascii_digit());
    words.filter(|word| !is_number(word)).collect()
}
