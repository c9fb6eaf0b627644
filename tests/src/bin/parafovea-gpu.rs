//! `cargo dev gpu [--json] [--styles A,B] [--frames N] [--size PIXELS] [--turns N] [--over-emulator]`.

use parafovea_test_layers::ShadingRateProfile;
use parafovea_tests::HarnessError;
use parafovea_tests::artifacts::target_folder;
use parafovea_tests::device::Machine;
use parafovea_tests::drivers::{JsonCell, Matrix, Row, Target};
use parafovea_tests::installation::Driver;
use parafovea_tests::measure::print_json;
use parafovea_tests::native::{Comparison, Length, Results, StyleResults, compare, styles, time};
use parafovea_zoo::{SKIPPED, Style};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Mutex, OnceLock};

fn main() -> ExitCode {
    match Request::read(std::env::args().skip(1)).and_then(|request| check(&request)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::FAILURE
        }
    }
}

const ARGUMENTS: &str = "--json, --styles, --frames, --size, --turns, --over-emulator";

/// Pictures are compared over so many frames of this size.
const COMPARED: Length = Length { frames: 24, size: 256 };

/// A style's comparison, or the features that the device lacks for it.
type Compared = Result<Comparison, String>;

struct Request {
    json: bool,
    styles: Vec<&'static Style>,
    timed: Length,
    turns: usize,
    over_emulator: bool,
}

impl Request {
    fn read(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut request = Self {
            json: false,
            styles: styles().collect(),
            timed: Length { frames: 100, size: 2048 },
            turns: 5,
            over_emulator: false,
        };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().unwrap_or_default();
            match argument.as_str() {
                "--json" => request.json = true,
                "--over-emulator" => request.over_emulator = true,
                "--styles" => request.styles = value().split(',').map(style).collect::<Result<_, _>>()?,
                "--frames" => request.timed.frames = number("--frames", &value(), 20)?,
                "--size" => request.timed.size = number("--size", &value(), 16)? as u32,
                "--turns" => request.turns = number("--turns", &value(), 0)? as usize,
                other => return Err(format!("unknown argument `{other}`; allowed: {ARGUMENTS}")),
            }
        }
        Ok(request)
    }
}

fn number(name: &str, value: &str, least: u64) -> Result<u64, String> {
    let number = value.parse().ok().filter(|number| (least..=8192).contains(number));
    number.ok_or_else(|| format!("{name} needs a number from {least} to 8192, not `{value}`"))
}

fn style(name: &str) -> Result<&'static Style, String> {
    let known = || styles().map(|style| style.name).collect::<Vec<_>>().join(", ");
    styles()
        .find(|style| style.name == name)
        .ok_or_else(|| format!("no style `{name}` sets rates itself; these do: {}", known()))
}

fn check(request: &Request) -> Result<(), String> {
    let machine = if request.over_emulator {
        Machine::over_stand_in(ShadingRateProfile::NvkTuring)
    } else {
        Machine::of(Driver::System)
    };
    let machine = machine.map_err(|error| error.to_string())?;
    if !request.over_emulator && (machine.device.is_cpu || !machine.device.has_rate_attachments) {
        println!("{SKIPPED}VK_KHR_fragment_shading_rate");
        return Ok(());
    }
    eprintln!(
        "{machine}: {} styles, pictures of {} frames at {side} x {side}, {} turns of {} frames at {size} x {size}",
        request.styles.len(),
        COMPARED.frames,
        request.turns,
        request.timed.frames,
        side = COMPARED.size,
        size = request.timed.size
    );
    let mut results = Results::new(&machine, request.timed);
    let mut faults = Vec::new();
    for (style, compared) in request.styles.iter().zip(compared(&machine, &request.styles)) {
        let found = compared.and_then(|compared| timed(&machine, style, compared, request));
        let found = found.map_err(|error| format!("{}: {error}", style.name))?;
        let fault = found.comparison.as_ref().and_then(|found| found.fault(machine.stand_in.is_none()));
        if request.json {
            print_json(&found.rows());
        } else {
            println!("{}", line(&found, fault.as_deref(), machine.stand_in.is_none()));
        }
        faults.extend(fault.map(|fault| format!("{}: {fault}", style.name)));
        results.styles.push(found);
    }
    let mut comparisons = results.styles.iter().filter_map(|found| found.comparison.as_ref()).peekable();
    let is_shown = comparisons.peek().is_none() || comparisons.any(Comparison::shows_rates);
    if machine.stand_in.is_none() && !is_shown {
        faults.push("rates change no picture of any style, with the layer or without it".to_owned());
    }
    let path = results.write(&folder(&machine)?).map_err(|error| error.to_string())?;
    eprintln!("written: {}", path.display());
    if machine.stand_in.is_none() {
        faults.extend(run_matrix(machine, request.json)?);
    }
    if faults.is_empty() { Ok(()) } else { Err(faults.join("\n")) }
}

/// The matrix of `cargo dev drivers` on the GPU: its faults.
fn run_matrix(machine: Machine, json: bool) -> Result<Vec<String>, String> {
    let print = |row: &Row| row.runs.iter().filter(|_| json).for_each(|run| println!("{}", run.json()));
    let matrix = Matrix::new(vec![Target::Gpu(machine)], "", print).map_err(|error| error.to_string())?;
    if !json {
        println!("{}\n{}", matrix.table(), matrix.summary());
    }
    Ok(matrix.faults().into_iter().map(JsonCell::to_string).collect())
}

/// Folder of the results: among the sources for a GPU, to be committed; in the target folder for a stand-in.
fn folder(machine: &Machine) -> Result<PathBuf, String> {
    match machine.stand_in {
        None => Ok(Path::new(env!("CARGO_MANIFEST_DIR")).join("gpu-results")),
        Some(_) => Ok(target_folder().map_err(|error| error.to_string())?.join("gpu-results")),
    }
}

/// The comparisons of all styles, in their order, made on all cores: pictures do not depend on the load.
fn compared(machine: &Machine, styles: &[&'static Style]) -> Vec<Result<Compared, HarnessError>> {
    let next = Mutex::new(styles.iter().enumerate());
    let done: Vec<_> = styles.iter().map(|_| OnceLock::new()).collect();
    let work = || {
        loop {
            // A poisoned lock means that another thread panicked, which ends the scope with a panic.
            let Some((index, style)) = next.lock().ok().and_then(|mut next| next.next()) else { return };
            _ = done[index].set(compare(machine, style, COMPARED));
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| (0..threads).for_each(|_| _ = scope.spawn(work)));
    done.into_iter().filter_map(OnceLock::into_inner).collect()
}

/// The results of a style, with the times that are asked for: one run after the other.
fn timed(
    machine: &Machine,
    style: &Style,
    compared: Compared,
    request: &Request,
) -> Result<StyleResults, HarnessError> {
    let (comparison, lacking) = match compared {
        Ok(comparison) => (Some(comparison), None),
        Err(lacking) => (None, Some(lacking)),
    };
    let is_timed = lacking.is_none() && request.turns > 0;
    let times = is_timed.then(|| time(machine, style, request.timed, request.turns)).transpose()?;
    Ok(StyleResults { style: style.name.to_owned(), lacking, comparison, times })
}

fn line(found: &StyleResults, fault: Option<&str>, over_gpu: bool) -> String {
    let pictures = match (&found.lacking, fault) {
        (Some(lacking), _) => format!("{SKIPPED}{lacking}"),
        (None, Some(fault)) => format!("WRONG: {fault}"),
        (None, None) => {
            let is_shown = found.comparison.as_ref().is_some_and(Comparison::shows_rates);
            let rest = if over_gpu && !is_shown { ", which changes no pixel" } else { "" };
            format!("as set natively{rest}")
        }
    };
    let times = found.times.as_ref().map_or(String::new(), |times| {
        let ratio = |[value, spread]: [f64; 2]| format!("{value:.3} ± {spread:.3}");
        format!(
            "; GPU ms: off {:.3}, layer x {}, native x {}, attached at 1x1 x {}",
            times.off_ms,
            ratio(times.layer),
            ratio(times.native),
            ratio(times.attached)
        )
    });
    format!("{:20} {pictures}{times}", found.style)
}
