//! Steam from Flatpak.

use super::*;

/// Installations of Steam, for this user and for all.
const APPS: [&str; 2] = [
    "home/.local/share/flatpak/app/com.valvesoftware.Steam/current",
    "var/lib/flatpak/app/com.valvesoftware.Steam/current",
];

/// Data files of games in Steam's Flatpak.
const DATA: &str = "home/.var/app/com.valvesoftware.Steam/.local/share";

/// Permissions of Steam, by this user and for all.
const OVERRIDES: [&str; 2] = [
    "home/.local/share/flatpak/overrides/com.valvesoftware.Steam",
    "var/lib/flatpak/overrides/com.valvesoftware.Steam",
];

/// A machine with Steam from Flatpak, and the layer in it.
fn machine_with_layer() -> Machine {
    let machine = Machine::new();
    machine.put(APPS[1], "");
    for step in plan_install(&machine.path(DATA), &machine.path("build/libparafovea.so"), false).unwrap() {
        step.apply().unwrap();
    }
    machine
}

#[test]
fn an_outdated_layer_is_found() {
    let machine = machine_with_layer();
    machine.put(OVERRIDES[0], "[Context]\nfilesystems=xdg-config/parafovea:ro;\n");
    assert_eq!(machine.ids(), [""; 0]);
    fs::write(library_path(&machine.path(DATA)), library("0")).unwrap();
    assert_eq!(machine.ids(), ["flatpak-steam"]);
    let program = machine.surroundings().program;
    let command = format!("XDG_DATA_HOME={} {} install; ", machine.path(DATA).display(), program.display());
    let advice = &machine.findings()[0].advice;
    assert!(advice.starts_with(&command), "{advice}");
}

/// Flatpak keeps the home folder of a removed application.
#[test]
fn a_home_folder_alone_is_no_installation_of_steam() {
    for app in APPS {
        let machine = Machine::new();
        machine.put(&format!("{DATA}/Steam/steam.sh"), "");
        assert_eq!(machine.ids(), [""; 0]);
        machine.put(app, "");
        assert_eq!(machine.ids(), ["flatpak-steam"], "{app}");
    }
}

#[test]
fn an_installation_elsewhere_is_found() {
    let machine = Machine::new();
    machine.put("srv/games/app/com.valvesoftware.Steam/current", "");
    assert_eq!(machine.ids(), [""; 0]);
    machine.put("etc/flatpak/installations.d/games.conf", "[Installation \"games\"]\nPath=/srv/games\n");
    assert_eq!(machine.ids(), ["flatpak-steam"]);
}

#[test]
fn settings_that_games_do_not_see_are_a_warning_with_the_command() {
    let machine = machine_with_layer();
    let command = "flatpak override --user --filesystem=xdg-config/parafovea:ro com.valvesoftware.Steam";
    let findings = machine.findings();
    assert_eq!(machine.ids(), ["flatpak-settings"]);
    assert_eq!((findings[0].severity, findings[0].advice.as_str()), (Severity::Warning, command));
    assert!(findings[0].found.contains("home/.config/parafovea"), "{}", findings[0]);
    // Without settings, there is nothing to share.
    let settings = machine.path("home/.config/parafovea");
    fs::rename(&settings, machine.path("away")).unwrap();
    assert_eq!(machine.ids(), [""; 0]);
    fs::create_dir(&settings).unwrap();
    assert_eq!(machine.ids(), [""; 0]);
    fs::remove_dir(&settings).unwrap();
    fs::rename(machine.path("away"), &settings).unwrap();
    // The games may have settings of their own.
    machine.put("home/.var/app/com.valvesoftware.Steam/.config/parafovea/config.toml", "");
    assert_eq!(machine.ids(), [""; 0]);
}

#[test]
fn permissions_to_see_the_settings_are_read_as_flatpak_does() {
    let machine = machine_with_layer();
    let config_home = machine.path("home/.config").display().to_string();
    let ids = |file: &str, content: &str| {
        machine.put(file, content);
        let ids = machine.ids();
        machine.remove(&machine.path(file));
        ids
    };
    for file in OVERRIDES.into_iter().chain(["var/lib/flatpak/overrides/global"]) {
        for (entries, is_shared) in [
            ("xdg-config/parafovea:ro", true),
            ("xdg-config/parafovea", true),
            ("/mnt;xdg-config:create;", true),
            ("xdg-music;home;", true),
            ("host:rw", true),
            ("~/.config/parafovea", true),
            (config_home.as_str(), true),
            ("", false),
            ("host-etc;xdg-config/paraf;~/.conf;/mnt", false),
            ("!xdg-config/parafovea;!home;!host", false),
        ] {
            let content = format!("[Context]\nshared=ipc;\nfilesystems={entries}\n\n[Environment]\nA=1\n");
            let expected: &[&str] = if is_shared { &[] } else { &["flatpak-settings"] };
            assert_eq!(ids(file, &content), expected, "{entries} in {file}");
        }
    }
    assert_eq!(ids(OVERRIDES[0], "[Environment]\nfilesystems=home\n"), ["flatpak-settings"]);
}
