//! Pipelines that a driver compiles again in an application's first launch with the layer: entries missing from a disk cache that launches
//! without the layer have filled.

use super::cell::Mode;
use super::program::Program;
use super::shim::ShimDevice;
use crate::HarnessError;
use crate::installation::Driver;
use std::fmt;
use std::path::Path;

/// The entries of Mesa's disk cache after each of some launches.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Warmth {
    /// The program.
    pub program: String,
    /// Written by the first launch, without the layer.
    pub cold: usize,
    /// More of a second launch without the layer.
    pub again: usize,
    /// More of a launch with rates.
    pub rates: usize,
    /// More of a second launch with rates.
    pub rates_again: usize,
    /// More of a launch with everything, whose own kernels are among them.
    pub everything: usize,
}

impl fmt::Display for Warmth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { program, cold, again, rates, rates_again, everything } = self;
        write!(f, "| {program} | {cold} | {again} | {rates} | {rates_again} | {everything} |")
    }
}

/// Launches a program on a device with a disk cache of its own, which is empty at first.
///
/// # Errors
/// Errors of the harness; the program's own.
pub fn warmth(program: Program, device: ShimDevice) -> Result<Warmth, HarnessError> {
    let folder = tempfile::tempdir().map_err(HarnessError::file(&std::env::temp_dir()))?;
    let mut before = 0;
    let mut launch = |mode: Mode| -> Result<usize, HarnessError> {
        let run = program.run()?.driver(Driver::Shim(device)).layer(mode.layer());
        // One file for each entry.
        run.env("MESA_SHADER_CACHE_DIR", folder.path())
            .env("MESA_DISK_CACHE_MULTI_FILE", "true")
            .finish()?
            .expect_end()?;
        let entries = files(folder.path())?;
        Ok(entries - std::mem::replace(&mut before, entries))
    };
    Ok(Warmth {
        program: program.name(),
        cold: launch(Mode::Off)?,
        again: launch(Mode::Off)?,
        rates: launch(Mode::Rates)?,
        rates_again: launch(Mode::Rates)?,
        everything: launch(Mode::Everything)?,
    })
}

/// Number of files below a folder, except the files that describe the cache.
fn files(folder: &Path) -> Result<usize, HarnessError> {
    let mut count = 0;
    for entry in std::fs::read_dir(folder).map_err(HarnessError::file(folder))?.flatten() {
        let path = entry.path();
        let is_own = path.file_name().is_some_and(|name| name == "index" || name == "marker");
        count += if path.is_dir() { files(&path)? } else { usize::from(!is_own) };
    }
    Ok(count)
}
