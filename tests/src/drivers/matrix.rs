//! Many rows, made on all cores, and the table of them.

use super::{JsonCell, Mode, Program, Row, Target, cells, judge};
use crate::HarnessError;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// The rows of several devices.
pub struct Matrix {
    targets: Vec<Target>,
    rows: Vec<Row>,
}

impl Matrix {
    /// Judges every program on every target whose names, `DEVICE PROGRAM`, have `part` in them, and hands each finished row
    /// to `done`.
    ///
    /// # Errors
    /// Errors of the harness only.
    pub fn new(targets: Vec<Target>, part: &str, done: impl Fn(&Row) + Sync) -> Result<Self, HarnessError> {
        let jobs: Vec<(usize, Program)> = Program::all()
            .into_iter()
            .flat_map(|program| (0..targets.len()).map(move |target| (target, program)))
            .filter(|(target, program)| {
                format!("{} {}", targets[*target].name(), program.name()).contains(part)
            })
            .collect();
        let (next, made) = (Mutex::new(jobs.iter().enumerate()), Mutex::new(Vec::new()));
        let work = || {
            loop {
                // A poisoned lock means that another thread panicked, which ends the scope with a panic.
                let Some((index, (target, program))) = next.lock().ok().and_then(|mut next| next.next())
                else {
                    return;
                };
                let row = judge(&targets[*target], *program, &cells(*program));
                if let Ok(row) = &row {
                    done(row);
                }
                if let Ok(mut made) = made.lock() {
                    made.push((index, row));
                }
            }
        };
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        std::thread::scope(|scope| (0..threads).for_each(|_| _ = scope.spawn(work)));
        let mut made = made.into_inner().unwrap_or_default();
        made.sort_by_key(|(index, _)| *index);
        let rows = made.into_iter().map(|(_, row)| row).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { targets, rows })
    }

    /// All runs.
    pub fn runs(&self) -> impl Iterator<Item = &JsonCell> {
        self.rows.iter().flat_map(|row| &row.runs)
    }

    /// Runs in which something was wrong with the layer.
    pub fn faults(&self) -> Vec<&JsonCell> {
        self.runs().filter(|run| run.is_fault()).collect()
    }

    /// The table in Markdown: a line for each program, a column for each device, then the reasons why programs were left out.
    pub fn table(&self) -> String {
        let names: Vec<&str> = self.targets.iter().map(Target::name).collect();
        let mut text = format!("| program | {} |\n|---|{}\n", names.join(" | "), "---|".repeat(names.len()));
        let mut programs: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !programs.contains(&row.program.as_str()) {
                programs.push(&row.program);
            }
        }
        for program in programs {
            let of_program =
                |name: &&str| self.rows.iter().find(|row| row.program == program && row.device == **name);
            let cells = names.iter().map(|name| of_program(name).map_or("", Row::word));
            text += &format!("| {program} | {} |\n", cells.collect::<Vec<_>>().join(" | "));
        }
        let left_out = self.left_out();
        if left_out.is_empty() { text } else { format!("{text}\nLeft out:\n\n{left_out}") }
    }

    /// A line for each reason to leave runs out, with the devices.
    fn left_out(&self) -> String {
        let mut devices: BTreeMap<String, Vec<&str>> = BTreeMap::new();
        for row in &self.rows {
            for reason in row.refusal.iter().chain(&row.left_out) {
                devices.entry(format!("{}: {reason}", row.program)).or_default().push(&row.device);
            }
        }
        devices.iter().map(|(reason, devices)| format!("- {reason} ({})\n", devices.join(", "))).collect()
    }

    /// One line: the number of devices, programs, runs and faults.
    pub fn summary(&self) -> String {
        let with_outcome = |sign: &str| self.faults().iter().filter(|run| run.outcome.contains(sign)).count();
        let messages: usize = self.runs().map(|run| run.messages.len()).sum();
        let engaged = self.runs().filter(|run| matches!(run.engaged, Some("rates" | "masks"))).count();
        let asked = self.runs().filter(|run| run.engaged.is_some()).count();
        format!(
            "{} devices, {} rows, {} runs: engaged in {engaged} of {asked}; {} crashes, {} hangs, {} other bad ends, {messages} messages",
            self.targets.len(),
            self.rows.len(),
            self.runs().count(),
            with_outcome("signal"),
            with_outcome("hung"),
            self.faults().iter().filter(|run| run.is_worse).count()
                - with_outcome("signal")
                - with_outcome("hung"),
        )
    }
}

impl Row {
    /// Its word in the table: the effect of rates, unless something is wrong.
    fn word(&self) -> &'static str {
        if self.refusal.is_some() {
            return "–";
        }
        if self.runs.iter().any(JsonCell::is_fault) {
            return "**fault**";
        }
        let with_rates = self.runs.iter().find(|run| run.mode == Mode::Rates.name());
        match with_rates {
            None => "fails without the layer",
            Some(run) => run.engaged.unwrap_or("ends"),
        }
    }
}
