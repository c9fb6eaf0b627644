//! An application that was started, until its end.

use super::child::Child;
use super::outcome::{self, Folder};
use super::{Outcome, Run};
use crate::HarnessError;
use crate::installation::Installation;
use crate::record::Record;
use std::path::PathBuf;

/// A run that goes on.
pub struct Running {
    pub(super) run: Run,
    pub(super) folder: Folder,
    pub(super) installation: Installation,
    pub(super) child: Child,
}

impl Running {
    /// The configuration file that the application reads.
    pub fn config_file(&self) -> PathBuf {
        self.installation.config_file()
    }

    /// Whether the runtime has saved that picture already ([`Outcome::submitted`]).
    pub fn has_submitted(&self, view: usize, frame: u64) -> bool {
        let pictures = self.folder.path().join(&self.run.scenario.output.dir);
        outcome::submitted_path(&pictures, view, frame).exists()
    }

    /// Its `$XDG_RUNTIME_DIR`, with the layer's status of it.
    pub fn runtime_folder(&self) -> PathBuf {
        self.installation.runtime_folder()
    }

    /// The number of the application's process.
    pub fn process_id(&self) -> u32 {
        self.child.id()
    }

    /// Whether it has ended, by itself or otherwise.
    pub fn has_ended(&mut self) -> bool {
        self.child.has_ended()
    }

    /// The layer's log so far.
    pub fn log(&self) -> String {
        outcome::read_logs(&self.installation.log_folder())
    }

    /// Has it end by itself, if it is one that ends with its standard input, as hello_xr does.
    ///
    /// # Errors
    /// As for [`Run::finish`].
    pub fn quit(mut self) -> Result<Outcome, HarnessError> {
        self.child.close_input();
        self.finish()
    }

    /// Kills it, and returns the record of its frames so far.
    ///
    /// # Errors
    /// A record that cannot be read, has fewer than `frames` frames, or a call that broke a rule.
    pub fn stop(self, frames: u64) -> Result<Record, HarnessError> {
        let path = self.record_path();
        let record = Record::load(&path)?;
        let (recorded, errors) = (record.frames.len() as u64, &record.errors);
        if recorded < frames || !errors.is_empty() {
            let lack = format!("{recorded} frames of {frames}, rules broken: {errors:?}");
            return Err(HarnessError::format(&path, lack));
        }
        Ok(record)
    }

    fn record_path(&self) -> PathBuf {
        self.folder.path().join(&self.run.scenario.output.dir).join("record.jsonl")
    }

    /// Waits for its end, or kills it when its time is over.
    ///
    /// # Errors
    /// As for [`Run::finish`].
    pub fn finish(self) -> Result<Outcome, HarnessError> {
        let record = self.record_path();
        let frames = self.run.scenario.session.frames;
        let is_done = || {
            self.run.closes_input
                && Record::load(&record).is_ok_and(|record| record.frames.len() as u64 >= frames)
        };
        let exit = self.child.finish(is_done)?;
        Outcome::collect(self.run.application.name, self.folder, &self.installation, &self.run.scenario, exit)
    }
}
