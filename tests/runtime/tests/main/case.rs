//! A case: an application's run under a scenario, and checks of its output.

use crate::application::Application;
use libtest_mimic::Failed;
use openxr_sys as xr;
use parafovea_mock_runtime::record::{Error, Line};
use parafovea_mock_runtime::{SCENARIO_VARIABLE, write_runtime_manifest};
use parafovea_trial::watch;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Set in the process that runs a case: the case's name.
pub const CHILD_VARIABLE: &str = "PARAFOVEA_MOCK_TEST_CASE";

/// The longest time of a case: a hundred times that of the slowest.
pub const LIMIT: Duration = Duration::from_secs(300);

/// Test in a process of its own.
pub struct Case {
    pub name: String,
    pub scenario: String,
    pub run: Run,
}

/// Kind of a case.
pub enum Run {
    /// A run without mistakes, with assertions; afterwards a check of the output.
    Good { run: fn(), check: fn(&Output) },
    /// A mistake in an application that has come so far, the error it must get, from which call, by which section.
    Mistake(Mistake),
}

/// A broken rule.
#[derive(Clone, Copy)]
pub struct Mistake {
    pub start: fn() -> Application,
    pub make: fn(&mut Application) -> xr::Result,
    pub call: &'static str,
    pub result: xr::Result,
    pub section: &'static str,
}

/// Output of a run.
pub struct Output {
    pub folder: PathBuf,
    pub record: Vec<Line>,
}

impl Output {
    /// Output of a process that had [`environment`] with this folder.
    pub fn read(folder: &Path) -> Self {
        let folder = &folder.join("out");
        // There is none where the scenario cannot be used.
        let text = std::fs::read_to_string(folder.join("record.jsonl")).unwrap_or_default();
        let record = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        Self { folder: folder.to_owned(), record }
    }

    pub fn errors(&self) -> Vec<&Error> {
        let lines = self.record.iter();
        lines.filter_map(|line| if let Line::Error(error) = line { Some(error) } else { None }).collect()
    }

    pub fn frames(&self) -> Vec<&parafovea_mock_runtime::record::Frame> {
        let lines = self.record.iter();
        lines.filter_map(|line| if let Line::Frame(frame) = line { Some(frame) } else { None }).collect()
    }

    /// Width, height and RGBA of a picture.
    pub fn picture(&self, name: &str) -> (u32, u32, Vec<u8>) {
        let file = std::fs::File::open(self.folder.join(name)).unwrap();
        let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!(info.color_type, png::ColorType::Rgba);
        (info.width, info.height, pixels)
    }
}

/// The environment for a process that is to meet the runtime: files in `folder`, output in `folder/out`.
pub fn environment(folder: &Path, scenario: &str) -> Vec<(&'static str, PathBuf)> {
    let file = folder.join("scenario.toml");
    std::fs::write(&file, scenario).unwrap();
    let manifest = write_runtime_manifest(folder, &library()).unwrap();
    let settings = folder.join("vk_layer_settings.txt");
    std::fs::write(&settings, format!("{VALIDATION}{}\n", folder.join(VALIDATION_LOG).display())).unwrap();
    vec![
        ("XR_RUNTIME_JSON", manifest),
        (SCENARIO_VARIABLE, file),
        ("VK_LAYER_SETTINGS_PATH", folder.to_owned()),
        ("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation".into()),
    ]
}

/// Synchronisation too, across submissions.
const VALIDATION: &str = "\
khronos_validation.enables = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT,\
VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT
khronos_validation.debug_action = VK_DBG_LAYER_ACTION_LOG_MSG
khronos_validation.report_flags = error,warn
khronos_validation.log_filename = ";

const VALIDATION_LOG: &str = "validation.log";

/// Fails if the Vulkan validation layer is installed and printed messages.
pub fn check_validation(folder: &Path) -> Result<(), Failed> {
    check_validation_beyond(folder, None)
}

/// As [`check_validation`], apart from messages of rules whose names end with `allowed`.
pub fn check_validation_beyond(folder: &Path, allowed: Option<&str>) -> Result<(), Failed> {
    let log = std::fs::read_to_string(folder.join(VALIDATION_LOG)).unwrap_or_default();
    let is_allowed = |rule: &str| allowed.is_some_and(|allowed| rule.ends_with(allowed));
    let mut rules = log.split(": [ ").skip(1).filter_map(|rest| rest.split(" ]").next()).peekable();
    let is_right = log.trim().is_empty() || rules.peek().is_some() && rules.all(is_allowed);
    if is_right { Ok(()) } else { Err(log.into()) }
}

/// The newest of the copies that cargo makes.
fn library() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let deps = test.parent().unwrap();
    let copies = [deps, deps.parent().unwrap()].map(|folder| folder.join("libparafovea_mock_runtime.so"));
    copies
        .into_iter()
        .filter(|copy| copy.is_file())
        .max_by_key(|copy| copy.metadata().unwrap().modified().unwrap())
        .unwrap()
}

impl Case {
    pub fn run_here(&self) {
        match &self.run {
            Run::Good { run, .. } => run(),
            Run::Mistake(mistake) => {
                let mut application = (mistake.start)();
                assert_eq!((mistake.make)(&mut application), mistake.result);
            }
        }
    }

    pub fn run_in_child(&self) -> Result<(), Failed> {
        let folder = tempfile::tempdir().unwrap();
        let mut command = Command::new(std::env::current_exe().unwrap());
        command.env(CHILD_VARIABLE, &self.name).envs(environment(folder.path(), &self.scenario));
        let ended = watch(&mut command, LIMIT)?;
        let Some(status) = ended.status else {
            return Err(format!("still running after {} s\n{}", LIMIT.as_secs(), ended.output).into());
        };
        if !status.success() {
            return Err(format!("{status}\n{}", ended.output).into());
        }
        check_validation(folder.path())?;
        let output = Output::read(folder.path());
        match &self.run {
            Run::Good { check, .. } => {
                assert_eq!(output.errors(), Vec::<&Error>::new());
                check(&output);
            }
            Run::Mistake(mistake) => {
                let [error] = output.errors()[..] else {
                    return Err(format!("not one error: {:?}", output.errors()).into());
                };
                let found = (error.call.as_str(), error.result.clone(), error.section.as_str());
                assert_eq!(found, (mistake.call, format!("XR_{:?}", mistake.result), mistake.section));
                assert!(!error.message.is_empty());
            }
        }
        Ok(())
    }
}
