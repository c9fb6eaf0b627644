//! `cargo dev bench overhead [--json] [--instructions]`. The last counts instructions alone, which the machine's other work does
//! not change.

use parafovea_tests::HarnessError;
use parafovea_tests::overhead::{Effort, Figure, hello_xr, recording, recording_instructions};
use std::process::ExitCode;

fn main() -> ExitCode {
    // `cargo bench` adds `--bench`.
    let is_given = |name: &str| std::env::args().any(|argument| argument == name);
    let json = is_given("--json");
    match measure(is_given("--instructions")) {
        Ok(figures) => {
            figures.iter().for_each(if json { print_json } else { print_row });
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn measure(instructions_alone: bool) -> Result<Vec<Figure>, HarnessError> {
    if instructions_alone {
        return recording_instructions();
    }
    Ok([hello_xr(Effort::FULL)?, recording(Effort::FULL)?, recording_instructions()?].concat())
}

fn print_json(figure: &Figure) {
    match serde_json::to_string(figure) {
        Ok(line) => println!("{line}"),
        Err(error) => eprintln!("{error}"),
    }
}

fn print_row(figure: &Figure) {
    let added = figure.value - figure.baseline;
    println!(
        "{:<25} {:<18} {:<12} {:>9.4} {}  {added:>+8.4}  x {:.3} ± {:.3}",
        figure.app, figure.metric, figure.case, figure.value, figure.unit, figure.ratio, figure.spread
    );
}
