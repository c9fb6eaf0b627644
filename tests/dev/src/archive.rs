//! Debian's archive as this machine's apt knows it: the mirror that its user chose.

use std::fs;
use std::path::{Path, PathBuf};

/// The address of the archive that has this machine's release.
///
/// # Errors
/// This is no Debian, or its archive is not among apt's sources.
pub fn archive() -> Result<String, String> {
    let release = fs::read_to_string("/etc/os-release").unwrap_or_default();
    let codename = release.lines().find_map(|line| line.strip_prefix("VERSION_CODENAME="));
    let codename = codename.unwrap_or_default().trim_matches('"');
    if codename.is_empty() || !release.lines().any(|line| line == "ID=debian" || line == "ID=\"debian\"") {
        return Err("this system is not Debian".to_owned());
    }
    let folder = Path::new("/etc/apt");
    let entries = fs::read_dir(folder.join("sources.list.d")).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    files.sort();
    files.insert(0, folder.join("sources.list"));
    let found = files.iter().find_map(|file| source_of(&fs::read_to_string(file).ok()?, codename));
    found.ok_or_else(|| format!("the sources of apt have no archive with the suite {codename}"))
}

/// The address that a file of apt's sources gives for a suite, in either of their formats (sources.list(5)).
fn source_of(text: &str, suite: &str) -> Option<String> {
    text.split("\n\n").find_map(|stanza| source_of_stanza(stanza, suite)).or_else(|| {
        text.lines().find_map(|line| {
            let line = line.trim().strip_prefix("deb ")?.trim();
            // Options come first, in brackets.
            let line = line.split_once(']').map_or(line, |(_, rest)| rest);
            let mut words = line.split_whitespace();
            let address = words.next()?;
            (words.next()? == suite).then(|| address.to_owned())
        })
    })
}

/// The same for a stanza of fields.
fn source_of_stanza(stanza: &str, suite: &str) -> Option<String> {
    let field = |name: &str| {
        let line = stanza.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'));
        line.map(str::split_whitespace)
    };
    let is_binary = field("Types")?.any(|word| word == "deb");
    let has_suite = field("Suites")?.any(|word| word == suite);
    field("URIs")?.next().filter(|_| is_binary && has_suite).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_read_in_both_formats() {
        let fields = "Types: deb\n# a comment\nURIs: http://mirror.example/debian\nSuites: bookworm bookworm-updates\n\n\
            Types: deb\nURIs: http://security.example/debian\nSuites: bookworm-security\n";
        assert_eq!(source_of(fields, "bookworm").as_deref(), Some("http://mirror.example/debian"));
        assert_eq!(source_of(fields, "bookworm-security").as_deref(), Some("http://security.example/debian"));
        assert_eq!(source_of(fields, "trixie"), None);
        let lines = "# deb http://old.example/debian trixie main\ndeb-src http://src.example/debian trixie main\n\
            deb [signed-by=/a/key arch=amd64] http://mirror.example/debian trixie main\n";
        assert_eq!(source_of(lines, "trixie").as_deref(), Some("http://mirror.example/debian"));
        assert_eq!(source_of("Types: deb-src\nURIs: http://a.example\nSuites: sid\n", "sid"), None);
        assert_eq!(source_of("", "sid"), None);
    }
}
