//! `cargo dev bench overhead [--json] [--instructions]`. The last counts instructions alone, which the machine's other work does
//! not change. `--driver NAME [CASE...]` measures the cost of planning per frame on a real driver over a no-op kernel shim, and `--driver gpu` on
//! this machine's GPU, with the layer's library of `--library PATH`; `cargo dev bench` passes a release build.

use parafovea_tests::HarnessError;
use parafovea_tests::device::Machine;
use parafovea_tests::drivers::{ShimDevice, Target};
use parafovea_tests::installation::Driver;
use parafovea_tests::overhead::{
    Added, Effort, Figure, hello_xr, planning, recording, recording_instructions,
};
use parafovea_tests::run::Run;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;

/// Name of this machine's GPU.
const GPU: &str = "gpu";

fn main() -> ExitCode {
    // `cargo bench` adds `--bench`.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    match measure(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn measure(arguments: &[String]) -> Result<(), String> {
    let failed = |error: HarnessError| error.to_string();
    let is_given = |name: &str| arguments.iter().any(|argument| argument == name);
    let value = |name: &str| {
        let place = arguments.iter().position(|argument| argument == name)?;
        arguments.get(place + 1)
    };
    const OPTIONS: [&str; 4] = ["--json", "--instructions", "--driver", "--library"];
    let is_unknown = |argument: &&String| argument.starts_with('-') && !OPTIONS.contains(&argument.as_str());
    if let Some(unknown) = arguments.iter().find(is_unknown) {
        return Err(format!("unknown option `{unknown}`; allowed: {}", OPTIONS.join(", ")));
    }
    let json = is_given("--json");
    if let Some(device) = value("--driver") {
        let library = value("--library").map(PathBuf::from);
        let options = [value("--driver"), value("--library")];
        let cases: Vec<String> = arguments
            .iter()
            .filter(|argument| !argument.starts_with("--") && !options.contains(&Some(argument)))
            .cloned()
            .collect();
        let target = target(device)?;
        let prepare = |run: Run| {
            let run = target.set_up(run);
            match &library {
                Some(library) => run.library(library),
                None => run,
            }
        };
        let added = planning(target.name(), &cases, Effort::PLANNING, prepare).map_err(failed)?;
        added.iter().for_each(if json { print_json } else { print_added });
        return Ok(());
    }
    let figures = if is_given("--instructions") {
        recording_instructions().map_err(failed)?
    } else {
        let all = [hello_xr(Effort::FULL), recording(Effort::FULL), recording_instructions()];
        all.into_iter().collect::<Result<Vec<_>, _>>().map_err(failed)?.concat()
    };
    figures.iter().for_each(if json { print_json } else { print_row });
    Ok(())
}

/// The device of `--driver`: [`GPU`], or one that a shim fakes.
fn target(name: &str) -> Result<Target, String> {
    if name == GPU {
        return Machine::of(Driver::System).map(Target::Gpu).map_err(|error| error.to_string());
    }
    let known = || ShimDevice::ALL.iter().map(|device| device.name()).collect::<Vec<_>>().join(", ");
    let device = ShimDevice::of_name(name);
    device.map(Target::Shim).ok_or_else(|| format!("--driver {name}: not {GPU} or one of {}", known()))
}

fn print_json<T: Serialize>(figure: &T) {
    match serde_json::to_string(figure) {
        Ok(line) => println!("{line}"),
        Err(error) => eprintln!("{error}"),
    }
}

fn print_added(added: &Added) {
    let budget = added.budget.map_or_else(String::new, |budget| format!("  budget {budget:.2} ms"));
    println!(
        "{:<10} {:<14} {:<12} {:>+8.4} ms  worst place {:>+8.4} ms  p99 {:>+8.4} ms  of all {:>+8.4} ms  (without the layer {:.4} ms){budget}",
        added.app,
        added.case,
        added.pace,
        added.value,
        added.worst_place,
        added.p99,
        added.p99_of_all,
        added.baseline
    );
}

fn print_row(figure: &Figure) {
    let added = figure.value - figure.baseline;
    println!(
        "{:<25} {:<18} {:<12} {:>9.4} {}  {added:>+8.4}  x {:.3} ± {:.3}",
        figure.app, figure.metric, figure.case, figure.value, figure.unit, figure.ratio, figure.spread
    );
}
