//! An application, and its user's behaviour while it runs.

use super::{Effort, Technique};
use crate::HarnessError;
use crate::device::Machine;
use crate::run::{Application, LayerMode, Run};
use crate::scenario::{Gaze, Head, Scenario, ScenarioExt, View};
use glam::{Quat, Vec3};
use parafovea_scene::scene::{FRAMES_PER_SECOND, SceneName};
use parafovea_scene::script::Script;
use parafovea_scene::script::gaze::{GazeKey, Phase};
use parafovea_scene::script::tracker::Tracker;
use parafovea_zoo::{SKIPPED, Style};
use std::sync::{Arc, OnceLock};
use tempfile::NamedTempFile;

/// One scene with a user: the head moves, the eyes wander, and a tracker reports the gaze.
#[derive(Clone, Debug)]
pub struct Subject {
    program: Program,
    script: Script,
    tracker: Tracker,
    /// The script's frame that is the first of a run.
    first_frame: u64,
    /// Angular velocity of the head, degrees a second, instead of the script's motion of head and eyes: the gaze stays at the centre
    /// of the view.
    turning_deg_per_s: Option<f32>,
    /// Its device; `None`: lavapipe.
    machine: Option<Machine>,
    /// The script's sound, once it was asked for.
    sound: Arc<OnceLock<NamedTempFile>>,
}

/// The program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Program {
    /// The scene that the script is of.
    Scene,
    /// Khronos' hello_xr, unmodified, while head and eyes move as in the scene.
    HelloXr,
    /// A style of the zoo, by name, while head and eyes move as in the scene.
    Style(&'static str),
}

impl Subject {
    /// The script of `scene` from `first_frame` on, as `tracker` sees it.
    pub fn new(scene: SceneName, tracker: Tracker, first_frame: u64) -> Self {
        Self {
            program: Program::Scene,
            script: Script::new(scene),
            tracker,
            first_frame,
            turning_deg_per_s: None,
            machine: None,
            sound: Arc::default(),
        }
    }

    /// hello_xr, an application that is not ours and has next to nothing to shade, with the script of the courtyard.
    pub fn hello_xr(tracker: Tracker) -> Self {
        Self { program: Program::HelloXr, ..Self::new(SceneName::Courtyard, tracker, 0) }
    }

    /// A style of the zoo, with the script of the courtyard.
    pub fn style(style: &Style, tracker: Tracker) -> Self {
        Self { program: Program::Style(style.name), ..Self::new(SceneName::Courtyard, tracker, 0) }
    }

    /// hello_xr in place of the scene; head and eyes move as before.
    pub fn with_hello_xr(self) -> Self {
        Self { program: Program::HelloXr, ..self }
    }

    /// A style of the zoo in place of the scene; head and eyes move as before.
    pub fn with_style(self, style: &Style) -> Self {
        Self { program: Program::Style(style.name), ..self }
    }

    /// Whether a style of the zoo runs.
    pub fn is_style(&self) -> bool {
        matches!(self.program, Program::Style(_))
    }

    /// Features that the device lacks for a style, which then shows nothing.
    ///
    /// # Errors
    /// Errors of the harness.
    pub fn lacks(&self) -> Result<Option<String>, HarnessError> {
        if !self.is_style() {
            return Ok(None);
        }
        let effort = Effort { turns: 1, run_up: 0, frames: 2, size: 64 };
        let outcome = self.run(&Technique::off(), effort)?.finish()?;
        Ok(outcome.output.lines().find(|line| line.starts_with(SKIPPED)).map(str::to_owned))
    }

    /// The script of `scene` from half a second before its first saccade of 10 degrees or more.
    pub fn around_a_saccade(scene: SceneName, tracker: Tracker) -> Self {
        Self::before_a_saccade(scene, tracker, (FRAMES_PER_SECOND / 2.0) as u64)
    }

    /// The script of `scene` from so many frames before its first saccade of 10 degrees or more that has as many before it.
    pub fn before_a_saccade(scene: SceneName, tracker: Tracker, frames: u64) -> Self {
        Self::new(scene, tracker, 0).starting_before_a_saccade(frames)
    }

    fn starting_before_a_saccade(self, frames: u64) -> Self {
        let before_s = frames as f64 / FRAMES_PER_SECOND;
        let saccades = self.script.gaze.saccades();
        let is_meant = |start_s: f64, amplitude_deg: f32| amplitude_deg >= 10.0 && start_s >= before_s;
        let large = saccades.iter().find(|saccade| is_meant(saccade.start_s, saccade.amplitude_deg));
        let start_s = large.map_or(0.0, |saccade| saccade.start_s - before_s);
        Self { first_frame: (start_s * FRAMES_PER_SECOND) as u64, ..self }
    }

    /// As [`Self::before_a_saccade`], by another of the scene's gaze scripts, in which the eyes look far to the side.
    pub fn glancing(scene: SceneName, tracker: Tracker, number: u32, frames: u64) -> Self {
        Self { script: Script::glancing(scene, number), ..Self::new(scene, tracker, 0) }
            .starting_before_a_saccade(frames)
    }

    /// The script of the same scene from so many frames later on.
    pub fn later(&self, frames: u64) -> Self {
        Self { first_frame: self.first_frame + frames, ..self.clone() }
    }

    /// The same with a head that only turns to the left from its first pose, at `deg_per_s`, and the gaze at the centre of the view.
    pub fn turning(self, deg_per_s: f32) -> Self {
        Self { turning_deg_per_s: Some(deg_per_s), ..self }
    }

    /// The same on a device of its own.
    pub fn on(self, machine: &Machine) -> Self {
        Self { machine: Some(machine.clone()), ..self }
    }

    /// Its name in tables and results.
    pub fn name(&self) -> &'static str {
        match self.program {
            Program::Scene => self.script.scene.as_str(),
            Program::HelloXr => "hello_xr",
            Program::Style(name) => name,
        }
    }

    /// Whether the technique can be tried: others know none of the arguments of our scenes, nor of a render scale.
    pub fn can_try(&self, technique: &Technique) -> bool {
        match self.program {
            Program::Scene => true,
            Program::HelloXr | Program::Style(_) => {
                technique.arguments.is_empty() && technique.render_scale == 1.0
            }
        }
    }

    /// The scenario of a run: run-up and frames of that size, with head and reported gaze from the script. Nothing is
    /// composited.
    pub fn scenario(&self, effort: Effort) -> Scenario {
        let mut scenario = Scenario::new(effort.length()).sized(effort.size, effort.size);
        scenario.clock.refresh_hz = FRAMES_PER_SECOND;
        let keys = self.script.head.keyframes(FRAMES_PER_SECOND).into_iter();
        scenario.head = keys
            .map(|key| Head {
                t: key.t,
                position: key.position,
                yaw_deg: key.yaw_deg,
                pitch_deg: key.pitch_deg,
                roll_deg: key.roll_deg,
            })
            .collect();
        scenario.gaze = self.tracker.keyframes(&self.script.gaze).iter().map(gaze).collect();
        let start_s = self.time_s(0);
        scenario.head.iter_mut().for_each(|key| key.t -= start_s);
        scenario.gaze.iter_mut().for_each(|key| key.t -= start_s);
        if let Some(deg_per_s) = self.turning_deg_per_s {
            let first = scenario.head.iter().rev().find(|key| key.t <= 0.0).or(scenario.head.first());
            let first = first.map(|key| Head { t: 0.0, ..*key });
            let last = first.map(|key| {
                let t = effort.length() as f64 / FRAMES_PER_SECOND;
                Head { t, yaw_deg: key.yaw_deg + deg_per_s * t as f32, ..key }
            });
            scenario.head = first.into_iter().chain(last).collect();
            scenario.gaze = vec![Gaze { t: 0.0, yaw_deg: 0.0, pitch_deg: 0.0, tracked: true }];
        }
        scenario
    }

    /// A run with a technique.
    ///
    /// # Errors
    /// [`HarnessError::NotBuilt`].
    pub fn run(&self, technique: &Technique, effort: Effort) -> Result<Run, HarnessError> {
        self.run_as(technique, effort, &self.scenario(effort))
    }

    /// As [`Self::run`], in a scenario that was made from [`Self::scenario`].
    ///
    /// # Errors
    /// [`HarnessError::NotBuilt`].
    pub fn run_as(
        &self,
        technique: &Technique,
        effort: Effort,
        scenario: &Scenario,
    ) -> Result<Run, HarnessError> {
        let application = match self.program {
            Program::Scene => self.scene(technique, effort)?,
            Program::HelloXr => Application::hello_xr("Vulkan2")?,
            Program::Style(name) => {
                let [size, frames, first] = [u64::from(effort.size), effort.length(), self.first_frame]
                    .map(|number| number.to_string());
                // With actions, like nearly every application: the layer adds the gaze to them. One without gets the layer's own after half
                // a minute, which no run here lasts.
                let arguments = [
                    "--style",
                    name,
                    "--size",
                    &size,
                    "--frames",
                    &frames,
                    "--first-frame",
                    &first,
                    "--actions",
                ];
                Application::ours("parafovea-zoo", &arguments)?
            }
        };
        let run = Run::new(&application, scenario);
        let run = match &technique.layer {
            LayerMode::On(config) if technique.hears => {
                run.layer(LayerMode::On(format!("{config}{}", self.audio_config()?))).with_audio_library()?
            }
            layer => run.layer(layer.clone()),
        };
        let run = match &technique.library {
            Some(library) => run.library(library),
            None => run,
        };
        Ok(match &self.machine {
            Some(machine) => machine.set_up(run),
            None => run,
        })
    }

    fn scene(&self, technique: &Technique, effort: Effort) -> Result<Application, HarnessError> {
        let side = ((effort.size as f32 * technique.render_scale).round() as u32).max(1);
        let size = format!("{side}x{side}");
        let first_frame = self.first_frame.to_string();
        let seed = match self.script.scene {
            SceneName::Generated(_, seed) => Some(seed.to_string()),
            _ => None,
        };
        let mut arguments = match &seed {
            Some(seed) => vec!["--generated", self.name(), "--seed", seed],
            None => vec!["--scene", self.name()],
        };
        arguments.extend(["--first-frame", &first_frame, "--size", &size]);
        arguments.extend(technique.arguments.iter().map(String::as_str));
        Application::ours("parafovea-scene", &arguments)
    }

    /// The part of a configuration that has the layer hear the script's sound.
    fn audio_config(&self) -> Result<String, HarnessError> {
        if self.sound.get().is_none() {
            let path = std::env::temp_dir();
            let failed = |error: &dyn ToString| HarnessError::File {
                path: path.clone(),
                source: std::io::Error::other(error.to_string()),
            };
            let file = NamedTempFile::with_suffix(".wav").map_err(|error| failed(&error))?;
            self.script.sound.write_wav(file.as_file()).map_err(|error| failed(&error))?;
            // Where another thread was first, this one goes.
            let _ = self.sound.set(file);
        }
        let path = self.sound.get().map(|file| file.path().display().to_string()).unwrap_or_default();
        Ok(format!("[audio]\nsource = \"file\"\nfile = {path:?}\nwindow_s = 1.0\n"))
    }

    /// Display time of frame `frame` of a run, seconds of the script.
    pub fn time_s(&self, frame: u64) -> f64 {
        (self.first_frame + frame) as f64 / FRAMES_PER_SECOND
    }

    /// Whether the eyes jump while a frame of a run is shown.
    pub fn is_in_flight(&self, frame: u64) -> bool {
        self.script.gaze.at(self.time_s(frame)).phase == Phase::Saccade
    }

    /// True gaze of an eye in a frame of a run, in the space of its view: towards the fixation point of both eyes.
    pub fn true_gaze(&self, frame: u64, view: &View) -> Vec3 {
        let gaze = self.script.gaze.at(self.time_s(frame));
        let seen = gaze.direction * gaze.distance_m - Vec3::from(view.position);
        Quat::from_array(view.orientation).inverse() * seen
    }
}

fn gaze(key: &GazeKey) -> Gaze {
    Gaze { t: key.t, yaw_deg: key.yaw_deg, pitch_deg: key.pitch_deg, tracked: key.tracked }
}
