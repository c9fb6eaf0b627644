//! `cargo dev demo`: applications without the layer and with its default preset, as tables and as pictures.

use parafovea_tests::progress::Progress;
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
    let exhibits = demo::exhibits();
    let mut progress = Progress::new(demo::work(&exhibits));
    let mut findings = Vec::new();
    for exhibit in &exhibits {
        findings.push(demo::run(exhibit, &folder, &mut progress)?);
    }
    let savings = match exhibits.first() {
        Some(scene) => demo::savings(scene, &folder, &mut progress)?.to_vec(),
        None => Vec::new(),
    };
    eprintln!("[100 %] done after {:.0} s", progress.seconds());
    if json {
        return demo::print_json(&findings, &savings);
    }
    demo::print_tables(&findings, &savings);
    println!("\nPictures (off | on | difference x 8 | shading rates): {}", folder.display());
    Ok(())
}
