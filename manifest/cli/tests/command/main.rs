//! The command as a user runs it.

#![allow(clippy::unwrap_used)]

mod profile;
mod status;

use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{Status, StatusFile};
use std::fs;
use std::os::unix::fs::PermissionsExt;
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

/// A home with a library that looks like the layer's, `built.so`.
fn home_with_library() -> TempDir {
    let home = TempDir::new().unwrap();
    let names =
        "parafovea_xrNegotiateLoaderApiLayerInterface parafovea_vkNegotiateLoaderLayerInterfaceVersion";
    fs::write(home.path().join("built.so"), format!("\u{7f}ELF {names}")).unwrap();
    home
}

/// By another process: one that this process still writes to, or a child of another test, cannot be run.
fn write_program(path: &Path, content: &str) {
    let write = ["-c", "printf %s \"$1\" > \"$0\" && chmod +x \"$0\""];
    assert!(Command::new("sh").args(write).arg(path).arg(content).status().unwrap().success());
}

#[test]
fn installs_says_so_and_uninstalls() {
    let home = home_with_library();
    let manifest = home.path().join(".local/share/vulkan/implicit_layer.d/parafovea.json");

    let would = printed(&parafovea(home.path(), &["install", "--dry-run", "--library", "built.so"]));
    assert_eq!(would.lines().filter(|line| line.starts_with("would ")).count(), 3, "{would}");
    assert!(!home.path().join(".local").exists());

    let done = printed(&parafovea(home.path(), &["install", "--library", "built.so"]));
    let steps = would.replace("would ", "");
    assert!(done.strip_prefix(&steps).is_some_and(|next| next.contains("parafovea doctor")), "{done}");
    assert!(manifest.exists());
    let again = parafovea(home.path(), &["install", "--library", "built.so"]);
    assert_eq!(printed(&again), "already installed\n");

    let would = printed(&parafovea(home.path(), &["uninstall", "--dry-run"]));
    assert!(manifest.exists());
    assert_eq!(printed(&parafovea(home.path(), &["uninstall"])), would.replace("would ", ""));
    assert!(!manifest.exists());
    assert_eq!(printed(&parafovea(home.path(), &["uninstall"])), "not installed\n");

    printed(&parafovea(home.path(), &["install", "--library", "built.so"]));
    fs::write(&manifest, "mine").unwrap();
    let removed = parafovea(home.path(), &["uninstall"]);
    let text = printed(&removed);
    assert!(removed.status.success() && text.lines().count() == 3, "{text}");
    assert!(text.contains(&format!("they were edited: {}", manifest.display())), "{text}");
}

#[test]
fn a_failed_installation_says_why() {
    let home = TempDir::new().unwrap();
    let missing = parafovea(home.path(), &["install", "--library", "missing.so"]);
    assert_eq!(complained(&missing), "parafovea: missing.so: No such file or directory (os error 2)\n");
    let homeless = parafovea(Path::new("."), &["uninstall"]);
    assert!(complained(&homeless).contains("neither XDG_DATA_HOME nor HOME is an absolute path; set HOME"));
}

#[test]
fn run_sets_the_variables_and_exits_as_the_application_does() {
    let home = TempDir::new().unwrap();
    let script = "echo $PARAFOVEA $VK_LOADER_LAYERS_ENABLE \"$@\"; exit 7";
    let output = parafovea(home.path(), &["run", "--", "sh", "-c", script, "sh", "-x", "a b"]);
    let expected = "1 VK_LAYER_PARAFOVEA_foveation -x a b\n";
    assert_eq!((printed(&output).as_str(), output.status.code()), (expected, Some(7)));
    let missing = parafovea(home.path(), &["run", "--", "no-such-program"]);
    assert_eq!(missing.status.code(), Some(127));
    let complained = complained(&missing);
    assert!(complained.contains("no-such-program: not found in PATH"), "{complained}");
    assert!(complained.contains("to install it: parafovea install"), "{complained}");
    assert_eq!(parafovea(home.path(), &["run", "--", "/"]).status.code(), Some(126));
}

#[test]
fn run_tells_a_missing_program_from_a_missing_interpreter() {
    let home = TempDir::new().unwrap();
    let game = home.path().join("game");
    let run = |name: &str| {
        let output = parafovea(home.path(), &["run", "--", name]);
        (output.status.code(), complained(&output))
    };
    for name in [game.to_str().unwrap(), "./game"] {
        let (code, complaint) = run(name);
        assert!(code == Some(127) && complaint.contains("game: does not exist"), "{complaint}");
    }
    for (content, expected) in [
        ("#! /nowhere/sh -e\n", "its interpreter /nowhere/sh is missing"),
        ("#!/bin/sh\r\nexit 0\r\n", "its first line ends in a carriage return"),
    ] {
        write_program(&game, content);
        for name in [game.to_str().unwrap(), "./game"] {
            let (code, complaint) = run(name);
            assert!(code == Some(126) && complaint.contains(expected), "{complaint}");
        }
    }
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
fn a_doctor_that_can_ask_nobody_says_what_is_wrong_and_fixes_what_is_ours() {
    let home = home_with_library();
    parafovea(home.path(), &["install", "--library", "built.so"]);
    let config = home.path().join(".config/parafovea/config.toml");
    fs::create_dir_all(config.parent().unwrap()).unwrap();
    fs::write(&config, "enabled = 1\n").unwrap();
    fs::set_permissions(&config, fs::Permissions::from_mode(0o666)).unwrap();

    let doctor = |arguments: &[&str]| parafovea(home.path(), &[&["doctor"], arguments].concat());
    let text = printed(&doctor(&[]));
    for expected in
        ["problem  ", "enabled = 1 is not allowed", "To do: correct this line", "--fix can repair "]
    {
        assert!(text.contains(expected), "{expected} in\n{text}");
    }
    assert!(!doctor(&[]).status.success());
    assert!(printed(&doctor(&["--fix"])).contains("fixed: restrict write permission to the owner: "));
    assert_eq!(fs::metadata(&config).unwrap().permissions().mode() & 0o777, 0o644);

    let json = printed(&doctor(&["--json"]));
    let findings: Vec<serde_json::Value> =
        json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let wrong = findings.iter().find(|finding| finding["id"] == "configuration-wrong").unwrap();
    assert_eq!((wrong["severity"].as_str(), wrong["fixable"].as_bool()), (Some("problem"), Some(false)));
    assert!(findings.iter().all(|finding| finding["id"] != "anybody-may-write"), "{json}");
}

/// A loader prints to standard output if one of these variables is set, and a driver may fill any pipe.
#[test]
fn answers_of_the_helper_are_found_among_the_lines_of_loaders() {
    // On the file system of the build: the helper lies beside the command, which a link may be, and a copy for writing may be busy.
    let home = TempDir::new_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let command = home.path().join("parafovea");
    fs::hard_link(env!("CARGO_BIN_EXE_parafovea"), &command).unwrap();
    let helper = r#"#!/bin/sh
echo "Info [GENERAL | xrEnumerateApiLayerProperties | OpenXR-Loader] : XR_APILAYER"
[ -z "$XR_LOADER_DEBUG$VK_LOADER_DEBUG" ] || exit 3
head -c 200000 /dev/zero >&2
echo "parafovea-probe: {\"Err\": \"answered $1\"}"
echo "more of it"
exit 1
"#;
    write_program(&home.path().join("parafovea-probe"), helper);
    let output = Command::new(&command)
        .args(["doctor", "--json"])
        .env_clear()
        .env("PATH", "/usr/bin:/bin")
        .env("HOME", home.path())
        .env("XR_LOADER_DEBUG", "all")
        .env("VK_LOADER_DEBUG", "all")
        .output()
        .unwrap();
    let text = printed(&output);
    for question in ["layers", "vulkan", "openxr"] {
        assert!(text.contains(&format!(": answered {question}\"")), "{question} in\n{text}");
    }
}

#[test]
fn a_full_disk_is_a_failure_and_a_reader_that_ends_is_none() {
    let home = TempDir::new().unwrap();
    let run = |script: &str| {
        let mut shell = Command::new("sh");
        shell.args(["-c", script, env!("CARGO_BIN_EXE_parafovea")]).env_clear().env("HOME", home.path());
        shell.env("XDG_RUNTIME_DIR", home.path()).env("PATH", "/usr/bin:/bin").output().unwrap()
    };
    for arguments in ["config default", "profile list", "status --once", "generate man"] {
        let full = run(&format!("\"$0\" {arguments} > /dev/full"));
        let complaint = complained(&full);
        assert!(complaint.starts_with("parafovea: standard output: No space left"), "{complaint}");
        assert_eq!(complaint.lines().count(), 1, "{complaint}");
        let ended = run(&format!("(sleep 0.1; \"$0\" {arguments}; echo $? >&2) | true"));
        assert_eq!(String::from_utf8_lossy(&ended.stderr), "0\n", "{arguments}");
    }
    let unheard = run("\"$0\" profile set all plateau_deg 7 2> /dev/full; echo $?");
    assert_eq!(printed(&unheard), "1\n");
}

#[test]
fn completions_and_manual_have_every_command() {
    let home = TempDir::new().unwrap();
    let help = printed(&parafovea(home.path(), &["--help"]));
    let commands: Vec<&str> = help
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .map_while(|line| line.strip_prefix("  ")?.split(' ').next())
        .collect();
    assert!(commands.contains(&"doctor") && commands.len() >= 10, "{help}");
    let manual = printed(&parafovea(home.path(), &["generate", "man"]));
    for option in ["view", "fix", "system", "reset", "once", "effective"] {
        assert!(manual.contains(&format!("\\-\\-{option}")), "--{option} in\n{manual}");
    }
    for what in ["bash", "zsh", "fish", "man"] {
        let text = printed(&parafovea(home.path(), &["generate", what]));
        for command in &commands {
            assert!(text.contains(command), "{command} in {what}");
        }
    }
}

#[test]
fn the_system_is_only_written_to_when_asked_for() {
    let home = home_with_library();
    let would =
        printed(&parafovea(home.path(), &["install", "--system", "--dry-run", "--library", "built.so"]));
    assert!(
        would.lines().all(|line| line.starts_with("would ") && line.contains(" /usr/local/share/")),
        "{would}"
    );
    assert_eq!(would.lines().count(), 3, "{would}");
}

#[test]
fn a_second_installation_is_refused() {
    let home = home_with_library();
    let install = |data: &str| {
        Command::new(env!("CARGO_BIN_EXE_parafovea"))
            .args(["install", "--library", "built.so"])
            .env_clear()
            .env("HOME", home.path())
            .env("XDG_DATA_HOME", home.path().join(data))
            .env("XDG_DATA_DIRS", home.path().join("usr/share"))
            .current_dir(home.path())
            .output()
            .unwrap()
    };
    printed(&install("usr/share"));
    let refused = complained(&install(".local/share"));
    assert!(refused.contains("already installed") && refused.contains("usr/share/vulkan"), "{refused}");
    assert!(refused.contains("first remove the other: the package manager"), "{refused}");
    assert!(!home.path().join(".local").exists());
    let kept = Command::new(env!("CARGO_BIN_EXE_parafovea"))
        .arg("uninstall")
        .env_clear()
        .env("HOME", home.path())
        .env("XDG_DATA_DIRS", home.path().join("usr/share"))
        .output()
        .unwrap();
    let (kept, manifest) =
        (printed(&kept), home.path().join("usr/share/vulkan/implicit_layer.d/parafovea.json"));
    assert!(kept.starts_with("not installed\nstill installed: "), "{kept}");
    assert!(kept.contains(&manifest.display().to_string()), "{kept}");
    printed(&install("usr/share"));
    // A Flatpak does not see the system's.
    let flatpak = install(".var/app/com.valvesoftware.Steam/.local/share");
    assert!(flatpak.status.success(), "{flatpak:?}");
}

/// Steam from Flatpak has a copy of its own, which the host's command does not remove.
#[test]
fn a_copy_that_remains_in_the_flatpak_of_steam_is_named() {
    let home = home_with_library();
    let flatpak = home.path().join(".var/app/com.valvesoftware.Steam/.local/share");
    let run = |data: &Path, arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_parafovea"));
        command.args(arguments).env_clear().env("HOME", home.path()).env("XDG_DATA_HOME", data);
        printed(&command.current_dir(home.path()).output().unwrap())
    };
    let host = home.path().join(".local/share");
    for data in [&host, &flatpak] {
        run(data, &["install", "--library", "built.so"]);
    }
    let said = run(&host, &["uninstall"]);
    let last = said.lines().last().unwrap();
    let [manifest, layer] = ["vulkan/implicit_layer.d", "openxr/1/api_layers/implicit.d"]
        .map(|folder| flatpak.join(folder).join("parafovea.json").display().to_string());
    assert!(
        last.starts_with("still installed: ") && last.contains(&manifest) && last.contains(&layer),
        "{said}"
    );
    let command =
        format!("XDG_DATA_HOME={} {} uninstall", flatpak.display(), env!("CARGO_BIN_EXE_parafovea"));
    assert!(last.ends_with(&format!("; to remove it: {command}")), "{said}");
    assert!(!run(&flatpak, &["uninstall"]).contains("still installed"));
    assert_eq!(run(&host, &["uninstall"]), "not installed\n");
}

/// As over SSH: games in containers have their state in the home.
#[test]
fn applications_in_containers_are_found_without_a_runtime_folder() {
    let home = TempDir::new().unwrap();
    let status = || parafovea(home.path(), &["status", "--once"]);
    let none = status();
    assert!(none.status.success() && printed(&none).starts_with("No running application"), "{none:?}");
    let container = Environment::new(false, |name| match name {
        "HOME" => Some(home.path().into()),
        "container" => Some("pressure-vessel".into()),
        _ => None,
    });
    let file = StatusFile::new(&container, 7).unwrap().unwrap();
    file.write(&Status { pid: 7, application: "Game".to_owned(), ..Status::default() }).unwrap();
    for found in [status(), parafovea(home.path(), &["gaze", "--once"])] {
        assert!(printed(&found).starts_with("Game (process 7"), "{found:?}");
        let warning = String::from_utf8(found.stderr).unwrap();
        assert!(warning.contains("XDG_RUNTIME_DIR is not set"), "{warning}");
    }
    drop(file);
    for measurement in ["recentre", "calibrate"] {
        let complaint = complained(&parafovea(home.path(), &["gaze", measurement]));
        assert!(complaint.contains("no running application has an active OpenXR session"), "{complaint}");
    }
    let homeless = complained(&parafovea(Path::new("."), &["status", "--once"]));
    assert!(homeless.contains("none of XDG_RUNTIME_DIR, XDG_STATE_HOME and HOME is set"), "{homeless}");
}
