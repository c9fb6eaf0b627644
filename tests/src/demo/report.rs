//! The demo's results for people and for programs.

use super::{Finding, Saving};
use crate::HarnessError;
use parafovea_models::errors::RING_NAMES;

/// Prints costs, decisions and errors, an application a row.
pub fn print_tables(findings: &[Finding], savings: &[Saving]) {
    println!("\nCost per frame, both eyes, without and with the layer (preset \"balanced\"):\n");
    println!(
        "{:<14}{:>11}{:>11}{:>15}{:>15}{:>15}{:>8}",
        "application", "CPU ms off", "on", "ratio", "samples off", "on", "ratio"
    );
    for finding in findings {
        let [off, on] = [finding.off, finding.on];
        let count = |samples: Option<u64>| samples.map_or("-".to_owned(), |samples| samples.to_string());
        let ratio = off.samples.zip(on.samples).map(|(off, on)| on as f64 / off as f64);
        println!(
            "{:<14}{:>11.2}{:>11.2}{:>15}{:>15}{:>15}{:>8}",
            finding.app,
            off.cpu_ms,
            on.cpu_ms,
            format!("{:.2} +- {:.2}", finding.ratio, finding.spread),
            count(off.samples),
            count(on.samples),
            ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.2}")),
        );
    }
    println!();
    for finding in findings {
        println!("{:<14}{}", finding.app, finding.decision.decided);
    }
    println!(
        "\nError: largest difference within 5 degrees of the gaze (of 255), and contrast loss in just-noticeable"
    );
    println!("differences (JND): by degrees from the gaze, as the mean of the view, and as detected:\n");
    print!("{:<14}{:>7}", "application", "fovea");
    RING_NAMES.iter().for_each(|ring| print!("{ring:>8}"));
    println!("{:>8}{:>10}", "view", "detected");
    for finding in findings {
        print!("{:<14}{:>7}", finding.app, finding.fovea_max_error);
        for (_, jnd) in &finding.jnd {
            print!("{:>8}", jnd.map_or("-".to_owned(), |jnd| format!("{jnd:.2}")));
        }
        println!("{:>8.2}{:>10.2}", finding.jnd_view, finding.jnd_detected);
    }
    println!(
        "\nTechniques that are off in that preset, each alone, relative to the application without the layer:\n"
    );
    for Saving { app, technique, saves, left, ratio } in savings {
        let left = left.map_or("-".to_owned(), |left| format!("{left:.2}"));
        println!("{app}: {technique}: {saves} x {left}, CPU time x {ratio:.2}");
    }
}

/// Prints one JSON object a line: applications, then techniques alone.
///
/// # Errors
/// [`HarnessError::Format`], which plain figures do not cause.
pub fn print_json(findings: &[Finding], savings: &[Saving]) -> Result<(), HarnessError> {
    let lines = findings.iter().map(serde_json::to_string).chain(savings.iter().map(serde_json::to_string));
    for line in lines {
        let line =
            line.map_err(|error| HarnessError::format(std::path::Path::new("standard output"), error))?;
        println!("{line}");
    }
    Ok(())
}
