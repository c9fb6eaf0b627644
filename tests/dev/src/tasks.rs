//! The tasks beyond `setup`: each builds its programs with the one profile that they all share.

use crate::building::build_with_progress;
use crate::compare;
use crate::drivers::unpack_release;
use crate::packages::can_build_audio;
use crate::release::{build_layer, build_package};
use crate::setup::{Voice, setup, setup_for_demo};
use crate::steps::{Steps, cargo, profile_folder};
use crate::suite::{self, Options, Summary};
use std::path::Path;
use std::process::Command;

/// The benches, and the packages that they are in.
const BENCHES: [(&str, &str); 14] = [
    ("break-even", "parafovea-tests"),
    ("budget", "parafovea-models"),
    ("detail", "parafovea-tests"),
    ("frame", "parafovea-tests"),
    ("gaze", "parafovea-models"),
    ("kernels", "parafovea-layer"),
    ("models", "parafovea-models"),
    ("overhead", "parafovea-tests"),
    ("planted", "parafovea-tests"),
    ("safety", "parafovea-models"),
    ("recognition", "parafovea-tests"),
    ("reuse", "parafovea-tests"),
    ("sound", "parafovea-sound"),
    ("status", "parafovea-tests"),
];

/// The bench that is a test.
const GATE: &str = "gate";

/// The packages that need ALSA's library.
const AUDIO: [&str; 3] = ["parafovea-audio", "parafovea-sound", "parafovea-fuzz"];

/// The programs of the demo. The shared libraries that it loads are dependencies of the first.
const DEMO: [&str; 3] = ["parafovea-demo", "parafovea-scene", "parafovea-zoo"];

/// Applications with the default preset and without the layer. Only the demo's own programs are built, with the features that the whole
/// workspace gives their dependencies: a later task builds none of them again.
pub fn demo(arguments: &[String]) -> Result<(), String> {
    setup_for_demo()?;
    let mut steps = Steps::default();
    eprintln!(
        "cargo dev: building the layer, the mock runtime, our test scene (with wgpu), the zoo of rendering styles, and the image comparison"
    );
    let mut cargo = workspace("build");
    DEMO.iter().for_each(|program| _ = cargo.args(["--bin", program]));
    build_with_progress("building", in_root(&mut cargo))?;
    steps.run("demo", Command::new(profile_folder()?.join("parafovea-demo")).args(arguments))
}

/// The checks of CI. With a part of tests' names: these tests alone.
pub fn test(arguments: &[String]) -> Result<(), String> {
    let options = Options::parse(arguments, std::env::var_os("CI").is_some())?;
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    let outcome = checks(&mut steps, &options);
    steps.summary();
    let summary = outcome?;
    eprint!("{summary}");
    match summary.failed() {
        0 => Ok(()),
        failed => Err(format!("{failed} tests")),
    }
}

fn checks(steps: &mut Steps, options: &Options) -> Result<Summary, String> {
    if options.part.is_none() {
        steps.run("cargo fmt", in_root(cargo().args(["fmt", "--all", "--check"])))?;
        let clippy = ["--all-targets", "--", "-D", "warnings"];
        steps.run("cargo clippy", in_root(workspace("clippy").args(clippy)))?;
    }
    build(steps)?;
    unpack_release();
    if options.part.is_none() {
        let doc = ["--no-deps", "--document-private-items"];
        // Private items are documented too, so links to them are not a mistake.
        let flags = "-D warnings -A rustdoc::private-intra-doc-links";
        steps.run("cargo doc", in_root(workspace("doc").args(doc)).env("RUSTDOCFLAGS", flags))?;
    }
    let tests = steps.time("cargo test --no-run", || suite::build(options))?;
    steps.time("tests", || suite::run(tests, options.is_strict))
}

/// Any OpenXR program with the layer.
pub fn run(arguments: &[String]) -> Result<(), String> {
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    build(&mut steps)?;
    steps.run("run", Command::new(profile_folder()?.join("parafovea-run")).args(arguments))
}

/// Every style of rendering at full length, of which `test` runs a share.
pub fn zoo(arguments: &[String]) -> Result<(), String> {
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    build(&mut steps)?;
    let zoo = ["test", "--locked", "--package", "parafovea-zoo", "--no-fail-fast", "--tests", "--"];
    steps.run("zoo", in_root(cargo().args(zoo).args(arguments)).env("PARAFOVEA_ZOO", "full"))
}

/// The whole fault matrix, of which `test` runs a share; under validation where that is asked for.
pub fn faults(arguments: &[String]) -> Result<(), String> {
    let (is_validated, arguments) = match arguments {
        [first, rest @ ..] if first == "--validated" => (true, rest),
        all => (false, all),
    };
    let wanted = match arguments {
        [] => "",
        [wanted] => wanted,
        [_, extra, ..] => {
            return Err(format!("`faults` accepts one part of the cell names; unexpected: `{extra}`"));
        }
    };
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    build(&mut steps)?;
    let matrix =
        ["test", "--locked", "--package", "parafovea-tests", "--test", "main", "the_whole_matrix_holds"];
    let mut command = cargo();
    command.args(matrix).args(["--", "--ignored", "--nocapture"]).env("PARAFOVEA_FAULTS", wanted);
    if is_validated {
        command.env("PARAFOVEA_FAULTS_VALIDATED", "1");
    }
    steps.run("faults", in_root(&mut command))
}

/// Random sequences of calls, of which `test` runs a few.
pub fn sequences(arguments: &[String]) -> Result<(), String> {
    let count = match arguments {
        [] => "100000",
        [count] if count.parse::<u64>().is_ok() => count,
        _ => return Err("usage: cargo dev sequences [COUNT]".to_owned()),
    };
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    build(&mut steps)?;
    let all = [
        "test",
        "--locked",
        "--package",
        "parafovea-tests",
        "--test",
        "main",
        "all_sequences_return_the_same",
    ];
    let mut command = cargo();
    command.args(all).args(["--", "--ignored", "--nocapture"]).env("PARAFOVEA_SEQUENCES", count);
    steps.run("sequences", in_root(&mut command))
}

/// Mutated files, chains and shaders for all that reads them.
pub fn fuzz(arguments: &[String]) -> Result<(), String> {
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    build(&mut steps)?;
    steps.run("fuzz", Command::new(profile_folder()?.join("parafovea-fuzz")).args(arguments))
}

/// Checks that need a real GPU.
pub fn gpu(arguments: &[String]) -> Result<(), String> {
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    build(&mut steps)?;
    steps.run("gpu", Command::new(profile_folder()?.join("parafovea-gpu")).args(arguments))
}

/// One bench, by name.
pub fn bench(arguments: &[String]) -> Result<(), String> {
    let Some((name, rest)) = arguments.split_first() else {
        return Err(format!("`bench` needs a name: {}", bench_names()));
    };
    match name.as_str() {
        "--compare" => return compare(rest),
        GATE => return gate(rest),
        _ => {}
    }
    let Some((name, package)) = BENCHES.into_iter().find(|(known, _)| known == name) else {
        return Err(format!("unknown benchmark `{name}`; allowed: {}", bench_names()));
    };
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    build(&mut steps)?;
    // The dev profile, as for everything else: the libraries that were just built are measured.
    let bench =
        ["bench", "--locked", "--quiet", "--profile", "dev", "--package", package, "--bench", name, "--"];
    let mut command = cargo();
    command.args(bench).args(rest);
    if name == "overhead" && rest.iter().any(|argument| argument == "--driver") {
        // Budgets are of the library that users have.
        build_layer(&mut steps)?;
        let target = profile_folder()?.parent().ok_or("the target folder is not known")?.to_owned();
        command.arg("--library").arg(target.join("release/libparafovea.so"));
    }
    steps.run(&format!("bench {name}"), in_root(&mut command))
}

/// The tables of the benefit gate's decisions, which tests of the models print and judge.
fn gate(arguments: &[String]) -> Result<(), String> {
    if let Some(extra) = arguments.first() {
        return Err(format!("`bench {GATE}` accepts no arguments; unexpected: `{extra}`"));
    }
    let table = ["test", "--locked", "--quiet", "--package", "parafovea-core", "--lib", "--"];
    let mut command = cargo();
    command.args(table).args(["gate::tests::table", "--nocapture", "--test-threads", "1"]);
    Steps::default().run(&format!("bench {GATE}"), in_root(&mut command))
}

/// Speed against error.
pub fn report(arguments: &[String]) -> Result<(), String> {
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    build(&mut steps)?;
    steps.run("report", Command::new(profile_folder()?.join("parafovea-report")).args(arguments))
}

/// The layer as it is here, beside that of a commit.
fn compare(arguments: &[String]) -> Result<(), String> {
    let Some((revision, rest)) = arguments.split_first() else {
        return Err("--compare needs a commit, for instance HEAD~5".to_owned());
    };
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    let (name, library) = compare::built(&mut steps, revision)?;
    build(&mut steps)?;
    let against = format!("{name}={}", library.display());
    let bench = [
        "bench",
        "--locked",
        "--quiet",
        "--profile",
        "dev",
        "--package",
        "parafovea-tests",
        "--bench",
        "frame",
    ];
    let arguments = if rest.iter().any(|argument| argument == "--techniques") { &[][..] } else { &COMPARED };
    let mut command = cargo();
    command.args(bench).args(["--", "--against", &against]).args(arguments).args(rest);
    steps.run(&format!("bench frame against {name}"), in_root(&mut command))
}

/// Default comparison.
const COMPARED: [&str; 4] =
    ["--scenes", "courtyard", "--techniques", "chroma,rates balanced,reuse,everything"];

/// Long checks: an application that starts and ends over and over, one that makes and destroys all that it draws to, or listening for an hour.
pub fn soak(arguments: &[String]) -> Result<(), String> {
    let (program, arguments) = match arguments {
        [first, rest @ ..] if first == "sound" => ("parafovea-soak-sound", rest),
        [first, rest @ ..] if first == "churn" => ("parafovea-soak-churn", rest),
        all => ("parafovea-soak", all),
    };
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    build(&mut steps)?;
    steps.run("soak", Command::new(profile_folder()?.join(program)).args(arguments))
}

/// Packages for users: a release build, packed.
pub fn dist(arguments: &[String]) -> Result<(), String> {
    if let Some(extra) = arguments.first() {
        return Err(format!("`dist` accepts no arguments; unexpected: `{extra}`"));
    }
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    build_package(&mut steps)?;
    steps.run(
        "cargo build",
        in_root(cargo().args(["build", "--locked", "-p", "parafovea-tests", "--bin", "parafovea-dist"])),
    )?;
    let folder = profile_folder()?;
    let target = folder.parent().ok_or("the target folder is not known")?;
    let pack = folder.join("parafovea-dist");
    let paths = [target.join("release"), ".".into(), target.join("dist")];
    steps.run("dist", in_root(Command::new(pack).args(paths)))
}

fn bench_names() -> String {
    let mut names = BENCHES.map(|(name, _)| name).to_vec();
    names.push(GATE);
    names.sort_unstable();
    names.join(", ")
}

/// Every library and program, so that the end-to-end programs find them beside themselves.
pub fn build(steps: &mut Steps) -> Result<(), String> {
    // The library that counts allocations is an example.
    let targets = ["--lib", "--bins", "--examples"];
    steps.run("cargo build", in_root(workspace("build").args(targets)))
}

/// A cargo command for all packages that can be built here.
pub fn workspace(command: &str) -> Command {
    let mut cargo = cargo();
    cargo.args([command, "--locked", "--workspace"]);
    if !can_build_audio() {
        AUDIO.iter().for_each(|package| _ = cargo.args(["--exclude", package]));
    }
    cargo
}

/// Has a command run in the repository's root.
pub fn in_root(command: &mut Command) -> &mut Command {
    command.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
}
