//! Instructions of the mock runtime's README for other projects' CI work.

use parafovea_tests::artifacts::{Library, program, system_program};
use parafovea_trial::{Lack, skip};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const README: &str = include_str!("../runtime/README.md");

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The words of the step that runs a program, as a shell would have them.
fn step() -> Vec<String> {
    let lines = README.lines().skip_while(|line| !line.trim_start().starts_with("sh parafovea/"));
    let of_step = lines.take_while(|line| !line.trim_start().starts_with("- "));
    of_step.flat_map(str::split_whitespace).map(str::to_owned).collect()
}

/// Runs the step in a new folder, with another program if one is given.
fn run(other: Option<&[&str]>) -> (Output, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let library = Library::MockRuntime.path().unwrap();
    let mut words: Vec<String> = step();
    assert_eq!(words.len(), 8, "{words:?}");
    for word in &mut words {
        if word.ends_with("libparafovea_mock_runtime.so") {
            *word = library.display().to_string();
        } else if let Some(path) = word.strip_prefix("parafovea/") {
            *word = repository().join(path).canonicalize().unwrap().display().to_string();
        }
    }
    if let Some(other) = other {
        words.truncate(5);
        words.extend(other.iter().map(|word| (*word).to_owned()));
    }
    let mut command = Command::new(&words[0]);
    command.args(&words[1..]).current_dir(folder.path());
    (command.output().unwrap(), folder)
}

#[test]
fn the_quick_start_works_as_it_stands() {
    if system_program("hello_xr").is_err() {
        skip(&Lack::setup("hello_xr"));
    }
    let commands = README.split("```sh\n").nth(1).unwrap().split("```").next().unwrap();
    let library = Library::MockRuntime.path().unwrap();
    // The runtime is built already.
    let commands = commands
        .replace("cargo build -p parafovea-mock-runtime\n", "set -e\n")
        .replace("$PWD/target/debug/libparafovea_mock_runtime.so", library.to_str().unwrap());
    assert!(commands.contains("set -e") && commands.contains(library.to_str().unwrap()), "{commands}");
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new("sh").arg("-c").arg(&commands).current_dir(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    for file in ["record.jsonl", "eye0_50.png", "eye1_50.png", "submitted_0_0_50.png"] {
        assert!(folder.path().join("out").join(file).is_file() && said.contains(file), "{file}: {said}");
    }
}

#[test]
fn an_application_that_keeps_the_rules_passes() {
    if system_program("hello_xr").is_err() {
        skip(&Lack::setup("hello_xr"));
    }
    let (output, folder) = run(None);
    let said =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.contains("90 frames"), "{said}");
    for picture in ["eye0_60.png", "eye1_60.png", "submitted_0_0_60.png"] {
        assert!(folder.path().join("headset/out").join(picture).is_file(), "{picture}\n{said}");
    }
}

#[test]
fn a_program_that_shows_nothing_or_fails_does_not_pass() {
    for other in [&["true"][..], &["false"]] {
        let (output, _folder) = run(Some(other));
        assert!(!output.status.success(), "{other:?}");
    }
}

#[test]
fn an_application_that_breaks_a_rule_does_not_pass() {
    let cases = program("parafovea-cases").unwrap().display().to_string();
    let (output, _folder) = run(Some(&[&cases, "rectangle_outside_the_image"]));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && said.contains("broke rules of the specification"), "{said}");
}
