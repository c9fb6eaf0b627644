//! `parafovea profile`.

use super::{complained, parafovea, printed};
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// The log of `Beat Saber.exe`, which is "Beat Saber" for OpenXR.
fn log_of_beat_saber(home: &Path) {
    let logs = home.join(".local/state/parafovea");
    fs::create_dir_all(&logs).unwrap();
    let line = "2026-01-02T03:04:05.678+01:00 77 INFO  OpenXR instance of \"Beat Saber\"\n";
    fs::write(logs.join("Beat Saber.exe.log"), line).unwrap();
}

#[test]
fn a_name_that_no_application_has_had_is_told_with_the_nearest_known_ones() {
    let home = TempDir::new().unwrap();
    let profile =
        |arguments: &[&str]| -> Output { parafovea(home.path(), &[&["profile"], arguments].concat()) };
    let unknown = "No application of this name has run with Parafovea yet";
    let first = printed(&profile(&["set", "before the first run", "enabled", "false"]));
    assert!(first.ends_with(&format!("{unknown}.\n")), "{first}");

    log_of_beat_saber(home.path());
    for name in ["beat saber", "Beat Saber.EXE", "BeatSaber"] {
        for arguments in [
            ["set", name, "enabled", "false"].as_slice(),
            &["unset", name, "enabled"],
            &["unset", name, "enabled"],
        ] {
            let said = printed(&profile(arguments));
            let expected = format!("{unknown}; similar names: \"Beat Saber\", \"Beat Saber.exe\".\n");
            assert!(said.ends_with(&expected), "{said}");
        }
    }
    let examined = |name: &str| printed(&parafovea(home.path(), &["doctor", name, "--json"]));
    let said = examined("BeatSaber");
    assert!(said.contains("\"similar names: Beat Saber, Beat Saber.exe\""), "{said}");
    assert!(!examined("Beat Saber").contains("unknown-application"));
    let said = printed(&profile(&["new", "beat-saber.exe", "proton"]));
    assert!(said.contains("similar names: \"Beat Saber"), "{said}");
    for known in ["Beat Saber", "Beat Saber.exe", "all"] {
        let said = printed(&profile(&["set", known, "enabled", "false"]));
        assert!(!said.contains(unknown), "{said}");
    }
}

#[test]
fn a_profile_is_changed_by_the_command_as_by_hand() {
    let home = TempDir::new().unwrap();
    let profile = |arguments: &[&str]| parafovea(home.path(), &[&["profile"], arguments].concat());
    let file = |name: &str| fs::read_to_string(home.path().join(".config/parafovea").join(name)).unwrap();
    printed(&profile(&["set", "all", "preset", "performance"]));
    assert_eq!(file("config.toml"), "preset = \"performance\"\n");

    let mode = || fs::metadata(home.path().join(".config/parafovea/config.toml")).unwrap().permissions();
    fs::set_permissions(home.path().join(".config/parafovea/config.toml"), fs::Permissions::from_mode(0o600))
        .unwrap();
    printed(&profile(&["set", "all", "preset", "performance"]));
    assert_eq!(mode().mode() & 0o7777, 0o600, "the file keeps its permissions");

    let said = printed(&profile(&["set", "game", "chroma.mode", "default"]));
    assert!(said.contains("which no longer applies to game"), "{said}");
    assert_eq!(file("apps/game.toml"), "preset = \"performance\"\n\n[chroma]\nmode = \"default\"\n");
    let shown = printed(&profile(&["show", "game"]));
    for line in [
        "preset = \"performance\"  # set in this file",
        "rates.transitional_deg = 18.39  # from preset \"performance\"",
        "chroma.mode = \"default\"  # set in this file",
    ] {
        assert!(shown.lines().any(|found| found == line), "{line} in\n{shown}");
    }
    assert!(!shown.contains("gaze.source"));
    assert!(
        printed(&profile(&["show", "game", "--effective"])).contains("gaze.source = \"auto\"  # default")
    );

    let before = file("apps/game.toml");
    let refused = complained(&profile(&["set", "game", "chroma.plateau_deg", "wide"]));
    assert!(
        refused.contains("chroma.plateau_deg = \"wide\" is not allowed; allowed: a number from 1.1"),
        "{refused}"
    );
    assert!(
        complained(&profile(&["set", "game", "plateau_deg", "7"]))
            .contains("did you mean chroma.plateau_deg?")
    );
    assert!(
        complained(&profile(&["set", "game", "mode", "fixed"]))
            .contains("did you mean audio.mode or rates.mode or reuse.mode or chroma.mode?")
    );
    assert_eq!(file("apps/game.toml"), before);
    printed(&profile(&["unset", "game", "chroma.mode"]));
    assert_eq!(file("apps/game.toml"), "preset = \"performance\"\n\n[chroma]\n");

    let said = printed(&profile(&["unset", "other", "rates.peripheral"]));
    assert!(said.contains("is not set for other"), "{said}");
    assert!(!home.path().join(".config/parafovea/apps/other.toml").exists());

    for (key, value) in [("audio.least_lufs", "-30"), ("gaze.offset_deg", "-1.5,0.5")] {
        printed(&profile(&["set", "all", key, value]));
    }
    let said = printed(&profile(&["new", "sim", "flight-simulator"]));
    assert!(said.contains("which no longer applies to sim"), "{said}");
    let shown = printed(&profile(&["show", "sim"]));
    for setting in [
        "preset = \"performance\"",
        "audio.least_lufs = -30.0",
        "gaze.offset_deg = \"-1.5, 0.5\"",
        "rates.foveal_deg = 20.0",
    ] {
        assert!(shown.contains(&format!("{setting}  # set in this file")), "{setting} in\n{shown}");
    }
    printed(&profile(&["new", "level", "godot"]));
    let shown = printed(&profile(&["show", "level"]));
    assert!(
        shown.contains("preset = \"performance\"  # set in this file"),
        "no default overrules it: {shown}"
    );
    fs::remove_file(home.path().join(".config/parafovea/apps/level.toml")).unwrap();
    assert!(complained(&profile(&["new", "sim", "proton"])).contains("already exists"));
    let listed = printed(&profile(&["list"]));
    let names: Vec<_> = listed.lines().filter(|line| !line.starts_with(' ')).collect();
    assert_eq!(names[..3], ["game", "sim", "all others"], "{listed}");
    assert!(profile(&["validate"]).status.success());
    fs::write(home.path().join(".config/parafovea/apps/sim.toml"), "[chroma]\nmode = 1\n").unwrap();
    assert!(complained(&profile(&["validate"])).contains("sim.toml: line 2: chroma.mode = 1"));
    let shown = complained(&profile(&["show", "sim"]));
    assert!(shown.contains("the file has errors") && !shown.contains("changed"), "{shown}");
}

/// Settings of `Game.exe`, which is "My Game" for OpenXR, have one file, whichever name is typed.
#[test]
fn both_names_of_an_application_lead_to_its_one_profile() {
    let home = TempDir::new().unwrap();
    let folder = home.path().join(".config/parafovea");
    let logs = home.path().join(".local/state/parafovea");
    fs::create_dir_all(&logs).unwrap();
    fs::write(
        logs.join("Game.exe.log"),
        "2026-01-02T03:04:05.678+01:00 77 INFO  OpenXR instance of \"My Game\"\n",
    )
    .unwrap();
    let profile = |arguments: &[&str]| parafovea(home.path(), &[&["profile"], arguments].concat());
    for [first, second] in [["Game.exe", "My Game"], ["My Game", "Game.exe"]] {
        let file = folder.join(format!("apps/{first}.toml"));
        printed(&profile(&["set", first, "rates.foveal_deg", "20.0"]));
        let said = printed(&profile(&["set", second, "chroma.mode", "default"]));
        assert!(said.starts_with(&file.display().to_string()), "{said}");
        let is_shared = said.contains("applies to all applications with the OpenXR name \"My Game\"");
        assert_eq!(is_shared, first == "My Game", "{said}");
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.contains("foveal_deg = 20.0") && text.contains("mode = \"default\""), "{text}");
        assert_eq!(fs::read_dir(folder.join("apps")).unwrap().count(), 1);
        assert!(complained(&profile(&["new", second, "proton"])).contains("already exists"));
        let shown = printed(&profile(&["show", second]));
        assert!(shown.contains("rates.foveal_deg = 20.0  # set in this file"), "{shown}");
        let checked = printed(&parafovea(home.path(), &["doctor", "--verbose", second]));
        assert!(checked.contains(&format!("configuration: {}", file.display())), "{checked}");
        fs::remove_file(file).unwrap();
    }
}

#[test]
fn a_profile_that_no_game_would_read_is_named_or_refused() {
    let home = TempDir::new().unwrap();
    let path = complained(&parafovea(home.path(), &["profile", "set", "/opt/game", "enabled", "true"]));
    assert!(path.contains("/opt/game is a path"), "{path}");
    assert!(!home.path().join(".config").exists());

    let other = home.path().join("other.toml");
    fs::write(&other, "preset = \"quality\"\n").unwrap();
    for application in ["game", "all", "game"] {
        let said = Command::new(env!("CARGO_BIN_EXE_parafovea"))
            .args(["profile", "set", application, "chroma.mode", "default"])
            .env_clear()
            .env("HOME", home.path())
            .env("PARAFOVEA_CONFIG", &other)
            .output()
            .unwrap();
        let said = printed(&said);
        let shadow = format!("PARAFOVEA_CONFIG is set, and its file, {}, applies", other.display());
        assert!(said.contains(&shadow) && !said.contains("no longer"), "{said}");
    }
    let without = printed(&parafovea(home.path(), &["profile", "set", "game", "chroma.mode", "off"]));
    assert!(!without.contains("effect"), "{without}");
}

/// The file of an application begins as a copy of the file in force; errors of that file have its name.
#[test]
fn errors_of_a_file_that_is_copied_have_its_name() {
    let home = TempDir::new().unwrap();
    let config = home.path().join(".config/parafovea/config.toml");
    fs::create_dir_all(config.parent().unwrap()).unwrap();
    let set = |value: &str| parafovea(home.path(), &["profile", "set", "Game", "enabled", value]);
    for (text, error) in
        [("preset = 1\n", "line 1: preset = 1 is not allowed"), ("a = = 1\n", "line 1: not valid TOML")]
    {
        fs::write(&config, text).unwrap();
        let complaint = complained(&set("false"));
        assert!(complaint.contains(&format!("{}: {error}", config.display())), "{complaint}");
        assert!(!complaint.contains("apps/Game.toml"), "{complaint}");
    }
    assert!(!config.with_file_name("apps").exists());
    // An error that the change itself removes, and one that it makes.
    fs::write(&config, "enabled = 1\n").unwrap();
    assert!(complained(&set("maybe")).contains("nothing was changed"));
    printed(&set("false"));
    fs::remove_dir_all(config.with_file_name("apps")).unwrap();
    fs::write(&config, "enabled = true\n").unwrap();
    let complaint = complained(&set("maybe"));
    assert!(complaint.contains("apps/Game.toml: line 1: enabled = \"maybe\""), "{complaint}");
}

/// As stow and Nix leave them when a package is removed. The layer takes the next file then, too.
#[test]
fn a_link_to_a_missing_file_counts_as_none_and_stays() {
    let home = TempDir::new().unwrap();
    let folder = home.path().join(".config/parafovea");
    let [config, link, target] = ["config.toml", "apps/Game.toml", "kept.toml"].map(|name| folder.join(name));
    fs::create_dir_all(link.parent().unwrap()).unwrap();
    fs::write(&config, "gaze.hold_ms = 7\n").unwrap();
    symlink(&target, &link).unwrap();
    let profile = |arguments: &[&str]| parafovea(home.path(), &[&["profile"], arguments].concat());
    let shown = printed(&profile(&["show", "Game"]));
    assert!(shown.starts_with(&format!("# Game: {}\n", config.display())), "{shown}");
    assert!(printed(&profile(&["list"])).contains("apps/Game.toml: no effect: a link to a missing file"));
    for arguments in [["set", "Game", "enabled", "false"].as_slice(), &["new", "Game", "proton"]] {
        let complaint = complained(&profile(arguments));
        let expected = format!("{} is a link to {}, which is missing", link.display(), target.display());
        assert!(complaint.contains(&expected), "{complaint}");
    }
    assert_eq!(fs::read_link(&link).unwrap(), target);
    fs::write(&target, "").unwrap();
    printed(&profile(&["set", "Game", "enabled", "false"]));
    assert_eq!(fs::read_link(&link).unwrap(), target);
    assert_eq!(fs::read_to_string(&target).unwrap(), "enabled = false\n");
}
