//! The switch that validates across submits is needed, and works.

use crate::process::Process;
use parafovea_test_layers::validation::{ACROSS_SUBMITS, SYNCHRONIZATION, VALIDATION_LAYER, environment};

#[test]
fn a_hazard_across_submits_is_found_with_the_settings() {
    let findings = Process::new("hazard_across_submits").validated().run().findings;
    assert!(findings.iter().any(|line| line.contains("SYNC-HAZARD-READ-AFTER-WRITE")), "{findings:?}");
}

#[test]
fn a_hazard_across_submits_is_found_with_the_variables() {
    let [(variable, value)] = environment();
    let output = run_with(variable, &value);
    assert!(output.contains("SYNC-HAZARD-READ-AFTER-WRITE"), "{output}");
}

/// If this fails, the validation layer checks across submits by itself, and [`ACROSS_SUBMITS`] can go.
#[test]
fn it_is_not_found_without_the_switch() {
    let output = run_with("VK_LAYER_ENABLES", SYNCHRONIZATION);
    assert!(!output.contains("SYNC-HAZARD"), "{ACROSS_SUBMITS} is not needed: {output}");
}

fn run_with(variable: &str, value: &str) -> String {
    Process::new("hazard_across_submits").layer(VALIDATION_LAYER).env(variable, value).run().output
}
