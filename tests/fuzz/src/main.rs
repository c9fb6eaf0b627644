//! `cargo dev fuzz [TARGET] [--minutes N]`: mutated inputs for one target or all, another seed each time, which is printed.

use parafovea_fuzz::{TARGETS, Target, Until, run};
use std::process::ExitCode;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

const USAGE: &str = "usage: cargo dev fuzz [TARGET] [--minutes N]";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (targets, minutes) = match parse(&arguments) {
        Ok(request) => request,
        Err(reason) => {
            eprintln!("{reason}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    // Panics are findings, printed below.
    std::panic::set_hook(Box::new(|_| {}));
    let seed = SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |now| now.as_secs());
    let mut is_clean = true;
    for target in targets {
        match run(target, seed, Until::Time(Duration::from_secs_f64(60.0 * minutes))) {
            Ok(executions) => {
                println!("{}: {executions} executions, seed {seed}: nothing found", target.name)
            }
            Err(finding) => {
                is_clean = false;
                let input = String::from_utf8_lossy(&finding.input).into_owned();
                println!("{}: {}\n{input:?}\n{:?}", target.name, finding.what, finding.input);
            }
        }
    }
    if is_clean { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn parse(arguments: &[String]) -> Result<(Vec<&'static Target>, f64), String> {
    let (mut targets, mut minutes): (Vec<&Target>, f64) = (TARGETS.iter().collect(), 1.0);
    let mut arguments = arguments.iter();
    while let Some(argument) = arguments.next() {
        if argument == "--minutes" {
            let number = arguments.next().and_then(|text| text.parse().ok());
            minutes = number
                .filter(|minutes| (0.0..=10_000.0).contains(minutes))
                .ok_or("--minutes takes a number")?;
        } else {
            targets.retain(|target| target.name == argument);
            if targets.is_empty() {
                return Err(format!(
                    "unknown target {argument}; allowed: {}",
                    TARGETS.map(|target| target.name).join(", ")
                ));
            }
        }
    }
    Ok((targets, minutes))
}
