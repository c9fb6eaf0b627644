//! `parafovea doctor`.

mod probe;

use crate::install::library_beside_this_program;
use parafovea_manifest::config::Names;
use parafovea_manifest::doctor::{Finding, Severity, Surroundings, examine};
use parafovea_manifest::install::InstallError;
use serde_json::json;
use std::collections::BTreeSet;
use std::env;
use std::path::Path;
use std::process::ExitCode;
use std::time::SystemTime;

/// Output and repairs.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct Options {
    /// Repair Parafovea's own files; change nothing else
    #[arg(long)]
    fix: bool,
    /// Print one JSON object per line: id, severity, found, means, advice, fixable
    #[arg(long)]
    json: bool,
    /// Also print passed checks
    #[arg(long, short)]
    verbose: bool,
}

/// Prints the findings; fails if a problem remains.
pub fn doctor(application: Option<String>, options: Options) -> ExitCode {
    let mut surroundings = surroundings();
    surroundings.shipped = library_beside_this_program();
    let now = SystemTime::now();
    let known = |name: &String| Names::known(&surroundings.environment, name, now);
    let unknown = application.as_ref().filter(|name| known(name).is_none()).map(|name| {
        Finding::unknown_application(name, &Names::similar(&surroundings.environment, name, now))
    });
    surroundings.application =
        application.as_ref().map(|name| known(name).unwrap_or_else(|| Names::unknown(name)));
    surroundings.probed = probe::probe();
    let mut findings = examine(&surroundings);
    let mut has_failed = false;
    if options.fix {
        for line in fix(&findings, &surroundings) {
            match line {
                // With --json, standard output has findings only.
                Ok(line) if options.json => complain!("{line}"),
                Ok(line) => crate::print(&format!("{line}\n")),
                Err(error) => {
                    has_failed = true;
                    complain!("parafovea: {error}");
                }
            }
        }
        surroundings.probed = probe::probe();
        findings = examine(&surroundings);
    }
    findings.extend(unknown);
    for finding in &findings {
        if options.json {
            crate::print(&format!("{}\n", as_json(finding)));
        } else if options.verbose || finding.severity > Severity::Good {
            crate::print(&format!("{finding}\n"));
        }
    }
    if !options.json {
        crate::print(&summary(&findings));
    }
    let is_well = findings.iter().all(|finding| finding.severity < Severity::Problem);
    if is_well && !has_failed { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The surroundings of this process.
pub fn surroundings() -> Surroundings {
    let mut surroundings = Surroundings::new(Path::new("/"), env::vars_os());
    if let Ok(program) = env::current_exe() {
        surroundings.program = program;
    }
    surroundings
}

/// Repairs all fixable findings; a line for each step.
fn fix(findings: &[Finding], surroundings: &Surroundings) -> Vec<Result<String, InstallError>> {
    let mut done = BTreeSet::new();
    let mut lines = Vec::new();
    for fix in findings.iter().filter_map(|finding| finding.fix.as_ref()) {
        if !done.insert(format!("{fix:?}")) {
            continue;
        }
        match fix.plan(surroundings) {
            Ok(steps) => {
                lines.extend(steps.iter().map(|step| step.apply().map(|()| format!("fixed: {step}"))));
            }
            Err(error) => lines.push(Err(error)),
        }
    }
    lines
}

fn as_json(finding: &Finding) -> serde_json::Value {
    json!({
        "id": finding.id,
        "severity": finding.severity.name(),
        "found": finding.found,
        "means": finding.means,
        "advice": finding.advice,
        "fixable": finding.fix.is_some(),
    })
}

fn summary(findings: &[Finding]) -> String {
    let count = |severity| findings.iter().filter(|finding| finding.severity == severity).count();
    let (problems, warnings) = (count(Severity::Problem), count(Severity::Warning));
    let fixable = findings.iter().filter(|finding| finding.fix.is_some()).count();
    let counted = |number, name: &str| format!("{number} {name}{}", if number == 1 { "" } else { "s" });
    let is_whole = findings.iter().all(|finding| finding.id != "cannot-check");
    let mut line = match (problems, warnings) {
        (0, 0) if !is_whole => {
            "No problem found, but some checks could not run: see the notes.".to_owned()
        }
        (0, 0) => "No problem found. To play: parafovea run -- GAME, or in Steam the launch options PARAFOVEA=1 %command%.".to_owned(),
        _ => format!("{}, {}.", counted(problems, "problem"), counted(warnings, "warning")),
    };
    if fixable > 0 {
        line += &format!(" parafovea doctor --fix can repair {fixable} of these.");
    }
    line + "\n"
}
