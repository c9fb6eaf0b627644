//! `cargo dev bench break-even [--json] [--turns N] [--frames N] [--run-up N] [--size PIXELS]`.

use parafovea_tests::HarnessError;
use parafovea_tests::break_even::{BreakEven, ITERATIONS, Point, WITH_RATES, break_even, points, rows};
use parafovea_tests::measure::{Effort, LAYER_RUN_UP, print_json};
use std::process::ExitCode;

fn main() -> ExitCode {
    let result = Request::read(std::env::args().skip(1))
        .and_then(|request| measure(&request).map_err(|error| error.to_string()));
    match result {
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
        let mut request =
            Self { json: false, effort: Effort { turns: 5, run_up: LAYER_RUN_UP, frames: 40, size: 1024 } };
        while let Some(argument) = arguments.next() {
            let mut number = || {
                let value = arguments.next().unwrap_or_default();
                let number = value.parse().ok().filter(|number| (1..=8192).contains(number));
                number.ok_or_else(|| format!("{argument} needs a number from 1 to 8192, not `{value}`"))
            };
            match argument.as_str() {
                // `cargo bench` adds it.
                "--bench" => {}
                "--json" => request.json = true,
                "--turns" => request.effort.turns = number()? as usize,
                "--frames" => request.effort.frames = number()?,
                "--run-up" => request.effort.run_up = number()?,
                "--size" => request.effort.size = number()? as u32,
                other => {
                    return Err(format!(
                        "unknown argument `{other}`; allowed: --json, --turns, --frames, --run-up, --size"
                    ));
                }
            }
        }
        Ok(request)
    }
}

fn measure(request: &Request) -> Result<(), HarnessError> {
    let points = points(&ITERATIONS, request.effort, WITH_RATES, |run| eprintln!("{run}"))?;
    if request.json {
        print_json(&rows(&points));
    } else {
        print_table(&points);
    }
    Ok(())
}

fn print_table(points: &[Point]) {
    println!("| iterations | ns a pixel | CPU ms, off | on | x off |\n|---:|---:|---:|---:|---:|");
    for point in points {
        let (off, on, ratio) = (point.off.median(), point.on.median(), point.ratio());
        println!(
            "| {} | {:.1} | {off:.1} | {on:.1} | {:.3} ± {:.3} |",
            point.iterations, point.ns, ratio.value, ratio.spread
        );
    }
    match break_even(points) {
        Some(BreakEven::At(ns)) => println!("\nThe layer gains from {ns:.1} ns of CPU time a pixel on."),
        Some(BreakEven::Below(ns)) => println!("\nThe layer gains already at {ns:.1} ns a pixel."),
        Some(BreakEven::Above(ns)) => println!("\nThe layer does not gain even at {ns:.1} ns a pixel."),
        None => {}
    }
}
