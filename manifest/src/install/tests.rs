use super::*;
use serde_json::Value;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use tempfile::TempDir;

/// A folder with a library as a build leaves it, and an empty data home.
struct Machine {
    folder: TempDir,
}

impl Machine {
    fn new() -> Self {
        let machine = Self { folder: TempDir::new().unwrap() };
        fs::write(machine.built(), library("1")).unwrap();
        machine
    }

    fn built(&self) -> PathBuf {
        self.folder.path().join("built.so")
    }

    fn data(&self) -> PathBuf {
        self.folder.path().join("share")
    }

    fn install(&self) -> Vec<Step> {
        apply(plan_install(&self.data(), &self.built(), false).unwrap())
    }

    fn uninstall(&self) -> Vec<Step> {
        apply(plan_uninstall(&self.data()).unwrap().steps)
    }

    fn put(&self, path: &Path, content: &str) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }
}

fn apply(steps: Vec<Step>) -> Vec<Step> {
    steps.iter().for_each(|step| step.apply().unwrap());
    steps
}

fn library(version: &str) -> String {
    let [openxr, vulkan] = Half::BOTH.map(Half::negotiate);
    format!("\u{7f}ELF {version} {openxr}\0{vulkan}\0")
}

/// All files below `folder`.
fn files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut found: Vec<_> = entries
        .flat_map(|entry| {
            let path = entry.unwrap().path();
            if path.is_dir() { files(&path) } else { vec![path] }
        })
        .collect();
    found.sort();
    found
}

#[test]
fn both_manifests_name_the_one_copy_of_the_library() {
    let machine = Machine::new();
    machine.install();
    let data = machine.data();
    let installed = library_path(&data);
    let mut expected =
        [installed.clone(), Half::OpenXr.manifest_path(&data), Half::Vulkan.manifest_path(&data)];
    expected.sort();
    assert_eq!(files(&data), expected);
    for (half, section) in [(Half::OpenXr, "api_layer"), (Half::Vulkan, "layer")] {
        let path = half.manifest_path(&data);
        let manifest: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        assert_eq!(manifest[section]["library_path"], installed.to_str().unwrap());
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o644);
    }
    assert_eq!(fs::read(&installed).unwrap(), fs::read(machine.built()).unwrap());
}

#[test]
fn installing_again_changes_nothing_and_an_update_changes_what_is_new() {
    let machine = Machine::new();
    assert_eq!(machine.install().len(), 3);
    assert_eq!(machine.install(), []);

    let inode = || fs::metadata(library_path(&machine.data())).unwrap().ino();
    let before = inode();
    fs::write(machine.built(), library("2")).unwrap();
    assert_eq!(machine.install(), [Step::Copy { from: machine.built(), to: library_path(&machine.data()) }]);
    // A running game has the former file mapped: it must not change under it.
    assert_ne!(inode(), before);

    let manifest = Half::Vulkan.manifest_path(&machine.data());
    machine.put(&manifest, &Half::Vulkan.manifest("/elsewhere.so", Activation::Implicit));
    assert_eq!(machine.install().len(), 1);
    assert_eq!(machine.install(), []);
}

#[test]
fn uninstalling_leaves_everything_else() {
    let machine = Machine::new();
    let others = ["openxr/1/api_layers/implicit.d/other.json", "vulkan/implicit_layer.d/other.json"];
    others.iter().for_each(|other| machine.put(&machine.data().join(other), "{}"));
    machine.install();
    assert_eq!(machine.uninstall().len(), 3);
    assert_eq!(files(&machine.data()), others.map(|other| machine.data().join(other)));
    assert!(!machine.data().join("parafovea").exists());
    assert_eq!(machine.uninstall(), []);

    machine.install();
    machine.put(&machine.data().join("parafovea/notes.txt"), "mine");
    machine.uninstall();
    assert!(machine.data().join("parafovea/notes.txt").exists());
}

/// All files and folders below `folder`.
fn tree(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut found: Vec<_> = entries
        .flat_map(|path| {
            let below = if path.is_dir() { tree(&path) } else { Vec::new() };
            [vec![path], below].concat()
        })
        .collect();
    found.sort();
    found
}

#[test]
fn uninstalling_leaves_the_tree_as_it_was() {
    let machine = Machine::new();
    fs::write(machine.folder.path().join(AUDIO_LIBRARY_NAME), "\u{7f}ELF parafovea_audio_get_table\0")
        .unwrap();
    fs::create_dir_all(machine.data()).unwrap();
    let check = || {
        let before = tree(machine.folder.path());
        machine.install();
        assert_eq!(tree(&machine.data()).len(), 11, "{:?}", tree(&machine.data()));
        machine.uninstall();
        assert_eq!(tree(machine.folder.path()), before);
    };
    check();
}

#[test]
fn folders_with_something_else_in_them_stay() {
    let machine = Machine::new();
    machine.put(&machine.data().join("vulkan/icd.d/driver.json"), "{}");
    machine.put(&machine.data().join("openxr/1/api_layers/explicit.d/other.json"), "{}");
    let before = tree(machine.folder.path());
    machine.install();
    assert_ne!(tree(machine.folder.path()), before);
    machine.uninstall();
    assert_eq!(tree(machine.folder.path()), before);
}

#[test]
fn the_sound_capture_library_is_installed_from_beside_the_layer_and_goes_with_it() {
    let machine = Machine::new();
    let built = machine.folder.path().join(AUDIO_LIBRARY_NAME);
    let installed = audio_library_path(&machine.data());
    let audio = |version: &str| format!("\u{7f}ELF {version} parafovea_audio_get_table\0");
    fs::write(&built, audio("1")).unwrap();
    assert_eq!(machine.install().len(), 4);
    assert_eq!(installed.parent(), library_path(&machine.data()).parent());
    assert_eq!(fs::read_to_string(&installed).unwrap(), audio("1"));
    assert_eq!(machine.install(), []);

    fs::write(&built, audio("2")).unwrap();
    assert_eq!(machine.install(), [Step::Copy { from: built.clone(), to: installed.clone() }]);
    fs::remove_file(&built).unwrap();
    assert_eq!(
        machine.install(),
        [remove(&machine.data(), installed.clone())],
        "one of another build stays behind"
    );

    fs::write(&built, audio("3")).unwrap();
    machine.install();
    assert_eq!(machine.uninstall().len(), 4);
    assert!(!installed.exists() && !machine.data().join("parafovea").exists());

    fs::write(&built, "not a library").unwrap();
    assert!(matches!(
        plan_install(&machine.data(), &machine.built(), false),
        Err(InstallError::NotTheLayer(_))
    ));
    fs::remove_file(&built).unwrap();
    machine.put(&installed, "mine");
    assert!(matches!(plan_install(&machine.data(), &machine.built(), false), Err(InstallError::NotOurs(_))));
    let removal = plan_uninstall(&machine.data()).unwrap();
    assert_eq!(removal, Removal { steps: Vec::new(), kept: vec![installed] });
}

#[test]
fn a_plan_alone_changes_nothing() {
    let machine = Machine::new();
    let steps = plan_install(&machine.data(), &machine.built(), false).unwrap();
    assert!(!machine.data().exists());
    let said: Vec<_> = steps.iter().map(Step::to_string).collect();
    let data = machine.data().display().to_string();
    assert_eq!(said[0], format!("copy {} to {data}/parafovea/libparafovea.so", machine.built().display()));
    assert_eq!(said[1], format!("write {data}/openxr/1/api_layers/implicit.d/parafovea.json"));
    assert_eq!(said[2], format!("write {data}/vulkan/implicit_layer.d/parafovea.json"));
}

/// Files in each of our places, one at a time: the others are removed nevertheless.
#[test]
fn foreign_files_are_neither_replaced_nor_removed() {
    let places = [
        |data: &Path| Half::OpenXr.manifest_path(data),
        |data: &Path| Half::Vulkan.manifest_path(data),
        |data: &Path| library_path(data),
    ];
    for place in places {
        for content in ["", "{\"layer\": {\"name\": \"VK_LAYER_other\"}}"] {
            let machine = Machine::new();
            machine.install();
            let path = place(&machine.data());
            machine.put(&path, content);
            let plan = plan_install(&machine.data(), &machine.built(), false);
            assert!(matches!(plan, Err(InstallError::NotOurs(named)) if named == path));
            let removal = plan_uninstall(&machine.data()).unwrap();
            assert_eq!(removal.kept, std::slice::from_ref(&path));
            assert_eq!(apply(removal.steps).len(), 2);
            assert_eq!(fs::read_to_string(&path).unwrap(), content);
            assert_eq!(files(&machine.data()), [path]);
        }
    }
    let machine = Machine::new();
    let folder = Half::Vulkan.manifest_path(&machine.data());
    fs::create_dir_all(&folder).unwrap();
    assert_eq!(plan_uninstall(&machine.data()).unwrap(), Removal { steps: Vec::new(), kept: vec![folder] });
}

#[test]
fn a_link_in_our_place_is_not_followed() {
    let machine = Machine::new();
    machine.install();
    let (manifest, elsewhere) =
        (Half::Vulkan.manifest_path(&machine.data()), machine.folder.path().join("kept"));
    fs::rename(&manifest, &elsewhere).unwrap();
    std::os::unix::fs::symlink(&elsewhere, &manifest).unwrap();
    assert_eq!(plan_uninstall(&machine.data()).unwrap().kept, [manifest]);
}

#[test]
fn only_the_layer_is_installed() {
    let machine = Machine::new();
    let missing = machine.folder.path().join("missing.so");
    let message = plan_install(&machine.data(), &missing, false).unwrap_err().to_string();
    assert_eq!(message, format!("{}: No such file or directory (os error 2)", missing.display()));
    for content in ["", "text", "\u{7f}ELF but of something else"] {
        fs::write(machine.built(), content).unwrap();
        let message = plan_install(&machine.data(), &machine.built(), false).unwrap_err().to_string();
        assert_eq!(message, format!("{}: not a Parafovea library", machine.built().display()));
    }
    assert!(!machine.data().exists());
}

#[test]
fn a_stage_has_the_halves_that_were_asked_for() {
    let machine = Machine::new();
    stage(&machine.data(), Half::Vulkan, Path::new("/build/libparafovea.so"), false).unwrap();
    let path = Half::Vulkan.manifest_path(&machine.data());
    assert_eq!(files(&machine.data()), std::slice::from_ref(&path));
    let text = fs::read_to_string(path).unwrap();
    assert_eq!(text, Half::Vulkan.manifest("/build/libparafovea.so", Activation::Implicit));
}

/// The umask is of a whole process, so this test runs itself in another one.
#[test]
fn an_installation_for_all_users_can_be_read_by_all() {
    let name = "install::tests::an_installation_for_all_users_can_be_read_by_all";
    let Some(folder) = std::env::var_os("PARAFOVEA_TEST_FOLDER").map(PathBuf::from) else {
        let machine = Machine::new();
        let done = std::process::Command::new("sh")
            .args(["-c", "umask 077; exec \"$0\" --exact \"$1\""])
            .arg(std::env::current_exe().unwrap())
            .arg(name)
            .env("PARAFOVEA_TEST_FOLDER", machine.folder.path())
            .output()
            .unwrap();
        assert!(done.status.success(), "{done:?}");
        assert!(machine.folder.path().join("all/data/parafovea").exists(), "{done:?}");
        return;
    };
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    for (data, [library, text, below]) in
        [("all/data", [0o755, 0o644, 0o755]), ("user/data", [0o700, 0o600, 0o700])]
    {
        let data = folder.join(data);
        fs::create_dir(data.parent().unwrap()).unwrap();
        for step in plan_install(&data, &folder.join("built.so"), true).unwrap() {
            match library {
                0o755 => step.apply_for_all_users().unwrap(),
                _ => step.apply().unwrap(),
            }
        }
        assert_eq!(mode(data.parent().unwrap()), 0o700, "a folder that was there keeps its permissions");
        for path in tree(&data).into_iter().chain([data.clone()]) {
            let expected = match path.extension().and_then(|extension| extension.to_str()) {
                Some("so") => library,
                Some("json") => text,
                _ => below,
            };
            assert_eq!(mode(&path), expected, "{}", path.display());
        }
    }
}
