//! `cargo dev gpu`, over the stand-in for a GPU: passes with the layer's rates equal the passes of an application that sets the same
//! rates itself. (That both look alike takes a real one.)

use parafovea_test_layers::ShadingRateProfile;
use parafovea_tests::artifacts::program;
use parafovea_tests::device::Machine;
use parafovea_tests::installation::Driver;
use parafovea_tests::native::{Length, Results, compare, styles, time};
use parafovea_trial::{Lack, skip};
use std::process::Command;

const SHORT: Length = Length { frames: 8, size: 96 };

/// One for each way in which rates get to a pass; `cargo dev gpu --over-emulator` has all.
const STYLES: [&str; 6] =
    ["render-pass", "dynamic-rendering", "multiview", "double-wide", "offscreen-tonemap", "proton"];

#[test]
fn the_layers_rates_are_those_that_an_application_would_set() {
    let styles = styles().filter(|style| STYLES.contains(&style.name));
    assert_eq!(styles.clone().count(), STYLES.len());
    for (profile, style) in ShadingRateProfile::ALL.into_iter().cycle().zip(styles) {
        let machine = Machine::over_stand_in(profile).unwrap();
        assert!(machine.device.is_cpu && machine.device.has_rate_attachments, "{:?}", machine.device);
        let compared = compare(&machine, style, SHORT).unwrap();
        let comparison = compared.unwrap_or_else(|lacking| panic!("{}: no {lacking}", style.name));
        assert_eq!(comparison.fault(false), None, "{} on {}: {comparison:#?}", style.name, profile.name());
    }
}

#[test]
fn times_are_taken_and_kept() {
    let machine = Machine::over_stand_in(ShadingRateProfile::NvkTuring).unwrap();
    let length = Length { frames: 20, size: 64 };
    let style = styles().next().unwrap();
    let times = time(&machine, style, length, 1).unwrap();
    for ms in [times.off_ms, times.layer_ms, times.native_ms, times.attached_ms] {
        assert!(ms > 0.0, "{times:?}");
    }
    let folder = tempfile::tempdir().unwrap();
    let results = Results::new(&machine, length);
    let path = results.write(folder.path()).unwrap();
    let read: Results = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert_eq!(read, results);
}

/// Skipped on a machine with a GPU with shading rates, which the program would measure.
#[test]
fn without_a_gpu_it_says_so() {
    let machine = Machine::of(Driver::System).unwrap();
    if !machine.device.is_cpu && machine.device.has_rate_attachments {
        skip(&Lack::machine("a device without VK_KHR_fragment_shading_rate"));
    }
    let output = Command::new(program("parafovea-gpu").unwrap()).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(said, "skipped: no device with VK_KHR_fragment_shading_rate\n");
}
