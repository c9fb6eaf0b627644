//! `cargo dev bench frame [--json] [--scenes A,B] [--techniques A,B] [--tracker NAME] [--frames N] [--run-up N] [--turns N] [--size PIXELS]
//! [--error-frames N] [--error-size PIXELS] [--head DEGREES_PER_S] [--system-driver] [--against NAME=FILE]`. With `--against`, techniques of the
//! layer have their turn with that build's library too, as `cargo dev bench --compare REV` asks for. With `--system-driver` applications run on the
//! system's GPU instead of lavapipe, and its time is taken by timestamps. With `--head`, head and eyes do not move as in the scene's script: the
//! head turns at that speed (0: it rests), and the gaze is at the centre of the view. `hello_xr` is a scene too, and so is each style of the zoo,
//! all of them as `styles`, though not by default: styles have a table of one row per technique. The run-up is 4 frames, or 120 for techniques of
//! the layer: the others then reach the same frames sooner. JOD is the report's: `cargo dev report --jod`.

use parafovea_scene::scene::SceneName;
use parafovea_scene::script::tracker::Tracker;
use parafovea_tests::device::Machine;
use parafovea_tests::installation::Driver;
use parafovea_tests::measure::{
    Effort, LAYER_RUN_UP, RUN_UP, RUN_UP_ALONE, StyleRows, Subject, Summary, Technique, Timing, against_rows,
    error_rows, errors, print_json, rows, time,
};
use parafovea_zoo::{STYLES, Style};
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let request = Request::read(std::env::args().skip(1));
    match request.and_then(|request| measure(&request).map_err(|error| describe(&*error))) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

const ARGUMENTS: &str = "--json, --scenes, --techniques, --tracker, --frames, --run-up, --turns, --size, --error-frames, --error-size, --head, --system-driver, --against";

/// Arguments of the bench.
#[derive(Clone, Copy)]
enum App {
    Scene(SceneName),
    HelloXr,
    Style(&'static Style),
}

impl App {
    fn named(name: &str) -> Result<Vec<Self>, String> {
        if name == "styles" {
            return Ok(STYLES.iter().copied().map(Self::Style).collect());
        }
        let known = SceneName::ALL.map(SceneName::as_str).join(", ");
        let scene = SceneName::ALL.into_iter().find(|scene| scene.as_str() == name).map(Self::Scene);
        let style = || STYLES.iter().copied().find(|style| style.name == name).map(Self::Style);
        let app = scene.or((name == "hello_xr").then_some(Self::HelloXr)).or_else(style);
        let app = app.ok_or_else(|| {
            format!("unknown scene `{name}`; allowed: {known}, hello_xr, styles and each of the zoo's")
        });
        Ok(vec![app?])
    }

    fn before_a_saccade(self, tracker: Tracker, frames: u64) -> Subject {
        match self {
            Self::Scene(scene) => Subject::before_a_saccade(scene, tracker, frames),
            _ => self.subject(tracker),
        }
    }

    fn subject(self, tracker: Tracker) -> Subject {
        match self {
            Self::Scene(scene) => Subject::around_a_saccade(scene, tracker),
            Self::HelloXr => Subject::hello_xr(tracker),
            Self::Style(style) => Subject::style(style, tracker),
        }
    }
}

struct Request {
    json: bool,
    apps: Vec<App>,
    /// Names; all without.
    techniques: Option<Vec<String>>,
    tracker: Tracker,
    timed: Effort,
    /// Frames before the timed ones; None: the techniques' own numbers.
    run_up: Option<u64>,
    /// No frames: no errors.
    judged: Effort,
    /// Angular velocity of the head, degrees a second; None: the head motion of the script.
    head_deg_per_s: Option<f32>,
    driver: Driver,
    /// Another build of the layer: its name and its library.
    against: Option<(String, PathBuf)>,
}

impl Request {
    fn read(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut request = Self {
            json: false,
            apps: SceneName::ALL
                .into_iter()
                .filter(|scene| *scene != SceneName::Courtyard)
                .map(App::Scene)
                .collect(),
            techniques: None,
            tracker: Tracker::GOOD,
            timed: Effort { turns: 5, run_up: 0, frames: 36, size: 1024 },
            run_up: None,
            judged: Effort { turns: 1, run_up: RUN_UP, frames: 30, size: 512 },
            head_deg_per_s: None,
            driver: Driver::Lavapipe,
            against: None,
        };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().unwrap_or_default();
            match argument.as_str() {
                // `cargo bench` adds it.
                "--bench" => {}
                "--json" => request.json = true,
                "--scenes" => {
                    let named = value().split(',').map(App::named).collect::<Result<Vec<_>, _>>()?;
                    request.apps = named.concat();
                }
                "--system-driver" => request.driver = Driver::System,
                "--against" => request.against = Some(against(&value())?),
                "--techniques" => {
                    request.techniques = Some(value().split(',').map(str::to_owned).collect());
                }
                "--tracker" => request.tracker = tracker(&value())?,
                "--frames" => request.timed.frames = number("--frames", &value(), 20)?,
                "--run-up" => request.run_up = Some(number("--run-up", &value(), 0)?),
                "--turns" => request.timed.turns = number("--turns", &value(), 1)? as usize,
                "--size" => request.timed.size = number("--size", &value(), 16)? as u32,
                "--error-frames" => request.judged.frames = number("--error-frames", &value(), 0)?,
                "--error-size" => request.judged.size = number("--error-size", &value(), 16)? as u32,
                "--head" => request.head_deg_per_s = Some(number("--head", &value(), 0)? as f32),
                other => return Err(format!("unknown argument `{other}`; allowed: {ARGUMENTS}")),
            }
        }
        if request.head_deg_per_s.is_some() && request.judged.frames > 0 {
            return Err("errors are at the gaze of the script: --head goes with --error-frames 0".to_owned());
        }
        Ok(request)
    }
}

fn number(name: &str, value: &str, least: u64) -> Result<u64, String> {
    let number = value.parse().ok().filter(|number| (least..=8192).contains(number));
    number.ok_or_else(|| format!("{name} needs a number from {least} to 8192, not `{value}`"))
}

fn against(text: &str) -> Result<(String, PathBuf), String> {
    let parts = text.split_once('=').map(|(name, file)| (name.to_owned(), PathBuf::from(file)));
    let found = parts.filter(|(_, file)| file.is_file());
    found.ok_or_else(|| format!("--against needs NAME=FILE with the library of another build, not `{text}`"))
}

fn tracker(name: &str) -> Result<Tracker, String> {
    let known = Tracker::NAMED.map(|(name, _)| name).join(", ");
    Tracker::named(name).ok_or_else(|| format!("unknown tracker `{name}`; allowed: {known}"))
}

/// An error with its causes.
fn describe(error: &dyn Error) -> String {
    match error.source() {
        Some(source) => format!("{error}: {}", describe(source)),
        None => error.to_string(),
    }
}

/// All techniques, or the `wanted` ones and the first, with which the others are compared.
fn techniques(wanted: Option<&[String]>) -> Result<Vec<Technique>, String> {
    let mut techniques = Technique::baselines();
    techniques.push(Technique::layer("chroma", "preset = \"none\"\n[chroma]\nmode = \"default\"\n"));
    // As a user has it: with the gate.
    techniques.push(Technique::layer("balanced", "preset = \"balanced\"\n"));
    // Rates alone, and never dropped: chroma has its price and no gain, and the gate looks before it decides.
    techniques.extend(["quality", "balanced", "performance"].map(|preset| {
        let config = format!("preset = \"{preset}\"\n[rates]\ngate = \"on\"\n[chroma]\nmode = \"off\"\n");
        Technique::layer(&format!("rates {preset}"), &config)
    }));
    // By contrast alone: there is no sound.
    techniques.push(Technique::layer(
        "contrast",
        "preset = \"balanced\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n[chroma]\nmode = \"off\"\n",
    ));
    // Of five regions 1/1, 1/1, 1/2, 1/2 and 1/3 of the frames.
    techniques.extend(
        [("reuse", "off", "on", "off"), ("reuse paper", "off", "paper", "off"), ("everything", "fixed", "on", "default")]
            .map(|(name, rates, reuse, chroma)| {
                let config = format!(
                    "preset = \"balanced\"\n[rates]\nmode = \"{rates}\"\ngate = \"on\"\n[reuse]\nmode = \"{reuse}\"\n[chroma]\nmode = \"{chroma}\"\n"
                );
                Technique::layer(name, &config)
            }),
    );
    let Some(wanted) = wanted else { return Ok(techniques) };
    let known = |name: &String| techniques.iter().any(|technique| technique.name == *name);
    if let Some(unknown) = wanted.iter().find(|name| !known(name)) {
        let names: Vec<&str> = techniques.iter().map(|technique| technique.name.as_str()).collect();
        return Err(format!("unknown technique `{unknown}`; allowed: {}", names.join(", ")));
    }
    let first = techniques.first().map(|technique| technique.name.clone());
    techniques
        .retain(|technique| Some(&technique.name) == first.as_ref() || wanted.contains(&technique.name));
    Ok(techniques)
}

fn measure(request: &Request) -> Result<(), Box<dyn Error>> {
    let mut techniques = techniques(request.techniques.as_deref())?;
    if let Some((name, library)) = &request.against {
        techniques.retain(|technique| technique.has_layer() || technique == &Technique::off());
        let layer = techniques.iter().filter(|technique| technique.has_layer());
        let others: Vec<Technique> = layer.map(|technique| technique.of_library(name, library)).collect();
        techniques.extend(others);
    }
    let has_layer = techniques.iter().any(Technique::has_layer);
    let run_up = request.run_up.unwrap_or(if has_layer { LAYER_RUN_UP } else { RUN_UP_ALONE });
    let timed = Effort { run_up, ..request.timed };
    let judged = match has_layer {
        // With the run-up of the timed runs, and the saccade in the middle of the judged frames.
        true => Effort { run_up, ..request.judged },
        false => request.judged,
    };
    let with_errors = judged.frames > 0 && request.against.is_none();
    let machine = Machine::of(request.driver)?;
    eprintln!("{machine}");
    let subjects: Vec<([Subject; 2], Vec<Technique>)> = request
        .apps
        .iter()
        .map(|app| {
            let moved = |subject: Subject| match request.head_deg_per_s {
                Some(deg_per_s) => subject.turning(deg_per_s),
                None => subject,
            };
            let subject = moved(app.subject(request.tracker)).on(&machine);
            let techniques =
                techniques.iter().filter(|technique| subject.can_try(technique)).cloned().collect();
            let seen = match has_layer {
                true => app.before_a_saccade(request.tracker, judged.run_up + judged.frames / 2).on(&machine),
                false => subject.clone(),
            };
            ([subject, seen], techniques)
        })
        .collect();
    let runs_each = timed.turns + 1 + usize::from(with_errors);
    let runs = runs_each * subjects.iter().map(|(_, techniques)| techniques.len()).sum::<usize>();
    let errors_are = match judged.frames {
        frames if with_errors => format!("errors of {frames} frames at {0} x {0}", judged.size),
        _ => "no errors".to_owned(),
    };
    eprintln!(
        "{} scenes, {} techniques, {} turns of {} frames after {run_up} at {size} x {size}, {errors_are}: {runs} runs",
        subjects.len(),
        techniques.len(),
        timed.turns,
        timed.frames,
        size = timed.size
    );
    let mut done = 0;
    let mut progress = |run: &str| {
        done += 1;
        eprintln!("[{done}/{runs}] {run}");
    };
    if subjects.iter().any(|([subject, _], _)| subject.is_style()) && !request.json {
        println!("\n{}", StyleRows::HEAD);
    }
    for ([subject, seen], techniques) in &subjects {
        if let Some(lacking) = subject.lacks()? {
            eprintln!("{}: {lacking}", subject.name());
            continue;
        }
        let timings = match time(subject, techniques, timed, machine.has_gpu_times(), &mut progress) {
            // Some count fragments themselves, or in command buffers that the device cannot count in.
            Err(error) if subject.is_style() => {
                eprintln!("{}: {error}", subject.name());
                continue;
            }
            other => other?,
        };
        let judged = if with_errors { errors(seen, techniques, judged, &mut progress)? } else { Vec::new() };
        let app = subject.name();
        if let Some((name, _)) = &request.against {
            compare(app, name, &timings, request.json);
            continue;
        }
        if subject.is_style() && !request.json {
            println!("{}", StyleRows { style: app, timings: &timings });
        } else if request.json {
            print_json(&rows(app, &timings));
            for (technique, report) in techniques[1..].iter().zip(&judged) {
                print_json(&error_rows(app, &technique.name, report));
            }
        } else {
            println!("{}", Summary { app, timings: &timings, judged: &judged });
        }
    }
    Ok(())
}

/// Prints how this build compares with the other one, technique by technique.
fn compare(app: &str, name: &str, timings: &[Timing], json: bool) {
    let rows = against_rows(app, name, timings);
    if json {
        return print_json(&rows);
    }
    println!(
        "\n### {app}\n\n| technique | metric | here | {name} | here / {name} |\n|---|---|---:|---:|---:|"
    );
    for row in &rows {
        let Some(with) = row.comparison else { continue };
        let spread = with.spread.map_or(String::new(), |spread| format!(" ± {spread:.3}"));
        let (case, metric, unit) = (&row.case, &row.metric, row.unit);
        println!(
            "| {case} | {metric}, {unit} | {:.2} | {:.2} | {:.3}{spread} |",
            row.value, with.baseline, with.ratio
        );
    }
}
