//! `cargo dev <task>`: the one tool for everyone who works on Parafovea. `cargo dev help` lists the tasks.
//!
//! Only the standard library is used here and in `parafovea-trial`, so that the tool itself is built within a second or two; whatever
//! needs more (the demo, the benches) is a program of the `parafovea-tests` package that a task builds and
//! runs. Everything is written below the target folder.

mod archive;
mod building;
mod compare;
mod drivers;
mod engines;
mod meter;
mod monado;
mod packages;
mod sanitize;
mod setup;
mod steps;
mod suite;
mod tasks;
mod unpack;

use std::process::ExitCode;

const HELP: &str = "\
cargo dev <task>, run anywhere in the repository:

  setup                 install missing programs and libraries (Debian and Ubuntu; elsewhere: name them). Every task does this first
  demo [--json]         our scene, a style of the zoo and unmodified hello_xr with the default preset and without the layer, while the
                        gaze moves: CPU time, shaded samples, errors and the layer's decisions; pictures in target/demo/. Installs
                        and builds only what it runs
  test [--strict] [PART]
                        formatting, clippy, build, docs, all tests: the checks of CI; with PART, only the build and the tests with this in their
                        names. Each test is a process of its own, which is killed after 10 minutes. A test that needs something that is not
                        here is skipped, and listed with its reason; with --strict, or the variable CI, it fails if `setup` should have
                        installed that
  drivers [--json] [PART] | --profiles
                        run programs on Mesa's real drivers (RADV, NVK, Turnip) over no-op kernel shims, without a GPU: programs x other
                        layers x configurations, or the cells with PART in `DEVICE PROGRAM`. --profiles writes the drivers' shading-rate
                        capabilities to tests/layers/profiles/
  engines [--json] [--turns N] [--scale PERCENT] [PART]
                        as root: run Godot of Debian sid with each of its renderers on Monado and lavapipe, in target/engines/, with the
                        layer and without, or those with PART in their names: engaged passes, CPU time, samples, validation messages
  run [--runtime mock|system] [--config FILE] -- CMD...
                        run any OpenXR program with the layer (default: the mock runtime on lavapipe)
  zoo [STYLE]           run every style of rendering at full length, on both backends, under validation; `test` runs a share
  faults [--validated] [PART]
                        run the whole fault matrix, call by fault by technique, or the cells with PART in their names; `test` runs a
                        share. --validated adds synchronization validation
  fuzz [TARGET] [--minutes N]
                        fuzz the readers of files, chains and shaders, a minute or N minutes each; `test` runs a few thousand inputs
  gpu [--json]          compare the layer's rates with an application's own rates on a GPU with VK_KHR_fragment_shading_rate: pictures and
                        GPU time, kept in tests/gpu-results/; then the matrix of `drivers`
  bench NAME [--json]   run a bench:
                        break-even (pixel cost from which the layer gains), ears (cost and latency of sound capture),
                        frame (savings of each technique), kernels (cost per view of rates by contrast, and of chroma attenuation),
                        models (cost and accuracy of the models), rails (shading and loss of contrast while the eyes move), reuse (errors of re-use as the head turns),
                        overhead (cost of the layer; --driver NAME [CASE...]: on one of Mesa's real drivers, release build),
                        status (cost of parafovea status)
  bench --compare REV [ARGUMENTS]
                        run the bench `frame` with this tree and with a commit, alternating: ratios with their spread
  monado [PART]         as root, with debootstrap: run hello_xr, our scene and every style on Monado in a Debian trixie in
                        target/monado/, with the layer and without
  dist                  pack a release build in target/dist/: an archive with an installer, and a Debian package
  report [--quick | --all] [--json]
                        measure speed against error, beside the alternatives of users: a page, tables and plots in target/report/; an
                        hour, 5 minutes with --quick, longer with --all
  sanitize [address | miri | thread]
                        check unsafe code with a nightly toolchain, if one is installed
  sequences [COUNT]     run 100000, or COUNT, random sequences of OpenXR calls with and without the layer, hostile sequences, and random
                        Vulkan recordings
  soak [--minutes N]    start and end an application for half an hour, or N minutes: memory must not grow
  soak ears [--seconds N]
                        capture sound for an hour, or N seconds: memory must not grow
  help                  print this text
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let rest = arguments.get(1..).unwrap_or_default();
    let outcome = match arguments.first().map(String::as_str) {
        Some("setup") => setup::setup(setup::Voice::Asked),
        Some("demo") => tasks::demo(rest),
        Some("test") => tasks::test(rest),
        Some("run") => tasks::run(rest),
        Some("zoo") => tasks::zoo(rest),
        Some("faults") => tasks::faults(rest),
        Some("drivers") => drivers::drivers(rest),
        Some("engines") => engines::engines(rest),
        Some("fuzz") => tasks::fuzz(rest),
        Some("gpu") => tasks::gpu(rest),
        Some("bench") => tasks::bench(rest),
        Some("monado") => monado::monado(rest),
        Some("report") => tasks::report(rest),
        Some("sanitize") => sanitize::sanitize(rest),
        Some("sequences") => tasks::sequences(rest),
        Some("soak") => tasks::soak(rest),
        Some("dist") => tasks::dist(rest),
        Some("help" | "--help" | "-h") | None => {
            print!("{HELP}");
            Ok(())
        }
        Some(other) => Err(format!("no task `{other}`; cargo dev help lists the tasks")),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("cargo dev: failed: {reason}");
            ExitCode::FAILURE
        }
    }
}
