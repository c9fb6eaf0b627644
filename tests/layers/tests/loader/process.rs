//! Starts a program of [`crate::programs`] with layers around it.

use parafovea_test_layers::TestLayer;
use parafovea_test_layers::validation::{VALIDATION_LAYER, settings};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use tempfile::TempDir;

/// A library that this build made; Cargo leaves it beside the test binaries.
pub fn library(name: &str) -> PathBuf {
    let binary = std::env::current_exe().unwrap();
    let path = binary.parent().unwrap().join(name);
    assert!(path.exists(), "{} is not built", path.display());
    path
}

/// A process to be started, in a folder of its own.
pub struct Process {
    pub folder: TempDir,
    command: Command,
    layers: Vec<String>,
}

/// Its end.
pub struct Ended {
    /// Output of the program itself, on the line that starts with `result `.
    pub result: String,
    /// Errors and warnings of the validation layer.
    pub findings: Vec<String>,
    /// The whole output.
    pub output: String,
    folder: TempDir,
}

impl Process {
    pub fn new(program: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let layers = folder.path().join("data/vulkan/explicit_layer.d");
        TestLayer::write_manifests(&library("libparafovea_test_layers.so"), &layers).unwrap();
        let mut command = Command::new(std::env::current_exe().unwrap());
        command.args(["--exact", &format!("programs::{program}"), "--ignored", "--nocapture"]);
        for variable in
            ["VK_INSTANCE_LAYERS", "VK_LAYER_PATH", "VK_LOADER_DEBUG", "PARAFOVEA", "DISABLE_PARAFOVEA"]
        {
            command.env_remove(variable);
        }
        for (variable, part) in
            [("XDG_DATA_HOME", "data"), ("XDG_CONFIG_HOME", "config"), ("XDG_STATE_HOME", "state")]
        {
            command.env(variable, folder.path().join(part));
        }
        Self { folder, command, layers: Vec::new() }
    }

    /// Puts a layer below the existing ones.
    pub fn layer(mut self, name: impl Into<String>) -> Self {
        self.layers.push(name.into());
        self
    }

    /// Puts the validation layer below the existing ones.
    pub fn validated(self) -> Self {
        let settings_file = self.path("vk_layer_settings.txt");
        std::fs::write(&settings_file, settings(&self.path("validation.txt"))).unwrap();
        self.env("VK_LAYER_SETTINGS_PATH", settings_file.to_str().unwrap()).layer(VALIDATION_LAYER)
    }

    pub fn env(mut self, variable: &str, value: &str) -> Self {
        self.command.env(variable, value);
        self
    }

    /// Sets a variable to the path of a file in the process's folder.
    pub fn file(self, variable: &str, name: &str) -> Self {
        let path = self.path(name);
        self.env(variable, path.to_str().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn run(self) -> Ended {
        let (ended, status) = self.end();
        assert!(status.success(), "{status}: {}", ended.output);
        ended
    }

    /// As [`Self::run`], for a program with invalid calls, which may crash the driver.
    pub fn run_to_the_end_or_not(self) -> Ended {
        self.end().0
    }

    fn end(mut self) -> (Ended, ExitStatus) {
        let output = self.command.env("VK_INSTANCE_LAYERS", self.layers.join(":")).output().unwrap();
        let text = [&output.stdout[..], &output.stderr[..]].map(String::from_utf8_lossy).concat();
        let result = text.lines().find_map(|line| Some(line.split_once("result ")?.1.to_owned()));
        let findings = if self.path("vk_layer_settings.txt").exists() {
            let log = std::fs::read_to_string(self.path("validation.txt")).unwrap();
            assert!(log.contains("Khronos Validation Layer Active"), "validation was not there: {text}");
            findings(&log)
        } else {
            Vec::new()
        };
        let result = result.unwrap_or_default();
        (Ended { result, findings, output: text, folder: self.folder }, output.status)
    }
}

impl Ended {
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.folder.path().join(name)).unwrap()
    }

    /// Nothing, where nothing was written.
    pub fn read_if_there(&self, name: &str) -> String {
        if self.folder.path().join(name).exists() { self.read(name) } else { String::new() }
    }
}

fn findings(log: &str) -> Vec<String> {
    let is_finding = |line: &&str| line.contains("Validation Error") || line.contains("Validation Warning");
    log.lines().filter(is_finding).map(str::to_owned).collect()
}

/// Writes an implicit layer's manifest into a folder of a base directory, such as `data` or `config`.
pub fn install_implicit(base: &Path, name: &str, manifest: &str) {
    let folder = base.join("vulkan/implicit_layer.d");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join(name), manifest).unwrap();
}
