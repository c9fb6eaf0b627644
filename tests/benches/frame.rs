//! `cargo dev bench frame [--json] [--frames N] [--turns N] [--size PIXELS]`.

use parafovea_tests::HarnessError;
use parafovea_tests::measure::{Effort, Subject, Technique, print_json, print_table, rows, time};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::process::ExitCode;

fn main() -> ExitCode {
    match Request::read(std::env::args().skip(1))
        .and_then(|request| measure(request).map_err(|error| error.to_string()))
    {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

struct Request {
    json: bool,
    effort: Effort,
}

impl Request {
    fn read(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut request = Self { json: false, effort: Effort { turns: 5, frames: 40, size: 1024 } };
        while let Some(argument) = arguments.next() {
            let mut number = |name: &str, least: u64| {
                let value = arguments.next().unwrap_or_default();
                let number = value.parse().ok().filter(|number| (least..=8192).contains(number));
                number.ok_or_else(|| format!("{name} needs a number from {least} to 8192, not `{value}`"))
            };
            match argument.as_str() {
                // `cargo bench` adds it.
                "--bench" => {}
                "--json" => request.json = true,
                "--frames" => request.effort.frames = number("--frames", 20)?,
                "--turns" => request.effort.turns = number("--turns", 1)? as usize,
                "--size" => request.effort.size = number("--size", 16)? as u32,
                other => {
                    return Err(format!(
                        "unknown argument `{other}`; there are --json, --frames, --turns, --size"
                    ));
                }
            }
        }
        Ok(request)
    }
}

fn measure(request: Request) -> Result<(), HarnessError> {
    let subjects = [Subject::new("courtyard", &[], Scenario::new(0))];
    let techniques = [
        Technique::off(),
        Technique::layer("chroma", "[chroma]\nmode = \"default\"\n"),
        Technique::render_scale(0.9),
        Technique::render_scale(0.7),
        Technique::render_scale(0.5),
    ];
    let effort = request.effort;
    let runs = subjects.len() * techniques.len() * (effort.turns + 1);
    eprintln!(
        "{} scenes, {} techniques, {} turns of {} frames at {side} x {side}: {runs} runs",
        subjects.len(),
        techniques.len(),
        effort.turns,
        effort.frames,
        side = effort.size
    );
    let mut done = 0;
    for subject in &subjects {
        let timings = time(subject, &techniques, effort, |run| {
            done += 1;
            eprintln!("[{done}/{runs}] {run}");
        })?;
        let rows = rows(subject.name(), &timings);
        if request.json { print_json(&rows) } else { print_table(&rows) }
    }
    Ok(())
}
