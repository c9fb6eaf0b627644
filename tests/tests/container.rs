//! As in a container such as Steam's pressure-vessel: only the home is of the user's machine, the environment is the
//! container's, and stderr is closed.

use parafovea_tests::artifacts::{Library, program, system_program};
use parafovea_tests::installation::{Driver, Halves, Installation};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use parafovea_trial::{Lack, skip};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// Shell script that runs a command with a read-only `/usr` and closed stderr.
const INSIDE: &str = "mount --bind /usr /usr && mount -o remount,ro,bind /usr && exec \"$@\" 2>&-";
/// Shell script for machines without namespaces.
const OUTSIDE: &str = "exec \"$@\" 2>&-";

struct Container {
    folder: TempDir,
    environment: Vec<(&'static str, OsString)>,
    has_namespaces: bool,
}

impl Container {
    /// With the layer installed as the command does it.
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        let home = folder.path().join("player");
        fs::create_dir(&home).unwrap();
        let installation = Installation::new(folder.path(), &Halves::default()).unwrap();
        let scenario = folder.path().join("scenario.toml");
        fs::write(&scenario, toml::to_string(&Scenario::new(20).sized(64, 64)).unwrap()).unwrap();
        // All other variables of the loaders and of the user are unset.
        let mut environment = installation.mock_environment(Driver::Lavapipe).unwrap();
        environment.extend([
            ("HOME", home.clone().into_os_string()),
            ("PATH", "/usr/bin:/bin".into()),
            ("PARAFOVEA_MOCK_SCENARIO", scenario.into()),
            ("container", "pressure-vessel".into()),
            ("XDG_RUNTIME_DIR", folder.path().join("run").into()),
        ]);
        environment.extend(std::env::var_os("LD_LIBRARY_PATH").map(|path| ("LD_LIBRARY_PATH", path)));
        let try_mount = ["-rm", "sh", "-c", "mount --bind /usr /usr && mount -o remount,ro,bind /usr"];
        let has_namespaces =
            Command::new("unshare").args(try_mount).output().is_ok_and(|o| o.status.success());
        if !has_namespaces {
            println!("without a read-only /usr: no namespaces for unprivileged users, or no unshare");
        }
        let container = Self { folder, environment, has_namespaces };
        let mut install = container.command(&program("parafovea").unwrap());
        let output = install.arg("install").arg("--library").arg(Library::Parafovea.path().unwrap()).output();
        assert!(output.unwrap().status.success());
        container
    }

    fn home(&self) -> PathBuf {
        self.folder.path().join("player")
    }

    fn command(&self, program: &Path) -> Command {
        let mut command = Command::new(program);
        command.current_dir(self.folder.path()).env_clear().envs(self.environment.iter().cloned());
        command
    }

    fn log(&self) -> String {
        fs::read_to_string(self.home().join(".local/state/parafovea/hello_xr.log")).unwrap_or_default()
    }

    /// Runs hello_xr, and returns with it the lines that it added to the log.
    fn play(&self) -> (Output, String) {
        let before = self.log().len();
        let [unshare, sh] = ["unshare", "sh"].map(|name| system_program(name).unwrap());
        let mut command = self.command(if self.has_namespaces { &unshare } else { &sh });
        if self.has_namespaces {
            command.args(["-rm", "sh"]);
        }
        command.args([
            "-c",
            if self.has_namespaces { INSIDE } else { OUTSIDE },
            "sh",
            "hello_xr",
            "-g",
            "Vulkan2",
        ]);
        // hello_xr ends with its standard input.
        command.env("PARAFOVEA", "1").stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let _input = child.stdin.take();
        let output = child.wait_with_output().unwrap();
        (output, self.log()[before..].to_owned())
    }

    fn manifest(&self, path: &str) -> PathBuf {
        self.home().join(".local/share").join(path)
    }
}

#[test]
fn a_game_in_a_container_has_the_layer_and_without_one_half_it_runs_as_it_is() {
    if system_program("hello_xr").is_err() {
        skip(&Lack::setup("hello_xr"));
    }
    let container = Container::new();
    let (output, log) = container.play();
    assert!(output.status.success() && log.contains("session active"), "{output:?}\n{log}");
    assert!(container.home().join(".local/state/parafovea/running").is_dir(), "no status outside: {log}");

    let vulkan = container.manifest("vulkan/implicit_layer.d");
    fs::rename(&vulkan, vulkan.with_extension("away")).unwrap();
    let (output, log) = container.play();
    assert!(output.status.success() && log.contains("session inert"), "{output:?}\n{log}");

    fs::rename(vulkan.with_extension("away"), &vulkan).unwrap();
    let openxr = container.manifest("openxr/1/api_layers/implicit.d");
    fs::rename(&openxr, openxr.with_extension("away")).unwrap();
    let (output, log) = container.play();
    assert!(output.status.success() && !log.contains("session"), "{output:?}\n{log}");
}
