//! `cargo dev demo`: unmodified applications with the layer and without, as a table and as pictures.

use parafovea_tests::{HarnessError, demo};
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let json = arguments == ["--json"];
    if !json && !arguments.is_empty() {
        eprintln!("parafovea-demo takes `--json` or nothing, and got: {}", arguments.join(" "));
        return ExitCode::FAILURE;
    }
    match show(json) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn show(json: bool) -> Result<(), HarnessError> {
    let folder = demo::pictures_folder()?;
    let mut findings = Vec::new();
    for subject in demo::subjects()? {
        eprintln!("running {}, off and on by turns", subject.application.name());
        findings.push(demo::run(&subject, &folder)?);
    }
    demo::print_table(&findings);
    println!("Pictures: {}", folder.display());
    if json { demo::print_json(&findings) } else { Ok(()) }
}
