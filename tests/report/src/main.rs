//! `cargo dev report [--quick | --all] [--json] [...]`: see `--help`.

use clap::Parser;
use parafovea_models::errors::fvvdp::Fvvdp;
use parafovea_report::hardware::{Look, hardware_points};
use parafovea_report::pictures::Pictures;
use parafovea_report::plan::Plan;
use parafovea_report::points::{Extent, Sweep, points};
use parafovea_report::results::Results;
use parafovea_report::{gpu, measure, page, plot, summary, table};
use parafovea_scene::scene::SceneName;
use parafovea_scene::scene::generated::Kind;
use parafovea_tests::artifacts::target_folder;
use parafovea_tests::installation::Driver;
use parafovea_tests::measure::print_json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Measure speed against error of all techniques, and of alternatives without the layer; write target/report/index.html, and the same as
/// Markdown, CSV and SVG.
#[derive(Parser)]
#[command(name = "cargo dev report")]
struct Arguments {
    /// 2 scenes, 6 techniques beside the application alone, 30 frames at 512 x 512: at most five minutes.
    #[arg(long)]
    quick: bool,
    /// Every point of every sweep in six scenes, instead of a selection that takes an hour and a half.
    #[arg(long, conflicts_with = "quick")]
    all: bool,
    /// Also print each figure as a JSON object, one per line.
    #[arg(long)]
    json: bool,
    /// Scenes instead of the default ones, separated by commas.
    #[arg(long, value_enum, value_delimiter = ',')]
    scenes: Vec<SceneName>,
    /// Also two scenes generated from this seed, a room and a street: a test on scenes for which nothing was tuned.
    #[arg(long)]
    seed: Option<u32>,
    /// Number of gaze scripts for the comparison of maps.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..100))]
    scripts: Option<u32>,
    /// Techniques instead of the default ones, separated by commas; the application alone is always among them.
    #[arg(long, value_delimiter = ',')]
    techniques: Vec<String>,
    /// Number of timed runs of each technique.
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..100))]
    turns: Option<u64>,
    /// Number of frames before the measured ones.
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..1000))]
    run_up: Option<u64>,
    /// Number of timed frames, and the largest number of judged frames.
    #[arg(long, value_parser = clap::value_parser!(u64).range(2..1000))]
    frames: Option<u64>,
    /// Side of the timed images, in pixels; judged images are at most as large.
    #[arg(long, value_parser = clap::value_parser!(u32).range(64..8192))]
    size: Option<u32>,
    /// Also judge by JOD, with this Python interpreter, which has pyfvvdp 1.2.2 (see tests/report/README.md). The licence of pyfvvdp is
    /// CC BY-NC 4.0: not for commercial use.
    #[arg(long, value_name = "PYTHON", conflicts_with = "from")]
    jod: Option<PathBuf>,
    /// Only the comparison of maps of shading rates, and render scales, without times.
    #[arg(long, conflicts_with = "system_driver")]
    maps: bool,
    /// Look of the compared maps.
    #[arg(long, value_enum, default_value = "rates")]
    look: Look,
    /// Use the system's GPU instead of lavapipe.
    #[arg(long)]
    system_driver: bool,
    /// Keep the results of this GPU in tests/gpu-results/, for comparisons with others.
    #[arg(long, requires = "system_driver")]
    keep: bool,
    /// Make the page from the results in this file, without a measurement.
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
}

fn main() -> ExitCode {
    match report(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::FAILURE
        }
    }
}

fn report(arguments: &Arguments) -> Result<(), String> {
    let folder = target_folder().map_err(|error| error.to_string())?.join("report");
    let mut pictures =
        Pictures::new(&folder.join("pictures")).map_err(|error| format!("{}: {error}", folder.display()))?;
    let results = match &arguments.from {
        Some(path) => Results::read(path)?,
        None => measured(arguments, &mut pictures)?,
    };
    results.write(&folder.join("results.json"))?;
    if arguments.keep {
        let path = gpu::path(&results);
        std::fs::create_dir_all(gpu::folder()).map_err(|error| error.to_string())?;
        results.write(&path)?;
        eprintln!("kept: {}", path.display());
    }
    write(&results, &folder, &pictures)?;
    if arguments.json {
        print_json(&table::json_rows(&results));
    }
    Ok(())
}

fn measured(arguments: &Arguments, pictures: &mut Pictures) -> Result<Results, String> {
    let plan = plan(arguments)?;
    eprintln!(
        "{} scenes, {} techniques, {} turns of {} frames at {size} x {size}, errors of {} frames at {side} x {side}: {} runs",
        plan.scenes.len(),
        plan.points.len(),
        plan.timed.turns,
        plan.timed.frames,
        plan.judged.frames,
        plan.runs(),
        size = plan.timed.size,
        side = plan.judged.size,
    );
    let command = std::env::args().skip(1).fold("cargo dev report".to_owned(), |command, argument| {
        match argument.contains(' ') {
            true => format!("{command} \"{argument}\""),
            false => format!("{command} {argument}"),
        }
    });
    let (results, seconds) = measure(&plan, &command, pictures).map_err(|error| error.to_string())?;
    eprintln!("{:.1} minutes", seconds / 60.0);
    let full = Plan { fvvdp: plan.fvvdp.clone(), ..Plan::full() };
    if plan.work() < full.work() {
        let minutes = seconds / 60.0 * full.work() as f64 / plan.work() as f64;
        eprintln!(
            "the whole report is {:.0} times as much work: about {minutes:.0} minutes",
            full.work() as f64 / plan.work() as f64
        );
    }
    Ok(results)
}

fn plan(arguments: &Arguments) -> Result<Plan, String> {
    let mut plan = match (arguments.quick, arguments.all) {
        (true, _) => Plan::quick(),
        (_, true) => Plan::all(),
        _ => Plan::full(),
    };
    let is_cut = !arguments.scenes.is_empty() || !arguments.techniques.is_empty() || arguments.size.is_some();
    if is_cut {
        // The pass at the finest resolution is part of the whole report only.
        plan.fine = None;
    }
    if !arguments.techniques.is_empty() {
        let is_wanted = |name: &String| arguments.techniques.contains(name);
        plan.hardware =
            hardware_points(Extent::All).into_iter().filter(|point| is_wanted(&point.name)).collect();
    }
    if !arguments.scenes.is_empty() {
        plan.scenes.clone_from(&arguments.scenes);
    }
    if let Some(seed) = arguments.seed {
        plan.scenes.extend(Kind::ALL.map(|kind| SceneName::Generated(kind, seed)));
    }
    plan.scripts = arguments.scripts.unwrap_or(plan.scripts);
    plan.look = arguments.look;
    if !arguments.techniques.is_empty() {
        let all = points(Extent::All);
        let shaded = hardware_points(Extent::All);
        let names: Vec<&str> = all
            .iter()
            .map(|point| point.technique.name.as_str())
            .chain(shaded.iter().map(|point| point.name.as_str()))
            .collect();
        for wanted in &arguments.techniques {
            if !names.contains(&wanted.as_str()) {
                return Err(format!("unknown technique `{wanted}`; allowed: {}", names.join(", ")));
            }
        }
        let is_wanted = |name: &String| name == "off" || arguments.techniques.contains(name);
        plan.points = all.into_iter().filter(|point| is_wanted(&point.technique.name)).collect();
    }
    if arguments.maps {
        plan.points.retain(|point| [Sweep::Off, Sweep::RenderScale].contains(&point.sweep));
        plan.points.iter_mut().for_each(|point| point.is_timed = false);
    }
    plan.timed.turns = arguments.turns.map_or(plan.timed.turns, |turns| turns as usize);
    for effort in [&mut plan.timed, &mut plan.judged] {
        effort.run_up = arguments.run_up.unwrap_or(effort.run_up);
    }
    if let Some(frames) = arguments.frames {
        plan.timed.frames = frames;
        plan.judged.frames = plan.judged.frames.min(frames);
    }
    if let Some(size) = arguments.size {
        plan.timed.size = size;
        plan.judged.size = plan.judged.size.min(size);
    }
    if arguments.system_driver {
        plan.driver = Driver::System;
    }
    let fvvdp = arguments.jod.as_deref().map(Fvvdp::of).transpose();
    plan.fvvdp = fvvdp.map_err(|error| format!("--jod {error}"))?;
    Ok(plan)
}

/// Page, Markdown, CSV and the plot apart.
fn write(results: &Results, folder: &Path, pictures: &Pictures) -> Result<(), String> {
    let gpus = gpu::kept()?;
    let gpu_rows = gpus.first().map(summary::mean_rows).unwrap_or_default();
    let csv = table::csv(results).map_err(|error| error.to_string())?;
    let files = [
        ("index.html", page::page(results, &gpus, pictures)?),
        ("report.md", table::markdown(results, &gpu_rows)),
        ("report.csv", csv),
        ("overview.svg", plot::overview(results)?),
    ];
    for (name, text) in files {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
        eprintln!("{}", path.display());
    }
    Ok(())
}
