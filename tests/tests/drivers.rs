//! Programs with the layer as the only layer above Mesa's real drivers: any layer below ours hides how the loader ends a
//! chain of calls. A share of `cargo dev drivers`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use libtest_mimic::{Arguments, Completion, Failed, Trial};
use parafovea_test_layers::{ShadingRateDevice, ShadingRateProfile};
use parafovea_tests::drivers::profiles::{QUERIED, shading_rates};
use parafovea_tests::drivers::{Cell, Folder, Mode, Program, Row, ShimDevice, Stack, Target, judge};
use parafovea_tests::installation::Driver;
use parafovea_tests::overhead::{Effort, planning};
use parafovea_trial::Lack;
use std::process::ExitCode;

/// RDNA 1, without rates; RDNA 2; RDNA 3.
const DEVICES: [ShimDevice; 3] = [ShimDevice::Navi10, ShimDevice::Navi21, ShimDevice::Navi31];

/// Styles that begin passes, make pipelines and record draws in different ways.
const STYLES: [&str; 9] = [
    "render-pass",
    "dynamic-rendering",
    "multiview",
    "imageless",
    "msaa-resolve",
    "proton",
    "secondaries",
    "shader-objects",
    "subpasses",
];

const MODES: [Mode; 4] = [Mode::Off, Mode::Inert, Mode::Rates, Mode::Everything];

fn main() -> ExitCode {
    let trials = DEVICES.into_iter().flat_map(|device| {
        let of = move |program: Program| {
            trial(format!("{} on {}", program.name(), device.name()), move || check(device, program))
        };
        programs().into_iter().map(of).collect::<Vec<_>>()
    });
    let profiles = QUERIED.into_iter().filter(|(_, device)| device.folder() == Folder::Release);
    let profiles = profiles.map(|(profile, device)| {
        trial(format!("the profile {} is of the driver", profile.name()), move || {
            check_profile(profile, device)
        })
    });
    let profiles = profiles.chain([trial("the bench of planning runs".to_owned(), check_bench)]);
    libtest_mimic::run(&Arguments::from_args(), trials.chain(profiles).collect()).exit_code()
}

/// A trial that is ignored without the drivers.
fn trial(name: String, check: impl FnOnce() -> Result<(), Failed> + Send + 'static) -> Trial {
    Trial::ignorable_test(name, || match Folder::Release.path() {
        Ok(_) => check().map(|()| Completion::Completed),
        // `cargo dev` unpacks them on this release alone.
        Err(error) if is_bookworm() => Ok(Completion::ignored_with(Lack::setup(error))),
        Err(error) => Ok(Completion::ignored_with(Lack::machine(error))),
    })
}

fn is_bookworm() -> bool {
    let text = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
    text.lines().any(|line| line == "ID=debian") && text.contains("VERSION_CODENAME=bookworm")
}

fn programs() -> Vec<Program> {
    let is_wanted = |program: &Program| match program {
        Program::Style(style) => STYLES.contains(&style.name),
        Program::VulkanInfo | Program::HelloXr(_) | Program::Scene => true,
        Program::Doctor | Program::Direct3d(_) | Program::Quick3d(_) => false,
    };
    Program::all().into_iter().filter(is_wanted).collect()
}

fn check(device: ShimDevice, program: Program) -> Result<(), Failed> {
    let cells = MODES.map(|mode| Cell { stack: Stack::Alone, mode });
    let row = judge(&Target::Shim(device), program, &cells)?;
    assert_eq!((&row.refusal, row.left_out.as_slice()), (&None, &[][..]));
    assert_eq!(row.runs.len(), cells.len());
    let faults: Vec<_> = row.runs.iter().filter(|run| run.is_fault()).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    if device.has_rates() && program.has_frames() {
        assert_eq!(engaged(&row), Some("rates"));
    }
    Ok(())
}

/// `cargo dev bench overhead --driver`, as short as can be.
fn check_bench() -> Result<(), Failed> {
    let driver = Driver::Shim(ShimDevice::Navi31);
    let cases = ["rates", "everything"].map(str::to_owned);
    let added = planning("navi31", &cases, Effort::LEAST, |run| run.driver(driver))?;
    let found: Vec<_> = added.iter().map(|added| (added.pace, added.case)).collect();
    let expected = ["back to back", "90 Hz"].map(|pace| [(pace, "rates"), (pace, "everything")]);
    assert_eq!(found, expected.concat());
    assert!(added.iter().all(|added| added.value.is_finite() && added.p99.is_finite()), "{added:?}");
    Ok(())
}

/// The emulating layer has the driver's limits. Versions of one release differ in fixes only.
fn check_profile(profile: ShadingRateProfile, device: ShimDevice) -> Result<(), Failed> {
    let found = shading_rates(device)?;
    let kept = ShadingRateDevice { driver: found.driver.clone(), ..profile.device().clone() };
    assert_eq!(found, kept, "`cargo dev drivers --profiles` writes it anew");
    Ok(())
}

/// The layer's effect in cells with rates.
fn engaged(row: &Row) -> Option<&'static str> {
    row.runs.iter().find(|run| run.mode == Mode::Rates.name())?.engaged
}
