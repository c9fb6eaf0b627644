//! `cargo dev <task>`: the one tool for everyone who works on Parafovea. `cargo dev help` lists the tasks.
//!
//! Only the standard library is used here and in the library of this package, so that the tool itself is built within a second or two; anything
//! with more dependencies (the demo, the benches) is a program of the `parafovea-tests` package that a task builds and runs.
//! Everything is written below the target folder.

mod archive;
mod building;
mod compare;
mod drivers;
mod engines;
mod meter;
mod monado;
mod packages;
mod release;
mod sanitize;
mod setup;
mod steps;
mod suite;
mod tasks;
mod unpack;

use std::process::ExitCode;

const HELP: &str = "\
Usage: cargo dev TASK, in any folder of the repository

  setup                 install missing programs and libraries (on Debian and Ubuntu; on other systems, name them). Every other task
                        except `bench gate` does this first
  demo [--json] [APPLICATION ...]
                        run three applications, or only the named ones, without the layer and with its default preset, while the
                        gaze moves: courtyard (our test scene), render-pass (a rendering style of the zoo) and hello_xr (unmodified).
                        Prints CPU time, shaded samples, errors and the decisions of the layer; writes pictures to target/demo/.
                        Installs and builds only its own dependencies
  test [--strict] [PART]
                        run the checks of CI: formatting, clippy, build, documentation and all tests; with PART, only the build, and tests
                        with PART in their names. Each test runs in its own process, with a time limit of 30 minutes; unit tests share
                        processes. The longest tests of the last run come first. Tests whose requirements are missing are skipped, and
                        listed with the reason; with --strict, or if the variable CI is set, they fail if `setup` should have installed
                        the requirement
  drivers [--json] [PART] | --profiles
                        run programs on Mesa's hardware drivers (RADV, NVK, Turnip) with no-op kernel shims, without a GPU: all combinations of
                        programs, other layers and configurations, or those with PART in `DEVICE PROGRAM`. --profiles writes the
                        shading-rate capabilities of the drivers to tests/layers/profiles/
  engines [--json] [--turns N] [--scale PERCENT] [PART]
                        run Godot and Qt Quick 3D XR from Debian sid, or the variants with PART in their names, on Monado and
                        lavapipe, with and without the layer: engaged passes, CPU time, samples, validation messages. Works in
                        target/engines/; needs root
  run [--runtime mock|system] [--config FILE] -- CMD...
                        run any OpenXR program with the layer, on the mock runtime and lavapipe (the default), or on the runtime and
                        driver of this system
  zoo [STYLE]           run every rendering style at full length, on both backends, with validation; `test` runs a part
  faults [--validated] [PART]
                        run the whole fault matrix (calls, faults and techniques), or the cells with PART in their names; `test` runs a part.
                        --validated adds synchronization validation
  fuzz [TARGET] [--minutes N]
                        fuzz the parsers of files, structure chains and shaders, for one minute or N minutes each; `test` runs a few thousand
                        inputs
  gpu [--json]          compare the layer's shading rates with an application's own rates, on a GPU with VK_KHR_fragment_shading_rate: images
                        and GPU time, written to tests/gpu-results/; then run the matrix of `drivers`
  bench NAME [--json]   run a benchmark:
                        break-even (pixel cost above which the layer saves time),
                        budget (shading and loss of methods that choose rates),
                        detail (errors of foliage and histories, by rule, at rest and after a gaze step),
                        frame (saving of each technique),
                        gate (decisions of the benefit gate on simulated applications),
                        gaze (errors of the predicted gaze),
                        kernels (cost per view of audio-visual rates and of chroma attenuation),
                        models (cost and accuracy of the models),
                        overhead (cost of the layer; with --driver NAME [CASE...], on one of Mesa's hardware drivers, or on this
                        machine's GPU with --driver gpu, with a release build),
                        planted (decisions of the benefit gate on a rendering style whose frames have planted costs),
                        recognition (precision and recall on frame graphs of engines),
                        reuse (errors of temporal re-use during head rotation),
                        safety (shading and loss of contrast while the eyes move),
                        sound (cost and latency of sound capture),
                        status (cost of `parafovea status`)
  bench --compare REV [ARGUMENTS]
                        run the benchmark `frame` on the working tree and on commit REV, in turns: ratios with their spread
  monado [PART]         run hello_xr, our test scene and every rendering style on Monado, with and without the layer, on a Debian trixie
                        system in target/monado/, and hello_xr with OSC packets of an eye tracker (PART gaze: alone); needs root and
                        debootstrap, which it installs on Debian and Ubuntu
  dist                  write a release build to target/dist/, as an archive with an installer and as a Debian package
  report [--quick | --all] [--json]
                        measure speed against error, compared with the alternatives of users: a web page, tables and plots in
                        target/report/. Takes an hour and a half, 5 minutes with --quick, longer with --all
  sanitize [address | miri | thread]
                        check unsafe code, if a nightly toolchain is installed
  sequences [COUNT]     run 100000, or COUNT, random sequences of OpenXR calls with and without the layer, hostile sequences, and random
                        Vulkan command buffers
  soak [--minutes N]    start and end an application repeatedly for half an hour, or N minutes: memory must not grow
  soak churn [--minutes N] [STYLE]
                        start and end sessions that make and destroy all that they draw to, at changing sizes, with every technique on, for an hour,
                        or N minutes, in many rendering styles or one: the layer's memory and objects must not grow
  soak sound [--seconds N]
                        capture sound for an hour, or N seconds: memory must not grow
  help                  print this help
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
        Some(other) => Err(format!("unknown task `{other}`; to list all tasks: cargo dev help")),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("cargo dev: failed: {reason}");
            ExitCode::FAILURE
        }
    }
}
