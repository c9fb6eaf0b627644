//! `cargo dev demo`: applications without the layer and with its default preset, as tables and as pictures.

use parafovea_tests::progress::Progress;
use parafovea_tests::{HarnessError, demo};
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (options, names): (Vec<_>, Vec<_>) =
        arguments.into_iter().partition(|argument| argument.starts_with('-'));
    let json = options == ["--json"];
    let mut exhibits = demo::exhibits();
    let known: Vec<&str> = exhibits.iter().map(demo::Exhibit::name).collect();
    let unknown = names.iter().find(|name| !known.contains(&name.as_str()));
    if let Some(other) = options.iter().find(|option| *option != "--json").or(unknown) {
        eprintln!(
            "`{other}`: usage: cargo dev demo [--json] [APPLICATION ...]; applications: {}",
            known.join(", ")
        );
        return ExitCode::FAILURE;
    }
    exhibits.retain(|exhibit| names.is_empty() || names.iter().any(|name| name == exhibit.name()));
    match show(&exhibits, names.is_empty(), json) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Shows applications, and with `each_technique` the techniques that are off in the preset, each alone, in the first one.
fn show(exhibits: &[demo::Exhibit], each_technique: bool, json: bool) -> Result<(), HarnessError> {
    let folder = demo::pictures_folder()?;
    let mut progress = Progress::new(demo::work(exhibits, each_technique));
    let (mut findings, mut savings) = (Vec::new(), Vec::new());
    for (number, exhibit) in exhibits.iter().enumerate() {
        let (finding, off) = demo::run(exhibit, &folder, &mut progress)?;
        findings.push(finding);
        if number == 0 && each_technique {
            savings.extend(demo::savings(exhibit, &off, &folder, &mut progress)?);
        }
    }
    eprintln!("[100 %] done after {:.0} s", progress.seconds());
    if json {
        return demo::print_json(&findings, &savings);
    }
    demo::print_tables(&findings, &savings);
    println!("\nPictures (off | on | difference x 8 | shading rates): {}", folder.display());
    Ok(())
}
