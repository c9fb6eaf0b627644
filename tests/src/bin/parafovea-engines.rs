//! `cargo dev engines [--json] [--turns N] [--scale PERCENT] [--without CHECKS] [PART]`: unmodified engines on Monado, without the layer and with it.

use parafovea_tests::engines::{Checks, Engine, System, judge, print_table};
use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "usage: cargo dev engines [--json] [--turns N] [--scale PERCENT] [--without CHECKS] [PART]; CHECKS are some of samples, \
                     pictures and messages, with commas in between";

fn main() -> ExitCode {
    match Request::read(std::env::args().skip(1)).and_then(|request| run(&request)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::FAILURE
        }
    }
}

/// Arguments.
struct Request {
    /// The folder of the system, the first argument.
    root: String,
    json: bool,
    /// Timed runs in each mode.
    turns: u32,
    /// Size of an eye buffer, per cent of Monado's 320x240.
    scale: u32,
    /// Checks beside times.
    checks: Checks,
    part: String,
}

impl Request {
    fn read(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let root = arguments.next().ok_or(USAGE)?;
        let mut request =
            Self { root, json: false, turns: 2, scale: 200, checks: Checks::ALL, part: String::new() };
        while let Some(argument) = arguments.next() {
            if argument == "--without" {
                let named = arguments.next().unwrap_or_default();
                request.checks =
                    Checks::without(&named).map_err(|unknown| format!("`{unknown}`: {USAGE}"))?;
                continue;
            }
            let mut number = || {
                let number = arguments.next().and_then(|text| text.parse().ok()).filter(|number| *number > 0);
                number.ok_or(format!("`{argument}` takes a number from 1; {USAGE}"))
            };
            match argument.as_str() {
                "--json" => request.json = true,
                "--turns" => request.turns = number()?,
                "--scale" => request.scale = number()?,
                part if !part.starts_with('-') && request.part.is_empty() => request.part = argument,
                other => return Err(format!("`{other}`: {USAGE}")),
            }
        }
        Ok(request)
    }
}

fn run(request: &Request) -> Result<(), String> {
    let named = |is_meant: &dyn Fn(&str) -> bool| -> Vec<Engine> {
        Engine::ALL.into_iter().filter(|engine| is_meant(&engine.name())).collect()
    };
    // Some engines' names begin with the whole name of another.
    let engines = match named(&|name| name == request.part) {
        exact if !exact.is_empty() => exact,
        _ => named(&|name| name.contains(&request.part)),
    };
    if engines.is_empty() {
        return Err(format!("no engine has `{}` in its name", request.part));
    }
    let system = System::filled(Path::new(&request.root)).map_err(|error| error.to_string())?;
    let mut findings = Vec::new();
    let mut failures = Vec::new();
    for engine in engines {
        match judge(&system, engine, (request.scale, request.turns), request.checks) {
            // At once: the next engine takes minutes.
            Ok(found) if request.json => {
                // Structures of strings and numbers always serialise.
                found
                    .iter()
                    .for_each(|found| println!("{}", serde_json::to_string(found).unwrap_or_default()));
            }
            Ok(found) => findings.extend(found),
            Err(error) => failures.push(error.to_string()),
        }
    }
    if !request.json {
        print_table(&findings);
    }
    match failures.is_empty() {
        true => Ok(()),
        false => Err(failures.join("\n")),
    }
}
