//! `cargo dev drivers [--json] [PART] | --profiles | --kernels | --cache`: the layer on Mesa's real drivers over no-op kernel shims.

use parafovea_tests::drivers::kernels;
use parafovea_tests::drivers::profiles::{self, QUERIED};
use parafovea_tests::drivers::{Folder, JsonCell, Matrix, Program, Row, ShimDevice, Target, warmth};
use std::process::ExitCode;

fn main() -> ExitCode {
    match Request::read(std::env::args().skip(1)).and_then(|request| check(&request)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::FAILURE
        }
    }
}

#[derive(Default)]
struct Request {
    json: bool,
    profiles: bool,
    kernels: bool,
    cache: bool,
    part: String,
}

impl Request {
    fn read(arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut request = Self::default();
        for argument in arguments {
            match argument.as_str() {
                "--json" => request.json = true,
                "--profiles" => request.profiles = true,
                "--kernels" => request.kernels = true,
                "--cache" => request.cache = true,
                part if !part.starts_with('-') && request.part.is_empty() => request.part = argument,
                other => {
                    return Err(format!(
                        "`{other}`: usage: cargo dev drivers [--json] [PART] | --profiles | --kernels | --cache"
                    ));
                }
            }
        }
        Ok(request)
    }
}

fn check(request: &Request) -> Result<(), String> {
    if request.profiles {
        let written = QUERIED.into_iter().try_for_each(|(profile, device)| profiles::write(profile, device));
        return written.map_err(|error| error.to_string());
    }
    if request.kernels {
        let all = kernels::keep().map_err(|error| error.to_string())?;
        println!("{}", kernels::table(&all));
        return Ok(());
    }
    if request.cache {
        print_warmth(ShimDevice::Navi21);
        return Ok(());
    }
    let targets = targets();
    for target in &targets {
        let version = target.version().map_err(|error| error.to_string())?;
        eprintln!("{}: {version}", target.name());
    }
    let done = |row: &Row| row.runs.iter().for_each(|run| print(run, request.json));
    let matrix = Matrix::new(targets, &request.part, done).map_err(|error| error.to_string())?;
    if !request.json {
        println!("{}\n{}", matrix.table(), matrix.summary());
    }
    match (matrix.runs().count(), matrix.faults().len()) {
        (0, _) => Err(format!("no combination of device and program has `{}` in its name", request.part)),
        (_, 0) => Ok(()),
        (runs, faults) => Err(format!("{faults} of {runs} runs failed")),
    }
}

/// Prints the entries that a warm driver cache lacks for each style.
fn print_warmth(device: ShimDevice) {
    println!("| program | without, cold | without, again | rates | rates, again | everything |");
    println!("|---|---:|---:|---:|---:|---:|");
    for program in Program::all().into_iter().filter(|program| matches!(program, Program::Style(_))) {
        match warmth(program, device) {
            Ok(warmth) => println!("{warmth}"),
            Err(error) => eprintln!("skipped: {}: {error}", program.name()),
        }
    }
}

/// All devices with unpacked drivers.
fn targets() -> Vec<Target> {
    for folder in [Folder::Release, Folder::Sid] {
        if let Err(error) = folder.path() {
            eprintln!("skipped: {error}");
        }
    }
    let is_there = |device: &ShimDevice| device.folder().path().is_ok();
    ShimDevice::ALL.into_iter().filter(is_there).map(Target::Shim).collect()
}

/// Prints a run: all as JSON, or faults for people.
fn print(run: &JsonCell, json: bool) {
    if json {
        println!("{}", run.json());
    } else if run.is_fault() {
        eprintln!("{run}");
    }
}
