//! Steam from Flatpak.

use super::*;

/// Installations of Steam, for this user and for all.
const APPS: [&str; 2] = [
    "home/.local/share/flatpak/app/com.valvesoftware.Steam/current",
    "var/lib/flatpak/app/com.valvesoftware.Steam/current",
];

/// Data files of games in Steam's Flatpak.
const DATA: &str = "home/.var/app/com.valvesoftware.Steam/.local/share";

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
    assert_eq!(machine.ids(), [""; 0]);
    fs::write(library_path(&machine.path(DATA)), library("0")).unwrap();
    assert_eq!(machine.ids(), ["flatpak-steam"]);
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
