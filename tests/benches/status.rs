//! `cargo dev bench status [--json] [--seconds N]`: output of `parafovea status` for five applications, one after the other, and the CPU
//! time of a core that it takes meanwhile, with that of the application's thread that writes the status.

use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{Status, read_all};
use parafovea_test_layers::ShadingRateProfile;
use parafovea_tests::artifacts::program;
use parafovea_tests::measure::{Row, print_json};
use parafovea_tests::run::{Application, Run, Running};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::process::{Command, ExitCode, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

type Failure = Box<dyn std::error::Error>;

const CONFIG: &str = "preset = \"none\"\n[rates]\nmode = \"fixed\"\n[gaze]\nsource = \"centre\"\n";
const STYLES: [&str; 3] = ["render-pass", "dynamic-rendering", "double-wide"];
/// Name of the layer's status thread; the system cuts names to 15 bytes.
const WRITER: &str = "parafovea-state";
const PATIENCE: Duration = Duration::from_secs(120);

fn main() -> ExitCode {
    match measure(std::env::args().skip(1)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn measure(mut arguments: impl Iterator<Item = String>) -> Result<(), Failure> {
    let (mut json, mut seconds) = (false, 20);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            // `cargo bench` adds it.
            "--bench" => {}
            "--json" => json = true,
            "--seconds" => {
                let value = arguments.next().unwrap_or_default();
                seconds = value.parse().map_err(|_| format!("--seconds needs a number, not `{value}`"))?;
            }
            other => return Err(format!("unknown argument `{other}`; allowed: --json, --seconds").into()),
        }
    }
    if !json {
        println!(
            "| application | backend | passes | saving | parafovea status, % of a core | telling, % of a core |"
        );
        println!("|---|---|---:|---|---:|---:|");
    }
    // The device has no rates, and hello_xr asks for a Vulkan without masks: it gets a device that looks as if it had rates.
    let hello_xr = Application::hello_xr("Vulkan2")?;
    one("hello_xr", &hello_xr, |run| run.shading_rates(ShadingRateProfile::NvkTuring), seconds, json)?;
    one("parafovea-scene", &Application::ours("parafovea-scene", &[])?, |run| run, seconds, json)?;
    for style in STYLES {
        let application =
            Application::ours("parafovea-zoo", &["--style", style, "--size", "256", "--frames", "1000000"])?;
        one(&format!("zoo: {style}"), &application, |run| run, seconds, json)?;
    }
    Ok(())
}

fn one(
    name: &str,
    application: &Application,
    change: impl FnOnce(Run) -> Run,
    seconds: u64,
    json: bool,
) -> Result<(), Failure> {
    let scenario = Scenario::new(1_000_000).sized(256, 256).in_real_time();
    let running = change(Run::new(application, &scenario).on(CONFIG)).timeout(PATIENCE * 4).start()?;
    let status = told(&running, |status| status.rates_gate.ratio.is_some())?;
    let tells = format!("/proc/{}/task/{}/schedstat", status.pid, thread(status.pid)?);
    let mut shows = Command::new(program("parafovea")?)
        .arg("status")
        .env("XDG_RUNTIME_DIR", running.runtime_folder())
        .stdout(Stdio::null())
        .spawn()?;
    let shows_file = format!("/proc/{}/schedstat", shows.id());
    // Its start is not a part of it.
    sleep(Duration::from_secs(1));
    let (begin, before) = (Instant::now(), [cpu_ns(&shows_file)?, cpu_ns(&tells)?]);
    sleep(Duration::from_secs(seconds));
    let after = [cpu_ns(&shows_file)?, cpu_ns(&tells)?];
    let passed_ns = begin.elapsed().as_nanos() as f64;
    shows.kill()?;
    shows.wait()?;
    let [shows, tells] = [0, 1].map(|index| (after[index] - before[index]) as f64 / passed_ns);
    if json {
        let row = |case: &str, value| Row {
            bench: "status",
            app: name.to_owned(),
            case: case.to_owned(),
            metric: "cpu_share".to_owned(),
            value,
            unit: "1",
            comparison: None,
        };
        print_json(&[row("parafovea status", shows), row("telling", tells)]);
        return Ok(());
    }
    let saving = status.rates_gate.ratio.map_or_else(String::new, |[ratio, low, high]| {
        let percent = |ratio: f32| (1.0 - ratio) * 100.0;
        format!("{:.0} % ({:.0} to {:.0})", percent(ratio), percent(high), percent(low))
    });
    let [shows, tells] = [shows, tells].map(|share| share * 100.0);
    println!(
        "| {name} | {} | {} | {saving} | {shows:.3} | {tells:.3} |",
        status.backend, status.passes_matched
    );
    Ok(())
}

/// The application's status, once it meets the condition.
fn told(running: &Running, is_so: impl Fn(&Status) -> bool) -> Result<Status, Failure> {
    let begin = Instant::now();
    let environment =
        Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| running.runtime_folder().into()));
    loop {
        match read_all(&environment, SystemTime::now()).found.into_iter().next() {
            Some(found) if is_so(&found.status) => return Ok(found.status),
            found if begin.elapsed() > PATIENCE => {
                return Err(format!("nothing is measured: {found:#?}\n{}", running.log()).into());
            }
            _ => sleep(Duration::from_millis(100)),
        }
    }
}

/// Id of the status thread of a process.
fn thread(pid: u32) -> Result<String, Failure> {
    for task in std::fs::read_dir(format!("/proc/{pid}/task"))? {
        let task = task?;
        if std::fs::read_to_string(task.path().join("comm"))?.trim() == WRITER {
            return Ok(task.file_name().to_string_lossy().into_owned());
        }
    }
    Err(format!("no thread {WRITER}").into())
}

/// CPU time that a thread has taken, nanoseconds (proc(5), schedstat).
fn cpu_ns(file: &str) -> Result<u64, Failure> {
    let text = std::fs::read_to_string(file)?;
    Ok(text.split(' ').next().unwrap_or_default().parse()?)
}
