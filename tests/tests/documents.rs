//! Commands in README, guide and the other texts exist, and accept their arguments. Cheap commands are run here or by the tests of the
//! guide, the installer and the mock runtime; only the names of builds, benches and reports are checked.

use parafovea_tests::artifacts::program;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

const TEXTS: [&str; 11] = [
    "README.md",
    "CONTRIBUTING.md",
    "manifest/GUIDE.md",
    "manifest/HOW-IT-WORKS.md",
    "core/README.md",
    "tests/baselines/drivers.md",
    "tests/baselines/figures.md",
    "tests/models/src/errors/README.md",
    "tests/report/README.md",
    "tests/runtime/README.md",
    "tests/scene/README.md",
];

/// The commands that a text names: in a line of their own, or between backticks, which may go over the end of a line.
fn commands(text: &str) -> Vec<String> {
    let is_ours = |command: &str| command.starts_with("cargo ") || command.starts_with("parafovea ");
    let lines = text.lines().filter_map(|line| line.strip_prefix("    ").or(line.strip_prefix("$ ")));
    let lines = lines.map(|line| line.split(" #").next().unwrap_or_default().trim());
    let outside_of_boxes: Vec<&str> = text.split("```").step_by(2).collect();
    let inline = outside_of_boxes.join("\n");
    let inline = inline.split('`').skip(1).step_by(2);
    let all = lines.chain(inline).map(|command| command.split_whitespace().collect::<Vec<_>>().join(" "));
    all.filter(|command| is_ours(command)).collect()
}

/// Output of `parafovea` for these arguments.
fn parafovea(arguments: &[&str]) -> String {
    let output = Command::new(program("parafovea").unwrap()).args(arguments).output().unwrap();
    String::from_utf8(output.stdout).unwrap()
}

/// Names of the workspace's packages.
fn packages() -> Vec<String> {
    fn below(folder: &Path, found: &mut Vec<String>) {
        for entry in fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            let name = entry.file_name();
            if path.is_dir()
                && !["target", "src"].iter().any(|other| name == *other)
                && !name.to_string_lossy().starts_with('.')
            {
                below(&path, found);
            } else if name == "Cargo.toml" {
                let manifest: toml::Table = fs::read_to_string(&path).unwrap().parse().unwrap();
                let package = manifest.get("package").and_then(|package| package.get("name"));
                found.extend(package.and_then(|name| name.as_str()).map(str::to_owned));
            }
        }
    }
    let mut found = Vec::new();
    ["core", "layer", "manifest", "tests"].iter().for_each(|folder| below(&root().join(folder), &mut found));
    found
}

/// The sources of a bench and of its arguments' parser.
fn sources_of(task: &str) -> String {
    let files: &[&str] = match task {
        "report" => &["tests/report/src/main.rs", "tests/report/src/plan.rs"],
        "demo" => &["tests/src/bin/parafovea-demo.rs"],
        "drivers" => &["tests/src/bin/parafovea-drivers.rs"],
        "engines" => &["tests/src/bin/parafovea-engines.rs"],
        "run" => &["tests/src/bin/parafovea-run.rs"],
        "break-even" => &["tests/benches/break_even.rs"],
        "models" => &["tests/models/benches/models.rs"],
        "safety" => &["tests/models/benches/safety.rs"],
        "kernels" => &["layer/benches/kernels/main.rs"],
        other => return read(&format!("tests/benches/{other}.rs")),
    };
    files.iter().map(|file| read(file)).collect()
}

fn assert_cargo(command: &str, packages: &[String]) {
    let words: Vec<&str> = command.split(' ').collect();
    if words[1] == "dev" {
        let help = read("tests/dev/src/main.rs");
        let task = words[2];
        assert!(help.contains(&format!("\n  {task} ")), "{command}: no task {task}");
        let task = if task == "bench" { words[3] } else { task };
        if words[2] == "bench" {
            assert!(help.contains(&format!("{task} (")), "{command}: no bench {task}");
        }
        let own = words.iter().take_while(|word| **word != "--");
        for option in own.filter(|word| word.starts_with("--")) {
            let sources = sources_of(task);
            // As text, or as the field that clap makes it of.
            let field = format!("{}: ", option.trim_start_matches('-').replace('-', "_"));
            assert!(
                sources.contains(option) || sources.contains(&field),
                "{command}: {task} knows no {option}"
            );
        }
        return;
    }
    assert!(["build", "test", "doc", "run", "rustc"].contains(&words[1]), "{command}");
    for pair in words.windows(2) {
        match pair {
            ["-p", name] => assert!(packages.iter().any(|package| package == name), "{command}: no {name}"),
            ["main", filter] => {
                let module = filter.trim_end_matches("::");
                assert!(
                    read("tests/tests/main.rs").contains(&format!("mod {module};")),
                    "{command}: no {module}"
                );
            }
            ["--example", name] => {
                let package = words.iter().skip_while(|word| **word != "-p").nth(1).unwrap();
                let folder = package.trim_start_matches("parafovea-");
                let example = root().join(format!("tests/{folder}/examples/{name}.rs"));
                assert!(example.is_file(), "{command}: no example {name}");
            }
            _ => {}
        }
    }
}

#[test]
fn commands_of_all_texts_are_there() {
    let (packages, help) = (packages(), parafovea(&["--help"]));
    let mut checked = 0;
    for text in TEXTS {
        for command in commands(&read(text)) {
            if command.contains("<task>") || command.contains("NAME") && command.starts_with("cargo dev") {
                continue;
            }
            checked += 1;
            if command.starts_with("cargo ") {
                assert_cargo(&command, &packages);
                continue;
            }
            let words: Vec<&str> = command.split(' ').collect();
            assert!(help.contains(&format!("\n  {} ", words[1])), "{text}: {command}");
            let own = words.iter().take_while(|word| **word != "--");
            let of_command = parafovea(&[words[1], "--help"]);
            for option in own.filter(|word| word.starts_with("--")) {
                let is_nested = words.get(2).is_some_and(|nested| {
                    !nested.starts_with('-') && parafovea(&[words[1], nested, "--help"]).contains(option)
                });
                assert!(of_command.contains(option) || is_nested, "{text}: {command}: no {option}");
            }
        }
    }
    assert!(checked > 50, "{checked} commands");
}
