//! Checks of unsafe code with a nightly toolchain: Miri, and the address and thread sanitizers, as far as they are installed.

use crate::setup::{Voice, setup};
use crate::steps::Steps;
use crate::tasks::in_root;
use std::path::Path;
use std::process::{Command, Stdio};

/// Crates for Miri: crates of pure functions, and the layer's own reading of C structures. It knows no files of loaders, no devices, and
/// not the register by which loudness is measured without denormal numbers.
const MIRI: [&[&str]; 3] = [
    &["parafovea-core", "--", "--skip", "audio::"],
    &["parafovea-manifest"],
    &["parafovea-layer", "--", "abi::", "vk::rates::copies"],
];

/// Files and clocks are the host's, and floating point is as the processor has it: Miri would else be off by a few units in the last place.
const MIRI_FLAGS: &str = "-Zmiri-disable-isolation -Zmiri-deterministic-floats";

/// Runs all installed tools; a missing tool is named, and is not a failure.
pub fn sanitize(arguments: &[String]) -> Result<(), String> {
    let all = ["address", "miri", "thread"];
    let wanted = match arguments {
        [] => &all[..],
        [one] if all.contains(&one.as_str()) => &[one.as_str()][..],
        _ => return Err(format!("usage: cargo dev sanitize [{}]", all.join(" | "))),
    };
    setup(Voice::Implied)?;
    let Some(nightly) = Nightly::found() else {
        println!("skipped: no nightly toolchain");
        return Ok(());
    };
    let mut steps = Steps::default();
    for check in wanted {
        match *check {
            "miri" if !nightly.has_miri => println!("skipped: the nightly toolchain has no miri"),
            "miri" => miri(&mut steps)?,
            "thread" if !nightly.has_source => {
                println!("skipped: the thread sanitizer needs the nightly toolchain's rust-src");
            }
            "thread" => nightly.sanitizer(&mut steps, "thread", &["-Zbuild-std"])?,
            _ => nightly.sanitizer(&mut steps, "address", &[])?,
        }
    }
    steps.summary();
    Ok(())
}

/// A nightly toolchain with its components.
struct Nightly {
    host: String,
    has_miri: bool,
    has_source: bool,
}

impl Nightly {
    fn found() -> Option<Self> {
        let version = said(&["rustc", "+nightly", "-vV"])?;
        let host = version.lines().find_map(|line| line.strip_prefix("host: "))?.to_owned();
        let root = said(&["rustc", "+nightly", "--print", "sysroot"])?;
        let source = Path::new(root.trim()).join("lib/rustlib/src/rust/library/std");
        let has_miri = said(&["cargo", "+nightly", "miri", "--version"]).is_some();
        Some(Self { host, has_miri, has_source: source.is_dir() })
    }

    /// The layer's unit tests, in which both halves run above stand-ins for runtime and driver.
    fn sanitizer(&self, steps: &mut Steps, name: &str, more: &[&str]) -> Result<(), String> {
        let mut command = nightly();
        command.args(["test", "--locked", "--package", "parafovea-layer", "--lib", "--target", &self.host]);
        command.args(more);
        command.args(["--target-dir", &format!("target/sanitize/{name}")]);
        command.env("RUSTFLAGS", format!("-Zsanitizer={name}"));
        // The stand-ins keep the allocations that loaders keep.
        command.env("ASAN_OPTIONS", "detect_leaks=0");
        steps.run(&format!("{name} sanitizer"), in_root(&mut command))
    }
}

fn miri(steps: &mut Steps) -> Result<(), String> {
    for arguments in MIRI {
        let mut command = nightly();
        command.args([
            "miri",
            "test",
            "--locked",
            "--target-dir",
            "target/sanitize/miri",
            "--lib",
            "--package",
        ]);
        // Properties are tried a few times only, as everything is slow there.
        command.args(arguments).env("MIRIFLAGS", MIRI_FLAGS).env("PROPTEST_CASES", "2");
        steps.run(&format!("miri {}", arguments[0]), in_root(&mut command))?;
    }
    Ok(())
}

/// rustup's cargo, which takes the toolchain's name; not the one that started us.
fn nightly() -> Command {
    let mut command = Command::new("cargo");
    command.arg("+nightly").env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO").env_remove("RUSTC");
    command
}

/// Output of a command; `None` if it fails.
fn said(command: &[&str]) -> Option<String> {
    let (program, arguments) = command.split_first()?;
    let mut command = Command::new(program);
    command.args(arguments).env_remove("RUSTUP_TOOLCHAIN").stderr(Stdio::null());
    let output = command.output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}
