//! `cargo dev bench overhead [--json]`.

use parafovea_tests::HarnessError;
use parafovea_tests::overhead::{Effort, Figure, hello_xr, recording};
use std::process::ExitCode;

fn main() -> ExitCode {
    // `cargo bench` adds `--bench`.
    let json = std::env::args().any(|argument| argument == "--json");
    match measure() {
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

fn measure() -> Result<Vec<Figure>, HarnessError> {
    Ok([hello_xr(Effort::FULL)?, recording(Effort::FULL)?].concat())
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
