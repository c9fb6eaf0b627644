//! Options that name a file.

use super::{Allowed, Setting};
use std::fmt;
use std::path::Path;
use toml::de::DeValue;

/// Longest path, bytes: as long as a name within one folder may be.
const LONGEST: usize = 255;

/// The path of a file, or of none. Its text is in it, so that configurations are copied without allocation.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct FilePath {
    bytes: [u8; LONGEST],
    length: u8,
}

impl FilePath {
    /// No file.
    pub const NONE: Self = Self { bytes: [0; LONGEST], length: 0 };

    /// The file of an absolute path; none of an empty text.
    pub fn new(text: &str) -> Option<Self> {
        let is_allowed = text.is_empty() || text.starts_with('/') && !text.contains(|c: char| c.is_control());
        let length = u8::try_from(text.len()).ok().filter(|_| is_allowed)?;
        let mut bytes = [0; LONGEST];
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        Some(Self { bytes, length })
    }

    /// The path, if there is one.
    pub fn path(&self) -> Option<&Path> {
        let text = self.text();
        (!text.is_empty()).then(|| Path::new(text))
    }

    fn text(&self) -> &str {
        std::str::from_utf8(&self.bytes[..usize::from(self.length)]).unwrap_or_default()
    }
}

impl Default for FilePath {
    fn default() -> Self {
        Self::NONE
    }
}

impl fmt::Debug for FilePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.text(), f)
    }
}

impl Setting for FilePath {
    type Range = ();

    fn read(value: &DeValue<'_>, (): ()) -> Option<Self> {
        Self::new(value.as_str()?)
    }

    fn allowed((): ()) -> Allowed {
        Allowed::Text("an absolute path of at most 255 bytes, or \"\" for none")
    }

    fn to_toml(self) -> String {
        toml::Value::from(self.text()).to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_absolute_paths_and_nothing_else() {
        let of = |text: &str| FilePath::new(text).map(|file| file.path().map(Path::to_owned));
        assert_eq!(of(""), Some(None));
        assert_eq!(of("/a/b c.csv"), Some(Some("/a/b c.csv".into())));
        let longest = format!("/{}", "x".repeat(LONGEST - 1));
        assert_eq!(of(&longest), Some(Some(longest.clone().into())));
        for refused in ["a", "~/a", "./a", "/a\n", &format!("{longest}x")] {
            assert_eq!(of(refused), None, "{refused}");
        }
    }

    #[test]
    fn paths_are_read_as_written() {
        for text in ["", "/a", "/\"quoted\" \\ ünd"] {
            let file = FilePath::new(text).unwrap();
            let table: toml::Table = format!("file = {}", file.to_toml()).parse().unwrap();
            assert_eq!(table["file"].as_str(), Some(text));
        }
    }
}
