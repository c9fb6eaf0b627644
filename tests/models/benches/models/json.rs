//! The results as JSON, one object a line.

use parafovea_models::{audio_visual, eyes, hard_cases};
use serde::Deserialize;
use serde_json::{Value, json};
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

/// Asks for it.
pub const FLAG: &str = "--json";

/// Set in the environment, it leaves out the tables.
pub const TIMES_ONLY: &str = "PARAFOVEA_MODELS_TIMES_ONLY";

/// Runs this program again, as criterion prints for people only, and prints its results.
pub fn print() -> ExitCode {
    match rows() {
        Ok(rows) => {
            for row in rows {
                println!("{row}");
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn rows() -> Result<Vec<Value>, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let status = Command::new(std::env::current_exe()?)
        .args(std::env::args_os().skip(1).filter(|argument| argument != FLAG))
        .env("CRITERION_HOME", folder.path())
        .env(TIMES_ONLY, "1")
        .stdout(Stdio::null())
        .status()?;
    if !status.success() {
        return Err(format!("the benches ended with {status}").into());
    }
    let mut rows: Vec<Value> = hard_cases::table().iter().map(hard_case).collect();
    rows.extend(eyes::rows().iter().map(followed));
    rows.extend(audio_visual::rows(&super::audio_visual::scenes()).iter().map(saved));
    let mut results = results(folder.path())?;
    results.sort();
    for result in results {
        rows.push(timing(&result)?);
    }
    Ok(rows)
}

fn hard_case(case: &hard_cases::Case) -> Value {
    json!({
        "bench": "models", "app": case.model, "case": case.case, "metric": "hard_case", "value": case.error,
        "unit": "difference from double precision", "expected": case.expected, "got": case.got,
        "passed": case.passed,
    })
}

fn followed(row: &eyes::Row) -> Value {
    let mut value = json!({
        "bench": "models", "app": "gaze", "case": row.case, "metric": row.metric, "value": row.value, "unit": row.unit,
    });
    if let Some(baseline) = row.baseline {
        value["baseline"] = json!(baseline);
        value["ratio"] = json!(row.value / baseline);
    }
    value
}

fn saved(row: &audio_visual::Row) -> Value {
    let unit = match row.metric {
        "score" => "score",
        "loss" => "visible contrast",
        "decided_by_model" => "share of tiles",
        _ => "invocations per pixel",
    };
    let mut value = json!({
        "bench": "models", "app": row.scene, "case": row.case, "metric": row.metric, "value": row.value, "unit": unit,
    });
    if let Some(baseline) = row.baseline {
        value["baseline"] = json!(baseline);
        value["ratio"] = json!(row.value / baseline);
    }
    value
}

/// The folders below `folder` that hold the newest result of one function.
fn results(folder: &Path) -> Result<Vec<PathBuf>, std::io::Error> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.join("estimates.json").is_file() && path.ends_with("new") {
            found.push(path);
        } else if path.is_dir() {
            found.extend(results(&path)?);
        }
    }
    Ok(found)
}

#[derive(Deserialize)]
struct Estimates {
    median: Estimate,
}

#[derive(Deserialize)]
struct Estimate {
    point_estimate: f64,
}

#[derive(Deserialize)]
struct Identity {
    full_id: String,
}

fn timing(result: &Path) -> Result<Value, Box<dyn Error>> {
    let estimates: Estimates = serde_json::from_slice(&fs::read(result.join("estimates.json"))?)?;
    let identity: Identity = serde_json::from_slice(&fs::read(result.join("benchmark.json"))?)?;
    let (model, case) = identity.full_id.split_once('/').unwrap_or((&identity.full_id, ""));
    let value = estimates.median.point_estimate;
    Ok(json!({
        "bench": "models", "app": model, "case": case, "metric": "median_time", "value": value, "unit": "ns",
    }))
}
