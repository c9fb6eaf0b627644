use super::*;
use crate::install::{AUDIO_LIBRARY_NAME, LIBRARY_NAME, audio_library_path, library_path, plan_install};
use crate::json::{Activation, Half};
use std::ffi::OsString;
use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::os::unix::net::UnixListener;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

mod configuration;
mod faults;
mod flatpak;
mod sound;

/// A machine on which everything is as it should be, until a fault is injected.
struct Machine {
    folder: TempDir,
    variables: Vec<(&'static str, OsString)>,
    probed: Probed,
    /// The sound server, while it runs.
    sound: Option<UnixListener>,
}

impl Machine {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        let root = folder.path().to_owned();
        let variables =
            vec![("HOME", root.join("home").into()), ("XDG_RUNTIME_DIR", root.join("run").into())];
        fs::create_dir_all(root.join("run/pulse")).unwrap();
        let sound = Some(UnixListener::bind(root.join("run/pulse/native")).unwrap());
        let machine = Self { folder, variables, probed: probed(), sound };
        machine.put("build/libparafovea.so", &library("1"));
        machine.put(&format!("build/{AUDIO_LIBRARY_NAME}"), "\u{7f}ELF parafovea_audio_get_table\0");
        for library in ["libopenxr_loader.so.1.0.20", "libvulkan.so.1.3.239", "libasound.so.2.0.0"] {
            machine.link_library(library);
        }
        machine
            .put("home/.config/openxr/1/active_runtime.json", &runtime("../../../../usr/lib/libmonado.so"));
        machine.put("usr/lib/libmonado.so", "");
        machine.put("home/.config/parafovea/config.toml", "audio.source = 'system'\n");
        for step in plan_install(&machine.data(), &machine.path("build/libparafovea.so"), false).unwrap() {
            step.apply().unwrap();
        }
        machine
    }

    fn path(&self, below: &str) -> PathBuf {
        self.folder.path().join(below)
    }

    fn data(&self) -> PathBuf {
        self.path("home/.local/share")
    }

    fn manifest(&self, half: Half) -> PathBuf {
        half.manifest_path(&self.data())
    }

    fn put(&self, below: &str, content: &str) {
        let path = self.path(below);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }

    /// A library of the system with its version, as packages have it.
    fn link_library(&self, name: &str) {
        self.put(&format!("usr/lib/{name}"), "");
        let (stem, version) = name.split_once(".so.").unwrap();
        let link = self.path(&format!("usr/lib/{stem}.so.{}", version.split('.').next().unwrap()));
        let _ = fs::remove_file(&link);
        symlink(name, link).unwrap();
    }

    fn remove(&self, path: &Path) {
        fs::remove_file(path).unwrap();
    }

    fn set(&mut self, name: &'static str, value: &str) {
        self.variables.push((name, value.into()));
    }

    fn surroundings(&self) -> Surroundings {
        let variables = self.variables.iter().map(|(name, value)| (OsString::from(name), value.clone()));
        let mut surroundings = Surroundings::new(self.folder.path(), variables);
        surroundings.shipped = Some(self.path("build/libparafovea.so"));
        surroundings.probed = self.probed.clone();
        surroundings
    }

    /// Findings other than good ones.
    fn findings(&self) -> Vec<Finding> {
        let is_bad = |finding: &Finding| finding.severity > Severity::Good;
        examine(&self.surroundings()).into_iter().filter(is_bad).collect()
    }

    fn ids(&self) -> Vec<&'static str> {
        self.findings().iter().map(|finding| finding.id).collect()
    }
}

fn library(version: &str) -> String {
    let [openxr, vulkan] = Half::BOTH.map(Half::negotiate);
    format!("\u{7f}ELF {version} {openxr}\0{vulkan}\0")
}

fn runtime(library: &str) -> String {
    format!("{{\"file_format_version\": \"1.0.0\", \"runtime\": {{\"library_path\": \"{library}\"}}}}")
}

/// Answers where all is well.
fn probed() -> Probed {
    let layers = |half: Half| Some(vec![half.layer_name().to_owned()]);
    let created = |has_layer| CreatedDevice { name: "A GPU".to_owned(), failure: None, has_layer };
    Probed {
        layers: Ok(LoaderLayers { openxr: layers(Half::OpenXr), vulkan: layers(Half::Vulkan) }),
        vulkan: Ok(VulkanAnswer {
            version: [1, 3, 239],
            devices: vec![Device {
                name: "A GPU".to_owned(),
                rates: ["1x1", "2x2", "4x4", "4x2"].map(str::to_owned).to_vec(),
                texel: [[8, 8], [16, 16]],
                layered: true,
                samples: 4,
                ..Device::default()
            }],
        }),
        created: Ok(vec![created(true)]),
        created_without_layer: Ok(vec![created(false)]),
        openxr: Ok(RuntimeAnswer {
            name: "Monado".to_owned(),
            extensions: ["XR_KHR_vulkan_enable2", "XR_EXT_eye_gaze_interaction"].map(str::to_owned).to_vec(),
            system: Some("A headset".to_owned()),
            tracks_eyes: Some(true),
            ..RuntimeAnswer::default()
        }),
    }
}

#[test]
fn a_healthy_machine_has_nothing_to_do() {
    let machine = Machine::new();
    assert_eq!(machine.findings(), []);
    let good: Vec<_> = examine(&machine.surroundings()).into_iter().map(|finding| finding.found).collect();
    for expected in [
        "OpenXR loader 1.0.20: ",
        "Vulkan loader 1.3.239: ",
        "OpenXR runtime: Monado ",
        "A GPU supports shading rates up to 4x4, in tiles of 8 to 16 pixels, with a layer for each eye, and up to 4 samples per pixel",
        "A GPU: a device was created with the layer",
        "A headset is connected and tracks eyes",
        "configuration: ",
        "logs: ",
    ] {
        assert!(good.iter().any(|found| found.starts_with(expected)), "{expected} in {good:#?}");
    }
}

#[test]
fn impossible_checks_are_named_and_are_no_fault() {
    let mut machine = Machine::new();
    machine.probed = Probed::default();
    let findings = machine.findings();
    assert_eq!(findings.len(), 3);
    assert!(
        findings.iter().all(|finding| finding.id == "cannot-check" && finding.severity == Severity::Note)
    );
}

/// A player with several files needs to know which of them to edit.
#[test]
fn findings_about_a_setting_name_its_file() {
    for (text, id) in [("enabled = false", "turned-off"), ("[audio]\nsource = 'file'", "file-missing")] {
        let machine = Machine::new();
        machine.put("home/.config/parafovea/config.toml", text);
        let findings = machine.findings();
        let finding = findings.iter().find(|finding| finding.id == id).unwrap();
        assert!(finding.found.contains("/.config/parafovea/config.toml: "), "{finding:?}");
    }
}

/// As RADV answers on RDNA2.
#[test]
fn capabilities_and_quirks_of_the_gpu_are_reported() {
    let mut machine = Machine::new();
    *machine.probed.vulkan.as_mut().unwrap().devices.first_mut().unwrap() = Device {
        name: "AMD Radeon RX 6800 (RADV NAVI21)".to_owned(),
        driver_id: 3,
        driver_version: [25, 0, 7],
        rates: ["2x2", "2x1", "1x2", "1x1"].map(str::to_owned).to_vec(),
        texel: [[8, 8]; 2],
        samples: 8,
        ..Device::default()
    };
    let found: Vec<_> = machine.findings().into_iter().map(|finding| (finding.id, finding.found)).collect();
    assert_eq!(
        found[0],
        (
            "shading-rates",
            "AMD Radeon RX 6800 (RADV NAVI21) supports shading rates up to 2x2, in tiles of 8 pixels, with one layer for both eyes, and up to 8 samples per pixel".to_owned()
        )
    );
    let quirks = |found: &[(&str, String)]| found.iter().filter(|(id, _)| *id == "quirk").count();
    assert_eq!(quirks(&found), 4, "{found:#?}");
    machine.set("PARAFOVEA_QUIRKS", "-first-layer-only,mistyped");
    let found: Vec<_> = machine.findings().into_iter().map(|finding| (finding.id, finding.found)).collect();
    assert_eq!(quirks(&found), 3, "{found:#?}");
    assert!(
        found.iter().any(|(id, found)| *id == "unknown-quirk" && found.contains("mistyped")),
        "{found:#?}"
    );
}

#[test]
fn an_unversioned_loader_and_a_runtime_of_the_environment_are_fine() {
    let mut machine = Machine::new();
    machine.remove(&machine.path("usr/lib/libvulkan.so.1"));
    machine.put("usr/lib/libvulkan.so.1", "");
    machine.put("elsewhere/wivrn.json", &runtime("libmonado.so"));
    let named = machine.path("elsewhere/wivrn.json");
    machine.set("XR_RUNTIME_JSON", named.to_str().unwrap());
    assert_eq!(machine.findings(), []);
}

#[test]
fn other_layers_are_told_in_the_order_of_the_loaders() {
    let machine = Machine::new();
    machine.put(
        "home/.local/share/vulkan/implicit_layer.d/a.json",
        r#"{"file_format_version": "1.0.0", "layer": {"name": "VK_LAYER_other", "library_path": "x.so", "disable_environment": {"NO": "1"}}}"#,
    );
    machine.put(
        "usr/share/vulkan/implicit_layer.d/b.json",
        r#"{"file_format_version": "1.0.0", "layer": {"name": "VK_LAYER_off", "library_path": "x.so", "enable_environment": {"YES": "1"}, "disable_environment": {"NO": "1"}}}"#,
    );
    let findings = machine.findings();
    assert_eq!(findings.len(), 1, "{findings:#?}");
    assert_eq!((findings[0].id, findings[0].severity), ("other-layers", Severity::Note));
    assert_eq!(findings[0].found, "Vulkan layers, in order from the game: VK_LAYER_other, Parafovea");
}

#[test]
fn steam_gets_its_launch_options() {
    let machine = Machine::new();
    machine.put("home/.steam/steam.pid", "");
    let advice = |machine: &Machine| machine.findings()[0].advice.clone();
    assert!(advice(&machine).starts_with("launch options: PARAFOVEA=1 %command% "), "{}", advice(&machine));
    for half in Half::BOTH {
        let system = half.manifest_path(&machine.path("usr/share"));
        fs::create_dir_all(system.parent().unwrap()).unwrap();
        fs::rename(machine.manifest(half), system).unwrap();
    }
    assert!(
        advice(&machine).contains("PRESSURE_VESSEL_IMPORT_OPENXR_1_LAYERS=1 %command%"),
        "{}",
        advice(&machine)
    );
}

/// `parafovea install --system`, and a new build since then.
#[test]
fn an_outdated_installation_of_all_users_is_found_with_its_whole_command() {
    let machine = Machine::new();
    for half in Half::BOTH {
        machine.remove(&machine.manifest(half));
    }
    let system = machine.path("usr/local/share");
    for step in plan_install(&system, &machine.path("build/libparafovea.so"), true).unwrap() {
        step.apply().unwrap();
    }
    assert_eq!(machine.findings(), []);
    machine.put("build/libparafovea.so", &library("2"));
    let mut surroundings = machine.surroundings();
    surroundings.program = "/opt/build/parafovea".into();
    let findings = examine(&surroundings);
    let found = findings.iter().find(|finding| finding.id == "outdated").unwrap();
    assert_eq!((found.advice.as_str(), &found.fix), ("sudo /opt/build/parafovea install --system", &None));
    let elsewhere = installed_elsewhere(&surroundings, &machine.data());
    assert_eq!(elsewhere.len(), 2);
    let command = removal(&surroundings, elsewhere.iter().map(PathBuf::as_path));
    assert_eq!(command, "sudo /opt/build/parafovea uninstall --system");
    let all = [machine.manifest(Half::Vulkan), Half::Vulkan.manifest_path(&machine.path("usr/share"))];
    let command = removal(&surroundings, all.iter().map(PathBuf::as_path));
    assert_eq!(command, "parafovea uninstall, or the package manager of the system");
}

#[test]
fn libraries_in_other_folders_are_no_problem() {
    let machine = Machine::new();
    for library in ["libvulkan.so.1", "libvulkan.so.1.3.239", "libasound.so.2", "libasound.so.2.0.0"] {
        machine.remove(&machine.path("usr/lib").join(library));
    }
    let findings = machine.findings();
    let problems: Vec<_> = findings.iter().filter(|finding| finding.severity == Severity::Problem).collect();
    assert!(problems.is_empty(), "{problems:?}");
}

#[test]
fn a_missing_vulkan_loader_is_a_problem() {
    let mut machine = Machine::new();
    machine.remove(&machine.path("usr/lib/libvulkan.so.1"));
    machine.probed.vulkan = Err("libvulkan.so.1: cannot open shared object file".to_owned());
    let findings = machine.findings();
    let found = findings.iter().find(|finding| finding.id == "no-vulkan-loader").unwrap();
    assert!(found.severity == Severity::Problem && found.advice.contains("libvulkan1"), "{found:?}");
}
