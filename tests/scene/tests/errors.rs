//! Error messages of the command.

#![expect(clippy::unwrap_used, reason = "a test says where it failed")]

use std::process::{Command, Output};

fn scene(arguments: &[&str], variables: &[(&str, &str)]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_parafovea-scene"))
        .args(arguments)
        .envs(variables.iter().copied())
        .output()
        .unwrap()
}

fn assert_fails(output: &Output, with: &str) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success(), "it ended well: {text}");
    assert!(text.contains(with), "expected {with:?} in: {text}");
}

#[test]
fn no_runtime() {
    assert_fails(&scene(&[], &[("XR_RUNTIME_JSON", "/nonexistent/runtime.json")]), "no OpenXR runtime");
}

#[test]
fn wrong_options() {
    assert_fails(&scene(&["--lights", "300"], &[]), "0..=256");
    assert_fails(&scene(&["--size", "12"], &[]), "expected WxH");
    assert_fails(&scene(&["--frames", "0"], &[]), "--frames");
}
