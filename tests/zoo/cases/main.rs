//! A plain OpenXR and Vulkan application: each run does one small, exactly known thing with swapchains, sessions or actions, and prints its
//! observations.
//!
//! It knows nothing of any API layer. A run straight on a runtime is the reference; a run with a layer in
//! between has to observe the same.

mod app;
mod cases;
mod controls;
mod failure;
mod functions;
mod options;
mod paint;
mod sequences;
mod session;
mod soak;
mod swapchain;
mod vulkan;
mod xr;

use app::App;
use cases::{CASES, Case};
use clap::Parser;
use failure::Failure;
use options::Options;
use parafovea_zoo::cases::report::Report;
use sequences::Manner;
use std::process::ExitCode;
use std::time::Duration;

fn main() -> ExitCode {
    let options = Options::parse();
    if let Some(outcome) = run_long(&options) {
        return match outcome {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => {
                eprintln!("{failure}");
                ExitCode::FAILURE
            }
        };
    }
    let Some(name) = options.case.as_deref().filter(|_| !options.list) else {
        for case in CASES {
            println!("{}", case.name);
        }
        return ExitCode::SUCCESS;
    };
    let Some(case) = CASES.iter().find(|case| case.name == name) else {
        eprintln!("no case {name}: --list prints the names");
        return ExitCode::from(2);
    };
    let mut is_good = true;
    for _ in 0..options.lives {
        let report = run(case, &options);
        match serde_json::to_string(&report) {
            Ok(line) => println!("{line}"),
            Err(error) => {
                eprintln!("the report does not serialise: {error}");
                return ExitCode::FAILURE;
            }
        }
        is_good &= report.unexpected.is_empty();
    }
    if is_good { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Modes in place of a case.
fn run_long(options: &Options) -> Option<Result<(), Failure>> {
    let manner = if options.hostile { Manner::Hostile } else { Manner::Legal };
    match (options.soak, options.sequences) {
        (Some(seconds), _) => Some(soak::run(options, Duration::from_secs(seconds))),
        (None, Some(count)) => Some(sequences::run(options, options.first, count, manner)),
        (None, None) => None,
    }
}

fn run(case: &Case, options: &Options) -> Report {
    let mut report = Report::default();
    if let Err(failure) = run_into(case, options, &mut report) {
        report.unexpected.push(failure.to_string());
    }
    report.case = case.name.to_owned();
    report
}

fn run_into(case: &Case, options: &Options, report: &mut Report) -> Result<(), Failure> {
    let app = App::start(options, case.extensions)?;
    let result = (case.run)(&app);
    *report = app.into_report();
    result
}
