//! The configuration: its file and its content.
//!
//! The first file of the look-up order is the configuration; options that it does not set have the value of its preset, or their
//! default. A file with an error is rejected as a whole, with a line for each error, so that no file applies in part; at the start of an
//! application, its `enabled = false` still counts.

mod error;
mod lookup;
mod names;
mod parse;
mod read;
mod watch;

use std::path::Path;

pub use crate::options::Config;
pub use error::{ConfigError, ConfigErrors};
pub use lookup::{Places, missing_target, offers_gaze};
pub use names::Names;
pub use parse::parse;
pub use read::MAX_BYTES;
pub use watch::Watch;

/// Reads and parses the file at `path`.
///
/// # Errors
///
/// The file cannot be read, or holds something that is not allowed: a line for each error, which names the
/// file.
pub fn load(path: &Path) -> Result<Config, ConfigErrors> {
    let bytes = read::read(path).map_err(|error| ConfigErrors::new(path, vec![error]))?;
    let text = String::from_utf8(bytes).map_err(|error| parse::not_text(path, &error))?;
    parse(path, &text)
}
