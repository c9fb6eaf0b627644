//! A program on one device: all its runs, and the layer's faults in them.

use super::{Cell, End, Engaged, Mode, Program, Seen, Stack, Target};
use crate::HarnessError;
use parafovea_zoo::Style;
use serde::Serialize;
use std::collections::BTreeSet;

/// A program on a device, with all its runs.
#[derive(Default)]
pub struct Row {
    /// The device's name.
    pub device: String,
    /// The program's name.
    pub program: String,
    /// Reason why the device cannot run the program at all; None where it can.
    pub refusal: Option<String>,
    /// Stacks without runs of the layer, and why: the program fails there without it, too.
    pub left_out: Vec<String>,
    /// The runs, those without the layer included.
    pub runs: Vec<JsonCell>,
}

/// A run, as `cargo dev drivers --json` prints it.
#[derive(Clone, Debug, Serialize)]
pub struct JsonCell {
    /// The device's name.
    pub device: String,
    /// The program's name, for styles of the zoo the style's.
    pub style: String,
    /// The other layers around ours.
    pub stack: &'static str,
    /// The layer's configuration.
    pub mode: &'static str,
    /// `rates` or `masks` where the layer made passes of an eye buffer coarser by them; `no` where it made none so; null
    /// where it was not asked to, where rates are decided on the GPU, or where the application sets rates itself.
    pub engaged: Option<&'static str>,
    /// Messages of validation and of the runtime beyond those without the layer, and warnings and errors in the layer's log.
    pub messages: Vec<String>,
    /// Exit of the program.
    pub outcome: String,
    /// Whether it ended worse than without the layer, or the layer worked while it was disabled.
    #[serde(skip)]
    pub is_worse: bool,
}

impl std::fmt::Display for JsonCell {
    /// The run, and its first messages, each once.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}, {}, {}: {}", self.device, self.style, self.stack, self.mode, self.outcome)?;
        let messages: BTreeSet<&String> = self.messages.iter().collect();
        messages.into_iter().take(MESSAGES_SHOWN).try_for_each(|message| write!(f, "\n    {message}"))
    }
}

/// Different messages of a run that people are shown.
const MESSAGES_SHOWN: usize = 6;

impl JsonCell {
    /// An object in a line.
    pub fn json(&self) -> String {
        // Structures of strings always serialise.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Whether something is wrong with the layer in this run.
    pub fn is_fault(&self) -> bool {
        self.is_worse || !self.messages.is_empty()
    }
}

/// Styles whose runs are the whole product of stacks and modes: the ways to begin a pass and to record draws.
const WHOLE: [&str; 7] = [
    "descriptor-buffers",
    "render-pass",
    "dynamic-rendering",
    "multiview",
    "subpasses",
    "secondaries",
    "shader-objects",
];

/// The runs of other styles.
const SHARE: [Cell; 5] = [
    Cell { stack: Stack::Alone, mode: Mode::Off },
    Cell { stack: Stack::Alone, mode: Mode::Rates },
    Cell { stack: Stack::Alone, mode: Mode::Everything },
    Cell { stack: Stack::Validated, mode: Mode::Off },
    Cell { stack: Stack::Validated, mode: Mode::Everything },
];

/// The runs of a program in the whole matrix. Those without the layer come first in each stack.
pub fn cells(program: Program) -> Vec<Cell> {
    let is_whole = |style: &Style| WHOLE.contains(&style.name);
    match program {
        Program::Style(style) if !is_whole(style) => SHARE.to_vec(),
        _ => Stack::ALL
            .into_iter()
            .flat_map(|stack| Mode::ALL.into_iter().map(move |mode| Cell { stack, mode }))
            .collect(),
    }
}

/// Runs a program in all `cells`; cells without the layer come first in each stack.
///
/// # Errors
/// Errors of the harness only.
pub fn judge(target: &Target, program: Program, cells: &[Cell]) -> Result<Row, HarnessError> {
    let mut row = Row { device: target.name().to_owned(), program: program.name(), ..Row::default() };
    if let Some(refusal) = target.refusal(program) {
        row.refusal = Some(refusal.to_owned());
        return Ok(row);
    }
    let mut baseline: Option<(Stack, Seen)> = None;
    let mut failing = None;
    for &cell in cells.iter() {
        if failing == Some(cell.stack) {
            continue;
        }
        let Some(seen) = cell.run(program, |run| target.set_up(run))? else { continue };
        let without = baseline.as_ref().filter(|(stack, _)| *stack == cell.stack).map(|(_, seen)| seen);
        row.runs.push(json(&row, program, cell, &seen, without));
        if cell.mode == Mode::Off {
            if let End::Skipped(reason) = &seen.end {
                row.refusal = Some(format!("no device with {reason}"));
                return Ok(row);
            }
            // Its exit code is the doctor's verdict.
            let is_failure = seen.end != End::Whole && !matches!(program, Program::Doctor);
            if is_failure {
                row.left_out.push(format!("{}, {} without the layer", cell.stack.name(), seen.end));
                failing = Some(cell.stack);
            }
            baseline = Some((cell.stack, seen));
        }
    }
    Ok(row)
}

fn json(row: &Row, program: Program, cell: Cell, seen: &Seen, without: Option<&Seen>) -> JsonCell {
    JsonCell {
        device: row.device.clone(),
        style: row.program.clone(),
        stack: cell.stack.name(),
        mode: cell.mode.name(),
        engaged: (program.has_frames() && !program.sets_rates())
            .then(|| engaged(cell.mode, seen.engaged))
            .flatten(),
        messages: messages(program, seen, without),
        outcome: seen.end.to_string(),
        is_worse: is_worse(program, cell.mode, seen, without.map(|without| &without.end)),
    }
}

fn engaged(mode: Mode, engaged: Engaged) -> Option<&'static str> {
    let is_engaged = match mode {
        Mode::Off | Mode::Inert | Mode::Everything => return None,
        Mode::Rates | Mode::Mask => engaged.coarse > 0,
    };
    let by = if engaged.has_attachments && mode != Mode::Mask { "rates" } else { "masks" };
    Some(if is_engaged { by } else { "no" })
}

fn is_worse(program: Program, mode: Mode, seen: &Seen, without: Option<&End>) -> bool {
    let is_violent = matches!(seen.end, End::Signal(_) | End::Hung);
    let is_other = match program {
        // Its exit code is its verdict.
        Program::Doctor => false,
        _ => seen.end != End::Whole && without.is_none_or(|without| *without != seen.end),
    };
    let is_disabled = matches!(mode, Mode::Off | Mode::Inert);
    let ended_so_without = without == Some(&seen.end);
    mode != Mode::Off && (is_violent && !ended_so_without || is_other || is_disabled && seen.engaged.eyes > 0)
}

fn messages(program: Program, seen: &Seen, without: Option<&Seen>) -> Vec<String> {
    let outcome = &seen.outcome;
    let no_findings = Default::default();
    let findings = without.map_or(&no_findings, |without| &without.outcome.findings);
    let of_validation: Vec<String> = match without {
        None => Vec::new(),
        Some(_) => {
            let mut new = outcome.findings.beyond(findings);
            let has_without = |rule: &str| findings.vulkan.iter().any(|found| found.rule == rule);
            let is_own = |rule: &str| program.own_violations().contains(&rule) && has_without(rule);
            new.retain(|found| !is_own(&found.rule));
            new.into_iter().map(|found| format!("{}: {}", found.rule, found.text)).collect()
        }
    };
    let before = without.map_or(0, |without| without.outcome.record.errors.len());
    let errors = &outcome.record.errors;
    let of_runtime = errors
        .iter()
        .filter(|_| errors.len() > before && without.is_some())
        .map(|error| format!("{}: {}", error.call, error.message));
    let of_log = outcome.complaints().into_iter().map(str::to_owned);
    of_validation.into_iter().chain(of_runtime).chain(of_log).collect()
}
