//! Parts of a package.

use super::{DistError, NEWEST_GLIBC, newest_glibc, test_names};
use parafovea_manifest::install::{AUDIO_LIBRARY_NAME, LIBRARY_NAME};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A file of an archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its path below the top of the archive.
    pub path: String,
    /// Its permissions.
    pub mode: u32,
    /// Its content.
    pub content: Vec<u8>,
}

impl Entry {
    pub(crate) fn new(path: impl Into<String>, mode: u32, content: impl Into<Vec<u8>>) -> Self {
        Self { path: path.into(), mode, content: content.into() }
    }
}

/// Parts of a package: programs and libraries from cargo's build, and texts.
#[derive(Clone, Debug)]
pub struct Parts {
    /// `parafovea`.
    pub command: Vec<u8>,
    /// `parafovea-probe`.
    pub probe: Vec<u8>,
    /// The libraries by their file names: the layer's, and the sound capture library, where it was built.
    pub libraries: Vec<(&'static str, Vec<u8>)>,
    /// Completions for bash, zsh and fish, and the manual page.
    pub generated: [Vec<u8>; 4],
    /// Texts for people by their file names.
    pub texts: Vec<(&'static str, Vec<u8>)>,
    /// The newest version of the C library that any of it needs.
    pub glibc: [u32; 2],
    /// Build time of the command, seconds since 1970: the time of all files.
    pub time: u64,
}

/// Kinds of output of [`Parts::generated`].
const GENERATED: [&str; 4] = ["bash", "zsh", "fish", "man"];

/// The guide, the options, how it works, and the pictures in that.
const GUIDE: [&str; 7] = [
    "GUIDE.md",
    "OPTIONS.md",
    "HOW-IT-WORKS.md",
    "pictures/age.png",
    "pictures/eccentricity.png",
    "pictures/gaze.png",
    "pictures/rates.png",
];

/// Texts of the repository's top folder that are packed, with the links that lead to packed files.
const REPOSITORY: [&str; 3] = ["README.md", "CHANGELOG.md", "SECURITY.md"];

/// Markdown with its links to packed files, and to the web; other links become their text, and other pictures go.
fn with_packed_links(text: &str) -> String {
    let mut rest = text;
    let mut packed = String::new();
    while let Some((before, label, target, after)) = next_link(rest) {
        let name = target.rsplit('/').next().unwrap_or(target);
        let (before, is_picture) = before.strip_suffix('!').map_or((before, false), |before| (before, true));
        packed += before;
        if target.starts_with("https://") || GUIDE.contains(&name) || REPOSITORY.contains(&name) {
            let target = if target.starts_with("https://") { target } else { name };
            packed += &format!("{}[{label}]({target})", if is_picture { "!" } else { "" });
        } else if !is_picture {
            packed += label;
        }
        rest = after;
    }
    packed + rest
}

/// The next link: the text before it, its label and target, and the text behind it.
fn next_link(text: &str) -> Option<(&str, &str, &str, &str)> {
    let (head, tail) = text.split_once("](")?;
    let (before, label) = head.rsplit_once('[')?;
    let (target, after) = tail.split_once(')')?;
    Some((before, label, target, after))
}

impl Parts {
    /// Takes cargo's build from `built` (`target/release`), and the texts of `repository`.
    ///
    /// # Errors
    /// Something is missing, does not run, or needs a newer C library than [`NEWEST_GLIBC`].
    pub fn collect(built: &Path, repository: &Path) -> Result<Self, DistError> {
        let read = |path: &Path| fs::read(path).map_err(DistError::file(path));
        let command = built.join("parafovea");
        let mut parts = Self {
            command: read(&command)?,
            probe: read(&built.join("parafovea-probe"))?,
            libraries: vec![(LIBRARY_NAME, read(&library(built, LIBRARY_NAME))?)],
            generated: Default::default(),
            texts: Vec::new(),
            glibc: [0; 2],
            time: modified(&command),
        };
        let audio = library(built, AUDIO_LIBRARY_NAME);
        if audio.is_file() {
            parts.libraries.push((AUDIO_LIBRARY_NAME, read(&audio)?));
        }
        for (what, text) in GENERATED.into_iter().zip(&mut parts.generated) {
            *text = generate(&command, what)?;
        }
        for name in ["LICENSE-APACHE", "LICENSE-MIT"] {
            parts.texts.push((name, read(&repository.join(name))?));
        }
        for name in GUIDE {
            parts.texts.push((name, read(&repository.join("manifest").join(name))?));
        }
        for name in REPOSITORY {
            let text = read(&repository.join(name))?;
            parts.texts.push((name, with_packed_links(&String::from_utf8_lossy(&text)).into_bytes()));
        }
        let programs = [("parafovea", &parts.command), ("parafovea-probe", &parts.probe)];
        let libraries = parts.libraries.iter().map(|(name, bytes)| (*name, bytes));
        for (name, bytes) in programs.into_iter().chain(libraries) {
            let needs = newest_glibc(bytes).unwrap_or_default();
            if needs > NEWEST_GLIBC {
                return Err(DistError::TooNew { path: built.join(name), needs });
            }
            parts.glibc = parts.glibc.max(needs);
        }
        Ok(parts)
    }

    /// Checks that no program or library is a build for tests.
    ///
    /// # Errors
    /// [`DistError::ForTests`].
    pub fn check_release(&self) -> Result<(), DistError> {
        let programs = [("parafovea", &self.command), ("parafovea-probe", &self.probe)];
        let libraries = self.libraries.iter().map(|(name, bytes)| (*name, bytes));
        for (name, bytes) in programs.into_iter().chain(libraries) {
            let names = test_names(bytes);
            if !names.is_empty() {
                return Err(DistError::ForTests { name, names });
            }
        }
        Ok(())
    }
}

/// Cargo puts a library into `deps`, and beside the programs where it was asked for by itself: the newer one.
fn library(built: &Path, name: &str) -> PathBuf {
    let copies = [built.join(name), built.join("deps").join(name)];
    let [first, _] = copies.clone();
    copies.into_iter().filter(|path| path.is_file()).max_by_key(|path| modified(path)).unwrap_or(first)
}

fn modified(path: &Path) -> u64 {
    let time = fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    time.and_then(|time| Some(time.duration_since(std::time::UNIX_EPOCH).ok()?.as_secs())).unwrap_or(0)
}

fn generate(command: &Path, what: &'static str) -> Result<Vec<u8>, DistError> {
    let output = Command::new(command).args(["generate", what]).output().map_err(DistError::file(command))?;
    if !output.status.success() || output.stdout.is_empty() {
        let output = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(DistError::Generate { what, output });
    }
    Ok(output.stdout)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_lead_to_packed_files_or_are_text() {
        let text = "See [the guide](manifest/GUIDE.md), [a\ntable](tests/a.md) and [the web](https://e.org/a).\n![x](tests/x.png)\nEnd";
        assert_eq!(
            with_packed_links(text),
            "See [the guide](GUIDE.md), a\ntable and [the web](https://e.org/a).\n\nEnd"
        );
        assert_eq!(with_packed_links("a ](b"), "a ](b");
    }
}
