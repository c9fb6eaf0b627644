//! The section of `tests/baselines/drivers.md`.

use super::{Compiled, Estimate, GPUS, Kernels, TASKS, estimate};
use std::fmt::Write as _;

/// Two tables as Markdown: statistics of each entry point, and the estimates.
pub fn table(all: &[Kernels]) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write!(text, "{}\n{}", estimates(all), statistics(all));
    text
}

fn estimates(all: &[Kernels]) -> String {
    let mut text = "| task |".to_owned();
    for gpu in &GPUS {
        text += &format!(" {} |", gpu.name);
    }
    text += &format!("\n|---|{}\n", "---:|".repeat(GPUS.len()));
    for task in &TASKS {
        text += &format!("| {} |", task.name);
        for gpu in &GPUS {
            let kernels =
                gpu.compiler.and_then(|device| all.iter().find(|known| known.device == device.name()));
            let Estimate { floor_ms, ms } = estimate(task, gpu, kernels);
            let ms = ms.map_or("–".to_owned(), |ms| format!("{ms:.3}"));
            text += &format!(" {ms} ({floor_ms:.3}) |");
        }
        text.push('\n');
    }
    text += "\nTasks:\n\n";
    for task in &TASKS {
        text += &format!("- {}: {}\n", task.name, task.what);
    }
    text += "\nGPUs:\n\n";
    for gpu in &GPUS {
        let compiler = gpu
            .compiler
            .map_or("no shim of it: floor only".to_owned(), |device| format!("code of {}", device.name()));
        text += &format!("- {}; tiles of {} pixels; {compiler}\n", gpu.source, gpu.tile);
    }
    text
}

fn statistics(all: &[Kernels]) -> String {
    let mut text = "| kernel, entry point |".to_owned();
    for kernels in all {
        text += &format!(" {} |", kernels.device);
    }
    text += &format!("\n|---|{}\n", "---|".repeat(all.len()));
    let Some(first) = all.first() else { return text };
    for known in first.compiled.iter().filter(|known| known.stage != "VERTEX") {
        text += &format!("| {} {} |", known.kernel, known.entry);
        for kernels in all {
            let is_its = |other: &&Compiled| (&other.entry, &other.stage) == (&known.entry, &known.stage);
            text += &format!(" {} |", kernels.compiled.iter().find(is_its).map_or("–".to_owned(), cell));
        }
        text.push('\n');
    }
    text
}

/// Instructions, registers, occupancy, spills, and cycles, as far as the driver has them.
fn cell(compiled: &Compiled) -> String {
    let number =
        |names: &[&str]| compiled.statistic(names).map_or("–".to_owned(), |value| format!("{value:.0}"));
    let spills: f64 = compiled
        .statistics
        .iter()
        .filter(|(name, _)| name.to_lowercase().contains("spill"))
        .map(|(_, value)| value)
        .sum();
    format!(
        "{} / {} / {} / {spills:.0} / {}",
        number(&["Instructions", "Instruction count"]),
        number(&["VGPRs", "Number of GPRs"]),
        number(&["Subgroups per SIMD", "Max warps/SM"]),
        number(&["Inverse Throughput", "Static cycle count"]),
    )
}

#[cfg(test)]
mod tests {
    use super::super::kept;
    use super::*;

    /// `cargo dev drivers --kernels` writes the statistics and prints the tables.
    #[test]
    fn the_committed_table_is_that_of_the_kept_statistics() {
        let committed = include_str!("../../../baselines/drivers.md");
        let table = table(&kept().unwrap());
        assert!(committed.contains(&table), "it should be\n{table}");
    }
}
