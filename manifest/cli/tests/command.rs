//! The command as a user runs it.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// Runs the command with `home` as the only folder that it knows.
fn parafovea(home: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_parafovea"))
        .args(arguments)
        .env_clear()
        .env("PATH", "/usr/bin:/bin")
        .env("HOME", home)
        .current_dir(home)
        .output()
        .unwrap()
}

fn printed(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn complained(output: &Output) -> String {
    assert!(!output.status.success());
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn installs_says_so_and_uninstalls() {
    let home = TempDir::new().unwrap();
    let names =
        "parafovea_xrNegotiateLoaderApiLayerInterface parafovea_vkNegotiateLoaderLayerInterfaceVersion";
    fs::write(home.path().join("built.so"), format!("\u{7f}ELF {names}")).unwrap();
    let manifest = home.path().join(".local/share/vulkan/implicit_layer.d/parafovea.json");

    let would = printed(&parafovea(home.path(), &["install", "--dry-run", "--library", "built.so"]));
    assert_eq!(would.lines().filter(|line| line.starts_with("would ")).count(), 3, "{would}");
    assert!(!home.path().join(".local").exists());

    let done = printed(&parafovea(home.path(), &["install", "--library", "built.so"]));
    assert_eq!(done, would.replace("would ", ""));
    assert!(manifest.exists());
    let again = parafovea(home.path(), &["install", "--library", "built.so"]);
    assert_eq!(printed(&again), "already installed\n");

    let would = printed(&parafovea(home.path(), &["uninstall", "--dry-run"]));
    assert!(manifest.exists());
    assert_eq!(printed(&parafovea(home.path(), &["uninstall"])), would.replace("would ", ""));
    assert!(!manifest.exists());
    assert_eq!(printed(&parafovea(home.path(), &["uninstall"])), "not installed\n");
}

#[test]
fn a_failed_installation_says_why() {
    let home = TempDir::new().unwrap();
    let missing = parafovea(home.path(), &["install", "--library", "missing.so"]);
    assert_eq!(complained(&missing), "parafovea: missing.so: No such file or directory (os error 2)\n");
    let homeless = parafovea(Path::new("."), &["uninstall"]);
    assert!(complained(&homeless).starts_with("parafovea: neither XDG_DATA_HOME nor HOME"));
}

#[test]
fn run_sets_the_variable_and_exits_as_the_application_does() {
    let home = TempDir::new().unwrap();
    let script = "echo $PARAFOVEA \"$@\"; exit 7";
    let output = parafovea(home.path(), &["run", "--", "sh", "-c", script, "sh", "-x", "a b"]);
    assert_eq!((printed(&output).as_str(), output.status.code()), ("1 -x a b\n", Some(7)));
    assert_eq!(parafovea(home.path(), &["run", "--", "no-such-program"]).status.code(), Some(127));
    assert_eq!(parafovea(home.path(), &["run", "--", "/"]).status.code(), Some(126));
}

#[test]
fn validate_tells_each_error_in_a_line() {
    let home = TempDir::new().unwrap();
    let default = printed(&parafovea(home.path(), &["config", "default"]));
    fs::write(home.path().join("good.toml"), default).unwrap();
    let good = parafovea(home.path(), &["config", "validate", "good.toml"]);
    assert_eq!((printed(&good).as_str(), good.status.code()), ("good.toml: valid\n", Some(0)));

    fs::write(home.path().join("bad.toml"), "[chroma]\nmode = 'on'\nrim = 1\n").unwrap();
    let bad = parafovea(home.path(), &["config", "validate", "bad.toml"]);
    assert_eq!(
        complained(&bad),
        "bad.toml: line 2: chroma.mode = 'on' is not allowed; allowed: \"off\", \"default\" or \"paper\"\n\
         bad.toml: line 3: unknown key chroma.rim; did you mean chroma.rim_fade?\n"
    );
}

#[test]
fn fit_prints_coefficients_or_what_is_wrong_with_the_study() {
    let home = TempDir::new().unwrap();
    // Scores that a = 0.05, b = 0.45, c = 0.19, d = 3.63 give.
    let rows = (0..12).map(|i| {
        let (loudness, kilomel, loss) =
            (f64::from(i * 2), 1.0 + f64::from(i % 5) * 0.25, f64::from(i * 7 % 12) * 1e3);
        let mu = 0.05 * loudness + 0.45 / kilomel - 0.19 * loss / 1e4 + 3.63;
        format!("{loudness},{kilomel},{loss},{mu}\n")
    });
    let study = format!("gamma_ld,gamma_fq,gamma_vis,mu\n{}", rows.collect::<String>());
    fs::write(home.path().join("study.csv"), study).unwrap();
    let found = printed(&parafovea(home.path(), &["fit", "study.csv"]));
    for line in ["a = 0.0500 ", "b = 0.4500 ", "c = 0.1900 ", "d = 3.6300 ", "# 12 rows"] {
        assert!(found.lines().any(|found| found.starts_with(line)), "{line} in\n{found}");
    }
    fs::write(home.path().join("study.csv"), "gamma_ld,gamma_fq,mu\n1,1,4\n").unwrap();
    let wrong = complained(&parafovea(home.path(), &["fit", "study.csv"]));
    assert!(wrong.starts_with("parafovea: study.csv: line 1: there is no column gamma_vis"), "{wrong}");
    assert!(complained(&parafovea(home.path(), &["fit", "none.csv"])).contains("No such file"));
}
