//! Injected faults, and their findings.

use super::*;

/// A fault: its name, its injection, its findings, and whether `--fix` removes it.
type Fault = (&'static str, fn(&mut Machine), &'static [&'static str], bool);

/// The user's configuration.
const CONFIG: &str = "home/.config/parafovea/config.toml";

const FAULTS: &[Fault] = &[
    ("never installed", |machine| fs::remove_dir_all(machine.data()).unwrap(), &["not-installed"], true),
    (
        "a folder of manifests that cannot be read",
        |machine| {
            // Not even root can read a link to itself; without the permission it is the same.
            let folder = machine.manifest(Half::Vulkan).parent().unwrap().to_owned();
            fs::remove_dir_all(&folder).unwrap();
            symlink(&folder, &folder).unwrap();
        },
        &["folder-unreadable"],
        false,
    ),
    (
        "one manifest missing",
        |machine| machine.remove(&machine.manifest(Half::Vulkan)),
        &["manifest-missing"],
        true,
    ),
    (
        "manifest that names a library that is gone",
        |machine| machine.remove(&library_path(&machine.data())),
        &["library-missing", "library-missing"],
        true,
    ),
    (
        "manifest with a wrong path",
        |machine| {
            write(
                &machine.manifest(Half::OpenXr),
                &Half::OpenXr.manifest("/nowhere.so", Activation::Implicit),
            )
        },
        &["library-missing"],
        true,
    ),
    (
        "manifest that names another library",
        |machine| {
            machine.put("usr/lib/other.so", "\u{7f}ELF");
            let other = machine.path("usr/lib/other.so");
            write(
                &machine.manifest(Half::Vulkan),
                &Half::Vulkan.manifest(other.to_str().unwrap(), Activation::Implicit),
            );
        },
        &["library-wrong"],
        true,
    ),
    ("copies in the place of one file", |machine| copy(machine, &library("1")), &["library-copied"], true),
    ("halves of two builds", |machine| copy(machine, &library("0")), &["library-differs"], true),
    (
        "an older build installed",
        |machine| write(&library_path(&machine.data()), &library("0")),
        &["outdated"],
        true,
    ),
    (
        "manifest that is not JSON",
        |machine| write(&machine.manifest(Half::OpenXr), "{\"api_layer\": "),
        &["manifest-malformed"],
        false,
    ),
    (
        "manifest that is a folder",
        |machine| {
            machine.remove(&machine.manifest(Half::OpenXr));
            fs::create_dir(machine.manifest(Half::OpenXr)).unwrap();
        },
        &["manifest-unreadable"],
        false,
    ),
    (
        "manifest of another layer in our place",
        |machine| {
            let text =
                Half::Vulkan.manifest("x.so", Activation::Implicit).replace("PARAFOVEA_foveation", "OTHER");
            write(&machine.manifest(Half::Vulkan), &text);
        },
        &["manifest-foreign"],
        false,
    ),
    (
        "manifest that was edited",
        |machine| edit(&machine.manifest(Half::OpenXr), "\"PARAFOVEA\"", "\"MINE\""),
        &["manifest-edited"],
        true,
    ),
    (
        "installed for the user and for the system",
        |machine| {
            for half in Half::BOTH {
                let system = half.manifest_path(&machine.path("usr/share"));
                fs::create_dir_all(system.parent().unwrap()).unwrap();
                fs::copy(machine.manifest(half), system).unwrap();
            }
        },
        &["installed-twice", "installed-twice"],
        false,
    ),
    (
        "Steam as a snap",
        |machine| fs::create_dir_all(machine.path("home/snap/steam/common")).unwrap(),
        &["snap-steam"],
        false,
    ),
    (
        "a folder that is searched twice",
        |machine| {
            let data = machine.path("home/.local/share");
            machine.set("XDG_DATA_DIRS", &data.display().to_string());
        },
        &["listed-twice"],
        false,
    ),
    ("disabled by the environment", |machine| machine.set("DISABLE_PARAFOVEA", ""), &["disabled"], false),
    ("enabled by another value than 1", |machine| machine.set("PARAFOVEA", "yes"), &["half-enabled"], false),
    (
        "left out by a filter of the Vulkan loader",
        |machine| machine.set("VK_LOADER_LAYERS_DISABLE", "*MESA*,~Implicit~"),
        &["filtered"],
        false,
    ),
    (
        "another folder for implicit layers",
        |machine| {
            let folder = machine.manifest(Half::Vulkan).parent().unwrap().to_owned();
            machine.set("VK_IMPLICIT_LAYER_PATH", folder.to_str().unwrap());
        },
        &["other-folders"],
        false,
    ),
    (
        "a base folder that is relative",
        |machine| machine.set("XDG_STATE_HOME", "state"),
        &["relative-home"],
        false,
    ),
    (
        "a layer between game and Parafovea",
        |machine| openxr_layer(machine, "XR_APILAYER_OTHER_motion"),
        &["layer-order"],
        false,
    ),
    (
        "another layer that foveates",
        |machine| openxr_layer(machine, "XR_APILAYER_OTHER_quad_views"),
        &["rival-layer"],
        false,
    ),
    (
        "an old OpenXR loader",
        |machine| machine.link_library("libopenxr_loader.so.1.0.5"),
        &["old-loader"],
        false,
    ),
    (
        "no runtime",
        |machine| machine.remove(&machine.path("home/.config/openxr/1/active_runtime.json")),
        &["no-runtime"],
        false,
    ),
    (
        "a runtime that is gone",
        |machine| machine.remove(&machine.path("usr/lib/libmonado.so")),
        &["runtime-broken"],
        false,
    ),
    (
        "a link to a runtime that is gone",
        |machine| {
            let active = machine.path("home/.config/openxr/1/active_runtime.json");
            machine.remove(&active);
            symlink("/nowhere.json", active).unwrap();
        },
        &["runtime-broken"],
        false,
    ),
    (
        "a runtime that does not run",
        |machine| {
            machine.probed.openxr = Ok(RuntimeAnswer {
                failure: "ERROR_RUNTIME_UNAVAILABLE".to_owned(),
                ..RuntimeAnswer::default()
            });
        },
        &["runtime-refuses"],
        false,
    ),
    (
        "an eye tracker that is not used",
        |machine| machine.put("home/.config/parafovea/config.toml", "gaze.source = 'centre'\n"),
        &["eye-tracker-unused"],
        false,
    ),
    (
        "OSC packets from the network",
        |machine| {
            let config = "gaze.source = 'osc'\ngaze.osc_listen = '0.0.0.0:9020'\n";
            machine.put("home/.config/parafovea/config.toml", config);
            answer(machine).extensions.truncate(1);
        },
        &["osc-from-network"],
        false,
    ),
    (
        "a port for OSC packets that is taken",
        |machine| {
            machine.put("home/.config/parafovea/config.toml", "gaze.source = 'osc'\n");
            answer(machine).extensions.truncate(1);
            // The same digits in either byte order.
            machine.put("proc/net/udp", "  sl  local_address\n  9: 00000000:233C 00000000:0000 07\n");
        },
        &["osc-port-taken"],
        false,
    ),
    (
        "a gaze of no source to give to games",
        |machine| {
            machine.put(CONFIG, "gaze.source = 'eyes'\ngaze.offer = true\n");
            reinstall(machine);
        },
        &["gaze-not-offered"],
        false,
    ),
    (
        "a gaze for games that loaders do not know of",
        |machine| {
            machine.put(CONFIG, "gaze.source = 'osc'\ngaze.offer = true\n");
            answer(machine).extensions.truncate(1);
        },
        &["outdated", "gaze-not-listed"],
        true,
    ),
    ("no gaze extension", |machine| answer(machine).extensions.truncate(1), &["no-eye-gaze"], false),
    (
        "a headset without eye tracker",
        |machine| answer(machine).tracks_eyes = Some(false),
        &["no-eye-tracker"],
        false,
    ),
    (
        "a runtime without Vulkan",
        |machine| drop(answer(machine).extensions.remove(0)),
        &["runtime-without-vulkan"],
        false,
    ),
    ("no shading rates", |machine| device(machine).rates.clear(), &["no-shading-rates"], false),
    ("no GPU", |machine| device(machine).is_cpu = true, &["no-gpu"], false),
    ("no driver", |machine| machine.probed.vulkan = Ok(VulkanAnswer::default()), &["no-device"], false),
    (
        "a crash with the layer",
        |machine| machine.probed.created = Err("signal: 11 (SIGSEGV)".to_owned()),
        &["crashes"],
        false,
    ),
    (
        "no device with the layer",
        |machine| {
            created(machine).failure = Some("ERROR_INITIALIZATION_FAILED".to_owned());
        },
        &["no-device-with-layer"],
        false,
    ),
    (
        "no device with the layer, and no answer without it",
        |machine| {
            created(machine).failure = Some("ERROR_INITIALIZATION_FAILED".to_owned());
            machine.probed.created_without_layer = Err("it took longer than 10 seconds".to_owned());
        },
        &["no-device-with-layer"],
        false,
    ),
    ("a GPU on which no program creates a device", |machine| refuse_all(machine), &["device-refused"], false),
    (
        "a GPU for no program, and one for programs without the layer",
        |machine| {
            refuse_all(machine);
            let other = |failure: Option<&str>| CreatedDevice {
                name: "A GPU".to_owned(),
                failure: failure.map(str::to_owned),
                has_layer: false,
            };
            machine.probed.created.as_mut().unwrap().push(other(Some("ERROR_FEATURE_NOT_PRESENT")));
            machine.probed.created_without_layer.as_mut().unwrap().push(other(None));
        },
        &["device-refused", "no-device-with-layer"],
        false,
    ),
    (
        "a driver that takes too long for any program",
        |machine| {
            let late = || Err("it took longer than 10 seconds".to_owned());
            (machine.probed.created, machine.probed.created_without_layer) = (late(), late());
        },
        &["device-refused"],
        false,
    ),
    ("a device without the layer", |machine| created(machine).has_layer = false, &["not-on-device"], false),
    (
        "a loader that does not list the layer",
        |machine| machine.probed.layers = Ok(LoaderLayers { openxr: Some(Vec::new()), vulkan: None }),
        &["not-listed"],
        false,
    ),
    (
        "no sound capture library",
        |machine| {
            machine.remove(&audio_library_path(&machine.data()));
            machine.remove(&machine.path("build").join(AUDIO_LIBRARY_NAME));
        },
        &["no-audio-library"],
        false,
    ),
    ("no ALSA", |machine| machine.remove(&machine.path("usr/lib/libasound.so.2")), &["no-alsa"], false),
    (
        "no sound server",
        |machine| machine.remove(&machine.path("run/pulse/native")),
        &["no-sound-server"],
        false,
    ),
    // Its socket is left.
    ("a sound server that has ended", |machine| machine.sound = None, &["no-sound-server"], false),
    (
        "a sound server on another computer",
        |machine| machine.set("PULSE_SERVER", "tcp:127.0.0.1"),
        &["no-sound-server"],
        false,
    ),
    (
        "a profile with an error",
        |machine| machine.put("home/.config/parafovea/apps/game.toml", "[chroma]\nmode = 'on'\n"),
        &["configuration-wrong"],
        false,
    ),
    (
        "a configuration that is not there",
        |machine| machine.set("PARAFOVEA_CONFIG", "/nowhere.toml"),
        &["configuration-wrong"],
        false,
    ),
    (
        "turned off by the configuration",
        |machine| machine.put("home/.config/parafovea/config.toml", "enabled = false"),
        &["turned-off"],
        false,
    ),
    (
        "a file of the gaze that is gone",
        |machine| {
            machine
                .put("home/.config/parafovea/config.toml", "[gaze]\nsource = 'file'\nfile = '/nowhere.csv'")
        },
        &["file-missing"],
        false,
    ),
    (
        "a configuration that everybody may write to",
        |machine| allow_everybody(&machine.path("home/.config/parafovea/config.toml")),
        &["anybody-may-write"],
        true,
    ),
    (
        "a library that everybody may write to",
        |machine| allow_everybody(&library_path(&machine.data())),
        &["anybody-may-write"],
        true,
    ),
    ("no folder for logs", |machine| machine.put("home/.local/state", ""), &["no-log"], false),
    (
        "Steam in a Flatpak",
        |machine| machine.put("var/lib/flatpak/app/com.valvesoftware.Steam/current/active/metadata", ""),
        &["flatpak-steam"],
        false,
    ),
    ("in a Flatpak", |machine| machine.put(".flatpak-info", ""), &["in-flatpak"], false),
];

#[test]
fn each_injected_fault_is_found_alone_and_has_advice() {
    for (name, inject, expected, is_fixable) in FAULTS {
        let mut machine = Machine::new();
        inject(&mut machine);
        let findings = machine.findings();
        assert_eq!(machine.ids(), *expected, "{name}: {findings:#?}");
        for finding in &findings {
            assert!(finding.severity > Severity::Note, "{name}: {finding}");
            assert!(!finding.means.is_empty() && !finding.advice.is_empty(), "{name}: {finding}");
            assert!(!finding.found.contains('\n') && !finding.advice.contains('\n'), "{name}: {finding}");
        }
        assert_eq!(findings.iter().all(|finding| finding.fix.is_some()), *is_fixable, "{name}");
    }
}

/// The most common faults: in users' words, the fault above, and the advice.
const MET_MOST: [(&str, &str, &str); 15] = [
    ("manifest missing", "one manifest missing", "parafovea install"),
    ("wrong path", "manifest with a wrong path", "parafovea install"),
    ("copy instead of the same file", "copies in the place of one file", "parafovea install"),
    ("disabled by the environment", "disabled by the environment", "unset DISABLE_PARAFOVEA"),
    ("layer order", "a layer between game and Parafovea", "turn these layers off one by one"),
    ("no gaze extension", "no gaze extension", "gaze.source = \"centre\""),
    ("no shading rates", "no shading rates", "update the driver"),
    ("no audio", "no sound server", "systemctl --user start pipewire-pulse"),
    ("bad profile", "a profile with an error", "correct this line"),
    ("old loader", "an old OpenXR loader", "update it to"),
    ("library gone", "manifest that names a library that is gone", "parafovea install"),
    ("installed twice", "installed for the user and for the system", "keep one"),
    ("no runtime", "no runtime", "runtime"),
    ("headset without eye tracker", "a headset without eye tracker", "gaze.source = \"centre\""),
    ("halves of two builds", "halves of two builds", "parafovea install"),
];

#[test]
fn the_fifteen_faults_that_users_meet_most_are_found_with_what_to_do() {
    for (met, name, advice) in MET_MOST {
        let (_, inject, ids, _) = FAULTS.iter().find(|(fault, ..)| *fault == name).unwrap();
        let mut machine = Machine::new();
        assert_eq!(machine.findings(), [], "{met}: nothing is wrong before");
        inject(&mut machine);
        for finding in machine.findings() {
            assert!(ids.contains(&finding.id), "{met}: {finding}");
            assert!(finding.advice.contains(advice), "{met}: {finding}");
        }
    }
}

#[test]
fn fixable_faults_are_gone_after_the_fix() {
    for (name, inject, _, _) in FAULTS.iter().filter(|(.., is_fixable)| *is_fixable) {
        let mut machine = Machine::new();
        inject(&mut machine);
        let surroundings = machine.surroundings();
        for fix in machine.findings().into_iter().filter_map(|finding| finding.fix) {
            for step in fix.plan(&surroundings).unwrap() {
                step.apply().unwrap();
            }
        }
        assert_eq!(machine.findings(), [], "{name}");
    }
}

fn write(path: &Path, text: &str) {
    fs::write(path, text).unwrap();
}

fn edit(path: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains(from));
    write(path, &text.replace(from, to));
}

/// The Vulkan half gets a library of its own.
fn copy(machine: &mut Machine, content: &str) {
    machine.put(&format!("usr/lib/{LIBRARY_NAME}"), content);
    let other = machine.path(&format!("usr/lib/{LIBRARY_NAME}"));
    write(
        &machine.manifest(Half::Vulkan),
        &Half::Vulkan.manifest(other.to_str().unwrap(), Activation::Implicit),
    );
}

/// An implicit layer of the system.
fn openxr_layer(machine: &mut Machine, name: &str) {
    let text = Half::OpenXr.manifest("x.so", Activation::Explicit).replace(Half::OpenXr.layer_name(), name);
    let mut file: serde_json::Value = serde_json::from_str(&text).unwrap();
    file["api_layer"]["disable_environment"] = "NO_OTHER".into();
    machine.put("usr/share/openxr/1/api_layers/implicit.d/other.json", &file.to_string());
}

fn allow_everybody(path: &Path) {
    fs::set_permissions(path, Permissions::from_mode(0o666)).unwrap();
}

fn answer(machine: &mut Machine) -> &mut RuntimeAnswer {
    machine.probed.openxr.as_mut().unwrap()
}

fn created(machine: &mut Machine) -> &mut CreatedDevice {
    &mut machine.probed.created.as_mut().unwrap()[0]
}

/// No device can be created, with or without the layer.
fn refuse_all(machine: &mut Machine) {
    for answer in [&mut machine.probed.created, &mut machine.probed.created_without_layer] {
        answer.as_mut().unwrap()[0].failure = Some("ERROR_INITIALIZATION_FAILED".to_owned());
    }
}

fn device(machine: &mut Machine) -> &mut Device {
    &mut machine.probed.vulkan.as_mut().unwrap().devices[0]
}

/// Installs the layer for the configuration.
fn reinstall(machine: &Machine) {
    let library = machine.path("build/libparafovea.so");
    let offers_gaze = crate::config::offers_gaze(&machine.surroundings().environment);
    for step in plan_install(&machine.data(), &library, offers_gaze).unwrap() {
        step.apply().unwrap();
    }
}

#[test]
fn a_gaze_that_is_given_to_games_is_told_with_its_source() {
    let mut machine = Machine::new();
    machine.put(CONFIG, "gaze.offer = true\n");
    reinstall(&machine);
    let told = |machine: &Machine| -> Vec<&str> {
        let findings = examine(&machine.surroundings());
        findings.iter().map(|finding| finding.id).filter(|id| id.starts_with("gaze-")).collect()
    };
    assert_eq!(told(&machine), ["gaze-of-runtime"]);
    answer(&mut machine).tracks_eyes = Some(false);
    assert_eq!(told(&machine), ["gaze-offered"]);
}

#[test]
fn an_installation_of_the_system_is_not_repaired_in_the_home() {
    let mut machine = Machine::new();
    for half in Half::BOTH {
        let system = half.manifest_path(&machine.path("usr/share"));
        fs::create_dir_all(system.parent().unwrap()).unwrap();
        fs::rename(machine.manifest(half), system).unwrap();
    }
    machine.put(CONFIG, "gaze.offer = true\n");
    answer(&mut machine).tracks_eyes = Some(false);
    let fixes = |machine: &Machine| -> Vec<(&str, bool)> {
        let findings = machine.findings();
        findings.iter().map(|finding| (finding.id, finding.fix.is_some())).collect()
    };
    assert_eq!(fixes(&machine), [("no-eye-tracker", false), ("gaze-not-listed", false)]);
    machine.remove(&Half::Vulkan.manifest_path(&machine.path("usr/share")));
    assert!(fixes(&machine).contains(&("manifest-missing", false)), "{:?}", fixes(&machine));
}

/// As the Vulkan loader reads its filters: a space is part of a word, and only one of the variables knows all implicit layers.
#[test]
fn filters_of_the_vulkan_loader_are_read_as_it_reads_them() {
    let ids = |disable: &str, allow: &str| {
        let mut machine = Machine::new();
        machine.set("VK_LOADER_LAYERS_DISABLE", disable);
        machine.set("VK_LOADER_LAYERS_ALLOW", allow);
        let ids = machine.ids();
        machine.set("VK_LOADER_LAYERS_ENABLE", "*parafovea*");
        assert_eq!(machine.ids(), [""; 0], "enabled, whatever else is set");
        ids
    };
    assert_eq!(ids("*MESA*, ~implicit~", ""), [""; 0]);
    assert_eq!(ids("*mesa*,*parafovea*", ""), ["filtered"]);
    assert_eq!(ids("*", "~implicit~, VK_LAYER_PARAFOVEA_foveation"), ["filtered"]);
    assert_eq!(ids("*", "vk_layer_parafovea_FOVEATION"), [""; 0]);
}
