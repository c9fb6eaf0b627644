//! Writes the record, and keeps count.

use crate::fault::{Fault, result_name};
use crate::record::{Error, Line};
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// The record of this process.
#[derive(Debug, Default)]
pub(crate) struct Recorder {
    file: Option<File>,
    /// Calls that broke a rule.
    pub errors: u64,
}

impl Recorder {
    /// Begins a record in a folder, which is made.
    pub fn create(folder: &Path) -> std::io::Result<Self> {
        std::fs::create_dir_all(folder)?;
        Ok(Self { file: Some(File::create(folder.join("record.jsonl"))?), errors: 0 })
    }

    /// Writes a line. The file has no buffer: applications crash.
    pub fn line(&mut self, line: &Line) {
        let Some(file) = &mut self.file else { return };
        let written = serde_json::to_vec(line).map_err(std::io::Error::from).and_then(|mut json| {
            json.push(b'\n');
            file.write_all(&json)
        });
        if let Err(error) = written {
            eprintln!("parafovea mock runtime: the record ends here: {error}");
            self.file = None;
        }
    }

    pub fn error(&mut self, call: &str, fault: &Fault) {
        self.errors += 1;
        self.line(&Line::Error(Error {
            call: call.to_owned(),
            result: result_name(fault.result),
            message: fault.message.clone(),
            section: fault.section.to_owned(),
        }));
    }

    pub fn warning(&mut self, call: &str, message: String) {
        self.line(&Line::Warning { call: call.to_owned(), message });
    }
}
