//! The unpacked system: its content, and how programs run in it.

use super::Engine;
use super::engine::{Mode, Settings};
use super::pictures;
use super::seen::Seen;
use crate::HarnessError;
use crate::artifacts::{Library, program};
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{Status, read_all};
use parafovea_models::errors::Clip;
use parafovea_test_layers::validation::VALIDATION_LAYER;
use parafovea_test_layers::{
    CAPTURE_FOLDER_VARIABLE, CAPTURE_LAYER, SAMPLES_FILE_VARIABLE, TestLayer, capture_manifest,
};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, SystemTime};

/// An engine that takes longer hangs.
const LIMIT_S: u32 = 600;

/// Interval between reads of the layer's status.
const POLL: Duration = Duration::from_millis(300);

/// Counts or checks of a run, beside time.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Watch {
    /// Nothing.
    Time,
    /// Samples of the application's render passes.
    Samples,
    /// The pictures of the first round.
    Pictures,
    /// Valid usage, with synchronization.
    Validation,
}

/// The folder of saved pictures in the system.
const PICTURES: &str = "tmp/pictures";

/// The gaze of an eye tracker in the system.
const GAZE: &str = "opt/engines/gaze.csv";

/// Number of reads of the layer's status from one `parafovea status` to the next.
const POLLS_PER_TEXT: u32 = 10;

/// Enters the system with the kernel's folders for as long as a program runs: its folder, the program, its arguments.
const ENTER: &str = r#"mount --bind /proc "$0/proc" && mount --bind /dev "$0/dev" && exec chroot "$0" "$@""#;

/// The system in its folder.
pub struct System {
    root: PathBuf,
}

impl System {
    /// Puts the layer, the layers of tests and the engines' scenes into the system at `root`.
    ///
    /// # Errors
    /// [`HarnessError::NotBuilt`], and errors of files and of `parafovea install`.
    pub fn filled(root: &Path) -> Result<Self, HarnessError> {
        let root = &fs::canonicalize(root).map_err(HarnessError::file(root))?;
        let system = Self { root: root.clone() };
        let [own, layers] = ["opt/parafovea", "opt/layers"].map(|folder| root.join(folder));
        copy(&Library::Parafovea.path()?, &own.join("libparafovea.so"))?;
        copy(&program("parafovea")?, &own.join("parafovea"))?;
        copy(&Library::TestLayers.path()?, &layers.join("libparafovea_test_layers.so"))?;
        let library = Path::new("/opt/layers/libparafovea_test_layers.so");
        let manifests = root.join("root/.local/share/vulkan/explicit_layer.d");
        TestLayer::write_manifests(library, &manifests).map_err(HarnessError::file(&manifests))?;
        write(&layers.join("capture.json"), &capture_manifest(library))?;
        // Implicit layers from the configuration folder come above those from the data folder, and so this above ours: it informs the
        // sample-counting layer which passes are the application's.
        let above = root.join("root/.config/vulkan/implicit_layer.d/count.json");
        write(&above, &TestLayer::Count.implicit_manifest(library))?;
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("engines");
        copy(&scenes.join("run.sh"), &root.join("opt/engines/run.sh"))?;
        // MangoHud ends the application without it.
        let devices = root.join("sys/class/drm");
        fs::create_dir_all(&devices).map_err(HarnessError::file(&devices))?;
        for engine in ["godot", "qt"] {
            let (from, to) = (scenes.join(engine), root.join("opt/engines").join(engine));
            for entry in fs::read_dir(&from).map_err(HarnessError::file(&from))?.flatten() {
                copy(&entry.path(), &to.join(entry.file_name()))?;
            }
        }
        let mut install = system.inside();
        install.args(["env", "HOME=/root", "/opt/parafovea/parafovea", "install"]);
        let output = install.output().map_err(start_error(&install))?;
        if !output.status.success() {
            return Err(HarnessError::Application {
                application: "parafovea install".to_owned(),
                reason: output.status.to_string(),
                output: String::from_utf8_lossy(&output.stderr).into_owned(),
            });
        }
        Ok(system)
    }

    /// Runs an engine to its end.
    ///
    /// # Errors
    /// The engine does not finish, or does not print the cost of its frames.
    pub fn run(
        &self,
        engine: Engine,
        mode: Mode,
        settings: &Settings,
        watch: Watch,
    ) -> Result<Seen, HarnessError> {
        let config = self.root.join("root/.config/parafovea/config.toml");
        let gaze = engine.gaze();
        write(&self.root.join(GAZE), gaze.as_deref().unwrap_or_default())?;
        let file = format!("/{GAZE}");
        write(&config, &mode.config(engine.preset, gaze.is_some().then_some(&file)).unwrap_or_default())?;
        let mut command = self.inside();
        command.args(["bash", "/opt/engines/run.sh", &LIMIT_S.to_string(), "env"]);
        command.arg(format!("OXR_VIEWPORT_SCALE_PERCENTAGE={}", settings.scale));
        match watch {
            Watch::Time => {}
            Watch::Samples => {
                command.arg(format!("VK_INSTANCE_LAYERS={}", TestLayer::Samples.name()));
                command.arg(format!("{}=1", TestLayer::Count.implicit_variable()));
                command.arg(format!("{SAMPLES_FILE_VARIABLE}=/tmp/samples.jsonl"));
            }
            Watch::Pictures => {
                let folder = self.root.join(PICTURES);
                // Of an earlier run, if there was one.
                let _ = fs::remove_dir_all(&folder);
                fs::create_dir_all(&folder).map_err(HarnessError::file(&folder))?;
                command.arg("XR_API_LAYER_PATH=/opt/layers");
                command.arg(format!("XR_ENABLE_API_LAYERS={CAPTURE_LAYER}"));
                command.arg(format!("{CAPTURE_FOLDER_VARIABLE}=/{PICTURES}"));
            }
            Watch::Validation => {
                command.arg(format!("VK_INSTANCE_LAYERS={VALIDATION_LAYER}"));
                command.arg("VK_KHRONOS_VALIDATION_VALIDATE_SYNC=true");
            }
        }
        if mode != Mode::Off {
            command.args(["/opt/parafovea/parafovea", "run", "--"]);
        }
        let folder = format!("/{PICTURES}");
        command.arg("env").args(engine.command(settings, (watch == Watch::Pictures).then_some(&folder)));
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = command.spawn().map_err(start_error(&command))?;
        let (mut status, mut told, mut polls) = (None, None, 0_u32);
        let mut has_overlays = !engine.has_overlays;
        let ended = loop {
            has_overlays = has_overlays || a_process_has(&OVERLAYS);
            if let Some(found) = self.status() {
                status = Some(found);
                polls += 1;
                if polls.is_multiple_of(POLLS_PER_TEXT) {
                    told = self.status_text();
                }
            }
            match child.try_wait() {
                Ok(Some(ended)) => break ended,
                Ok(None) => std::thread::sleep(POLL),
                Err(error) => return Err(start_error(&command)(error)),
            }
        };
        let output = self.read("tmp/output.log");
        let failed = |reason: String| HarnessError::Application {
            application: format!("{}, {}", engine.name(), mode.name()),
            reason,
            output: output.lines().rev().take(20).collect::<Vec<_>>().join("\n"),
        };
        if !ended.success() {
            return Err(failed(ended.to_string()));
        }
        if !has_overlays {
            return Err(failed(format!("no process had {OVERLAYS:?} loaded")));
        }
        let log = self.log();
        let samples = self.read("tmp/samples.jsonl");
        let seen = Seen::of(&output, &log, &samples, status).map_err(failed)?;
        Ok(Seen { told: told.unwrap_or_default(), ..seen })
    }

    /// Pictures of the last run that saved any, of so many frames.
    ///
    /// # Errors
    /// An image is missing.
    pub fn pictures(&self, frames: u32) -> Result<Clip, HarnessError> {
        pictures::clip(&self.root.join(PICTURES), frames)
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    fn inside(&self) -> Command {
        let mut command = Command::new("unshare");
        command.args(["--mount", "sh", "-c", ENTER]).arg(&self.root);
        command
    }

    /// The layer's status; None if it writes none.
    fn status(&self) -> Option<Status> {
        let folder = self.root.join("run/monado");
        let environment =
            Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| folder.clone().into()));
        let found = read_all(&environment, SystemTime::now()).found;
        found.into_iter().next().map(|found| found.status)
    }

    /// The text of `parafovea status`; None where it fails.
    fn status_text(&self) -> Option<String> {
        let mut command = self.inside();
        command.args([
            "env",
            "HOME=/root",
            "XDG_RUNTIME_DIR=/run/monado",
            "/opt/parafovea/parafovea",
            "status",
            "--once",
        ]);
        let output = command.stdin(Stdio::null()).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
    }

    fn log(&self) -> String {
        let files =
            fs::read_dir(self.root.join("root/.local/state/parafovea")).into_iter().flatten().flatten();
        files
            .map(|file| String::from_utf8_lossy(&fs::read(file.path()).unwrap_or_default()).into_owned())
            .collect()
    }

    fn read(&self, path: &str) -> String {
        String::from_utf8_lossy(&fs::read(self.root.join(path)).unwrap_or_default()).into_owned()
    }
}

/// Libraries of MangoHud and vkBasalt.
const OVERLAYS: [&str; 2] = ["libMangoHud.so", "libvkbasalt.so"];

/// Whether a process of this machine has all of these libraries loaded.
fn a_process_has(libraries: &[&str]) -> bool {
    let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
    let mut maps = processes.filter_map(|process| fs::read_to_string(process.path().join("maps")).ok());
    maps.any(|maps| libraries.iter().all(|library| maps.contains(library)))
}

fn copy(from: &Path, to: &Path) -> Result<(), HarnessError> {
    make_parent(to)?;
    fs::copy(from, to).map(drop).map_err(HarnessError::file(from))
}

fn write(path: &Path, text: &str) -> Result<(), HarnessError> {
    make_parent(path)?;
    fs::write(path, text).map_err(HarnessError::file(path))
}

fn make_parent(path: &Path) -> Result<(), HarnessError> {
    path.parent().map_or(Ok(()), |folder| fs::create_dir_all(folder).map_err(HarnessError::file(folder)))
}

fn start_error(command: &Command) -> impl FnOnce(std::io::Error) -> HarnessError + use<> {
    let program = PathBuf::from(command.get_program());
    move |source| HarnessError::Start { program, source }
}
