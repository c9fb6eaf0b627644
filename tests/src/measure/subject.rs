//! An application, and what its user does while it runs.

use super::{Effort, Technique};
use crate::HarnessError;
use crate::run::{Application, Run};
use crate::scenario::{Scenario, ScenarioExt};

/// One picture to measure: our scene program with some of its arguments, and a script for head and gaze.
#[derive(Clone, Debug)]
pub struct Subject {
    name: String,
    arguments: Vec<String>,
    script: Scenario,
}

impl Subject {
    /// The scene program with `arguments`, worn as `script` says: of that the headset, head and gaze count.
    pub fn new(name: &str, arguments: &[&str], script: Scenario) -> Self {
        let arguments = arguments.iter().map(|&argument| argument.to_owned()).collect();
        Self { name: name.to_owned(), arguments, script }
    }

    /// What it is called in tables and results.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The scenario of a run: as scripted, so many frames of that size.
    pub fn scenario(&self, effort: Effort) -> Scenario {
        let mut scenario = self.script.clone().sized(effort.size, effort.size);
        scenario.session.frames = effort.frames;
        scenario.output.composite = false;
        scenario
    }

    /// A run with a technique.
    ///
    /// # Errors
    /// [`HarnessError::NotBuilt`].
    pub fn run(&self, technique: &Technique, effort: Effort) -> Result<Run, HarnessError> {
        let side = ((effort.size as f32 * technique.render_scale).round() as u32).max(1);
        let size = format!("{side}x{side}");
        let own = self.arguments.iter().chain(&technique.arguments).map(String::as_str);
        let arguments: Vec<&str> = own.chain(["--size", &size]).collect();
        let application = Application::ours("parafovea-scene", &arguments)?;
        Ok(Run::new(&application, &self.scenario(effort)).layer(technique.layer.clone()))
    }
}
