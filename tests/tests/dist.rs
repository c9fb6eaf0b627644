//! Packages for users, installed in folders of their own.

use parafovea_manifest::json::Half;
use parafovea_tests::artifacts::{program, system_program};
use parafovea_tests::dist::{DistError, Parts, TEST_NAMES, archive, package};
use parafovea_tests::installation::{Driver, Halves, Installation};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use parafovea_trial::{Lack, skip};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// Cargo's build for this test.
fn parts() -> Parts {
    let built = program("parafovea").unwrap().parent().unwrap().to_owned();
    Parts::collect(&built, &Path::new(env!("CARGO_MANIFEST_DIR")).join("..")).unwrap()
}

fn run(command: &mut Command) -> Output {
    // hello_xr ends with its standard input.
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let _input = child.stdin.take();
    child.wait_with_output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&[&output.stdout[..], &output.stderr[..]].concat()).into_owned()
}

/// Tests run builds with debug assertions, which know these names: packing them fails.
#[test]
fn a_build_for_tests_is_not_packed() {
    match parts().check_release() {
        Err(DistError::ForTests { name: "libparafovea.so", names }) => assert_eq!(names, TEST_NAMES),
        other => panic!("{other:?}"),
    }
}

#[test]
fn hello_xr_runs_with_the_content_of_the_package() {
    let Ok(dpkg) = system_program("dpkg-deb") else {
        skip(&Lack::machine("dpkg-deb"));
    };
    let folder = TempDir::new().unwrap();
    let (root, deb) = (folder.path().join("root"), folder.path().join("parafovea.deb"));
    fs::write(&deb, package(&parts()).unwrap()).unwrap();
    let unpacked = run(Command::new(&dpkg).arg("-x").args([&deb, &root]));
    assert!(unpacked.status.success() && said(&unpacked).is_empty(), "{}", said(&unpacked));
    let told = run(Command::new(&dpkg).args(["--field"]).arg(&deb));
    assert!(
        said(&told).contains("Package: parafovea\n") && said(&told).contains("Depends: libc6 (>= 2."),
        "{}",
        said(&told)
    );

    // No text has links to missing files.
    let documents = root.join("usr/share/doc/parafovea");
    for name in ["README.md", "CHANGELOG.md", "SECURITY.md", "GUIDE.md", "HOW-IT-WORKS.md"] {
        let text = fs::read_to_string(documents.join(name)).unwrap();
        let links: Vec<_> =
            text.split("](").skip(1).filter_map(|rest| rest.split(')').next()).map(str::to_owned).collect();
        // Without the place in the file.
        let is_there = |link: &String| documents.join(link.split('#').next().unwrap_or(link)).is_file();
        let links: Vec<_> = links.into_iter().filter(|link| !link.starts_with("https://")).collect();
        assert!(
            (name == "SECURITY.md" || !links.is_empty()) && links.iter().all(is_there),
            "{name}: {links:?}"
        );
    }

    let manifest = Half::OpenXr.manifest_path(&root.join("usr/share"));
    assert!(Half::OpenXr.lists_eye_gaze(&fs::read_to_string(manifest).unwrap()));

    let installation = Installation::new(folder.path(), &Halves::default()).unwrap();
    let scenario = folder.path().join("scenario.toml");
    let text = toml::to_string(&Scenario::new(10).sized(64, 64)).unwrap();
    fs::write(&scenario, text).unwrap();
    let mut data = root.join("usr/share").into_os_string();
    data.push(":/usr/local/share:/usr/share");
    let environment: Vec<(&str, OsString)> = installation
        .private_environment(Driver::Lavapipe)
        .unwrap()
        .into_iter()
        .chain([("XDG_DATA_DIRS", data), ("PARAFOVEA_MOCK_SCENARIO", scenario.into())])
        .collect();
    let parafovea = |arguments: &[&str]| {
        let mut command = Command::new(root.join("usr/bin/parafovea"));
        command.args(arguments).current_dir(folder.path()).env_clear().envs(environment.iter().cloned());
        run(&mut command)
    };
    let ran = parafovea(&["run", "--", "hello_xr", "--graphics", "Vulkan2"]);
    let log = fs::read_to_string(installation.log_folder().join("hello_xr.log")).unwrap_or_default();
    assert!(ran.status.success() && log.contains("session active"), "{}\n{log}", said(&ran));

    // The doctor sees the same: both loaders list the layer, and the runtime answers.
    let findings: Vec<serde_json::Value> = String::from_utf8(parafovea(&["doctor", "--json"]).stdout)
        .unwrap()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let ids = |severity: &str| -> Vec<&str> {
        let of_severity = findings.iter().filter(|finding| finding["severity"] == severity);
        of_severity.filter_map(|finding| finding["id"].as_str()).collect()
    };
    assert_eq!(ids("problem"), [""; 0], "{findings:#?}");
    for id in ["installed", "runtime", "runtime-answers", "headset"] {
        assert!(ids("good").contains(&id), "{id} in {findings:#?}");
    }
    assert!(!ids("note").contains(&"cannot-check"), "{findings:#?}");
}

#[test]
fn the_archive_installs_for_one_user_and_leaves_no_trace() {
    let folder = TempDir::new().unwrap();
    let home = folder.path().join("home");
    fs::create_dir_all(home.join(".local/share/other")).unwrap();
    fs::write(home.join(".local/share/other/file"), "mine").unwrap();
    let before = files(&home);

    let packed = folder.path().join("parafovea.tar.gz");
    fs::write(&packed, archive(&parts()).unwrap()).unwrap();
    let unpacked = run(Command::new("tar").arg("-xzf").arg(&packed).arg("-C").arg(folder.path()));
    assert!(unpacked.status.success(), "{}", said(&unpacked));
    let top = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path());
    let top = top.filter(|path| path.is_dir()).find(|path| path.join("install.sh").exists()).unwrap();
    let install = |arguments: &[&str]| {
        let mut command = Command::new(top.join("install.sh"));
        command.args(arguments).env_clear().env("PATH", "/usr/bin:/bin").env("HOME", &home);
        run(&mut command)
    };
    // Beside a package, it is refused as a whole.
    let packaged = folder.path().join("usr/share");
    let mut package = Command::new(top.join("bin/parafovea"));
    package.arg("install").env_clear().env("HOME", &home).env("XDG_DATA_HOME", &packaged);
    assert!(run(&mut package).status.success());
    let mut beside = Command::new(top.join("install.sh"));
    beside.env_clear().env("PATH", "/usr/bin:/bin").env("HOME", &home).env("XDG_DATA_DIRS", &packaged);
    let refused = run(&mut beside);
    assert!(!refused.status.success() && said(&refused).contains("already installed"), "{}", said(&refused));
    assert_eq!(files(&home), before);

    let installed = install(&[]);
    assert!(installed.status.success(), "{}", said(&installed));
    assert!(said(&installed).contains(".local/bin/parafovea doctor"), "{}", said(&installed));
    for path in [
        ".local/bin/parafovea",
        ".local/share/parafovea/libparafovea.so",
        ".local/share/man/man1/parafovea.1",
    ] {
        assert!(home.join(path).is_file(), "{path}");
    }
    assert!(said(&install(&[])).contains("already installed"));
    let mut doctor = Command::new(home.join(".local/bin/parafovea"));
    let doctor =
        run(doctor.args(["doctor", "--json"]).env_clear().env("PATH", "/usr/bin:/bin").env("HOME", &home));
    assert!(said(&doctor).contains("\"id\":\"installed\""), "{}", said(&doctor));

    let removed = install(&["--uninstall"]);
    assert!(removed.status.success(), "{}", said(&removed));
    assert_eq!(files(&home), before);
}

/// All files below `folder`.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}
