//! `cargo dev <task>`: the one tool for everyone who works on Parafovea. `cargo dev help` lists the tasks.
//!
//! Only the standard library is used here and in `parafovea-trial`, so that the tool itself is built within a second or two; whatever
//! needs more (the demo, the benches) is a program of the `parafovea-tests` package that a task builds and
//! runs. Everything is written below the target folder.

mod archive;
mod building;
mod compare;
mod drivers;
mod meter;
mod monado;
mod packages;
mod sanitize;
mod setup;
mod steps;
mod suite;
mod tasks;

use std::process::ExitCode;

const HELP: &str = "\
cargo dev <task>, run anywhere in the repository:

  setup                 install what is missing (Debian and Ubuntu; elsewhere: name it). Implied by every task
                        but for the drivers over kernel shims, which it unpacks to target/drivers/release and `test` needs
  demo [--json]         our scene, a style of the zoo and unmodified hello_xr with the default preset and without the layer, while the
                        gaze moves: CPU time, shaded samples, errors and the layer's decisions; pictures in target/demo/. Installs
                        and builds only what it runs
  test [--strict] [PART]
                        formatting, clippy, build, docs, all tests: what CI runs; with PART, only the build and the tests with this in their
                        names. Each test is a process of its own, which is killed after 10 minutes. A test that needs something that is not
                        here is skipped, and listed with its reason; with --strict, or the variable CI, it fails if `setup` should have
                        installed that
  drivers [--json] [PART] | --profiles
                        the layer on Mesa's real drivers over no-op kernel shims, without a GPU (RADV, NVK, Turnip; Debian's packages, unpacked
                        in target/drivers/): programs x other layers (none, validation, one above and one below) x configurations (off,
                        inert, rates, mask, everything), all with PART in `DEVICE PROGRAM`. Six styles, hello_xr, our scene, vulkaninfo
                        and the doctor in all combinations; other styles alone with rates and everything, and validated with everything. --profiles
                        writes what the drivers say of shading rates to tests/layers/profiles/, for the tests' stand-in
  run [--runtime mock|system] [--config FILE] -- CMD...
                        any OpenXR program with the layer (default: the mock runtime on lavapipe)
  zoo [STYLE]           every style of rendering at full length (256 x 256 pixels, 120 frames, with a still and a moving gaze, on both
                        backends, under validation), of which `test` runs a share
  faults [--validated] [PART]
                        the whole fault matrix, call by fault by technique, of which `test` runs a share; or the cells with this in their
                        names; --validated has synchronization validation below the layer
  fuzz [TARGET] [--minutes N]
                        mutated inputs for what reads files, chains and shaders, a minute each or so long; `test` runs a few thousand
  gpu [--json]          on a GPU with VK_KHR_fragment_shading_rate: the layer's rates beside the same ones set by the application itself, pictures and
                        GPU times; kept in tests/gpu-results/. Then the matrix of `drivers`. Without such a GPU it says so, and that is all
  bench NAME [--json]   a bench: break-even (how dear pixels must be for the layer to gain), ears (what listening costs, and how late it is), frame (what techniques save), kernels (what rates by contrast, and colour, cost a view), models (what the models cost, their hard cases, and how well gaze is followed), overhead (what the layer costs; --driver NAME [CASE...]: what it adds to a frame on one of Mesa's real drivers over a no-op kernel shim, release build), reuse (what pictures of a turning head lose), status (what parafovea status shows, and takes)
  monado [PART]         as root, with debootstrap: the passes' tests in a Debian trixie in target/monado/, with its driver and validation; then
                        hello_xr, our scene and every style on Monado there, with everything on and without the layer: the same results, and
                        no message more
  dist                  packs a release build, target/dist/: an archive with an installer, and a Debian package
  bench --compare REV [ARGUMENTS]
                        the layer as it is here beside that of a commit, by turns, in the bench `frame` with these arguments: ratios with their spread
  report [--quick | --all] [--json]
                        speed against error, against what users could do instead: a page, tables and plots in target/report/; --quick
                        takes 5 minutes, the whole an hour, and --all every point of every sweep (`report --help` lists more)
  sanitize [address | miri | thread]
                        what a nightly toolchain, where one is installed, finds out about unsafe code
  sequences [COUNT]     100000, or so many, random sequences of OpenXR calls with and without the layer, 1000 hostile ones, and 100
                        processes of 24 frames of random Vulkan recordings
  soak [--minutes N]    half an hour, or so long: an application that starts and ends over and over takes no more and more memory with the layer
  soak ears [--seconds N]
                        listening for an hour, or so long, takes no more and more memory
  help                  this text
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
        Some(other) => Err(format!("there is no task `{other}`; cargo dev help lists the tasks")),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("cargo dev: failed: {reason}");
            ExitCode::FAILURE
        }
    }
}
