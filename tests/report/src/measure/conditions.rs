//! Machine, programs and time of a measurement.

use crate::plan::Plan;
use crate::results::Conditions;
use parafovea_tests::device::Machine;
use std::path::Path;
use std::process::Command;

pub fn conditions(plan: &Plan, machine: &Machine, command: &str) -> Conditions {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let (timed, judged) = (plan.timed, plan.judged);
    Conditions {
        device: machine.to_string(),
        device_is_cpu: machine.device.is_cpu,
        backend: if machine.device.has_rate_attachments { "rate attachment" } else { "mask" }.to_owned(),
        processor: processor(),
        threads,
        commit: commit(),
        date: output("date", &["-u", "+%F"]).unwrap_or_default(),
        command: command.to_owned(),
        timed: [timed.turns as u64, timed.run_up, timed.frames, u64::from(timed.size)],
        judged: [judged.run_up, judged.frames, u64::from(judged.size)],
        look: plan.look,
        fvvdp: plan.fvvdp.as_ref().map(|_| parafovea_models::errors::fvvdp::VERSION.to_owned()),
    }
}

/// The processor's name, as Linux has it.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    name.map_or("unknown processor", |(_, name)| name.trim()).to_owned()
}

/// The commit that is checked out, and whether files differ from it.
fn commit() -> String {
    let Some(commit) = output("git", &["rev-parse", "--short=10", "HEAD"]) else {
        return "unknown".to_owned();
    };
    let changed = output("git", &["status", "--porcelain", "--untracked-files=no"]);
    match changed.is_none_or(|changed| changed.is_empty()) {
        true => commit,
        false => format!("{commit} with changes"),
    }
}

/// A program's output, in the folder of this package; `None` if it fails.
fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new(program).args(arguments).current_dir(folder).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
