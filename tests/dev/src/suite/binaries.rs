//! The test binaries of the workspace, as cargo names them.

use std::path::{Path, PathBuf};

/// A test binary.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Binary {
    /// The package's folder below the repository's root and the target's name: `tests/sound sound`.
    pub label: String,
    pub path: PathBuf,
    /// The folder of the package, where cargo runs it.
    pub folder: PathBuf,
    /// Whether it takes the options of the standard test harness. A bench does not: it is run as one test.
    pub has_harness: bool,
    /// Whether its tests are unit tests, of a library or of a program.
    pub is_unit: bool,
}

/// The test binaries in the messages of `cargo test --no-run --message-format=json-render-diagnostics`, one JSON object a line.
pub fn binaries(messages: &str, root: &Path) -> Vec<Binary> {
    messages.lines().filter_map(|line| binary(line, root)).collect()
}

fn binary(line: &str, root: &Path) -> Option<Binary> {
    // Libraries and programs that the tests use are built without tests in them.
    let profile = line.split_once("\"profile\":{")?.1.split_once('}')?.0;
    if !profile.contains("\"test\":true") {
        return None;
    }
    let path = PathBuf::from(text(line, "executable")?);
    let folder = PathBuf::from(text(line, "manifest_path")?).parent()?.to_owned();
    let target = line.split_once("\"target\":{")?.1;
    let label =
        format!("{} {}", folder.strip_prefix(root).unwrap_or(&folder).display(), text(target, "name")?);
    let has_harness = !target.starts_with("\"kind\":[\"bench\"]");
    let is_unit = has_harness && !target.starts_with("\"kind\":[\"test\"]");
    Some(Binary { label, path, folder, has_harness, is_unit })
}

/// The first value of that key; None if it is not a string.
fn text(object: &str, key: &str) -> Option<String> {
    let rest = object.split_once(&format!("\"{key}\":\""))?.1;
    let mut value = String::new();
    let mut characters = rest.chars();
    loop {
        match characters.next()? {
            '"' => return Some(value),
            // Paths escape only `"` and `\`.
            '\\' => value.push(characters.next()?),
            other => value.push(other),
        }
    }
}

/// The names of tests in a binary's output for `--list`.
pub fn names(list: &str) -> Vec<String> {
    list.lines().filter_map(|line| line.strip_suffix(": test")).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOUND: &str = r#"{"reason":"compiler-artifact","package_id":"path+file:///r/tests/sound#parafovea-sound@0.1.0","manifest_path":"/r/tests/sound/Cargo.toml","target":{"kind":["test"],"crate_types":["bin"],"name":"sound","src_path":"/r/tests/sound/tests/main.rs","test":true},"profile":{"opt_level":"2","test":true},"features":[],"filenames":["/r/target/a \"b\""],"executable":"/r/target/a \"b\"","fresh":true}"#;

    #[test]
    fn test_binaries_are_found_in_messages() {
        let found = binaries(&format!("no JSON\n{SOUND}\n"), Path::new("/r"));
        let expected = Binary {
            label: "tests/sound sound".to_owned(),
            path: "/r/target/a \"b\"".into(),
            folder: "/r/tests/sound".into(),
            has_harness: true,
            is_unit: false,
        };
        assert_eq!(found, [expected]);
        let bench = SOUND.replace("[\"test\"]", "[\"bench\"]");
        assert!(!binaries(&bench, Path::new("/r"))[0].has_harness);
        for kind in ["lib", "bin", "cdylib\",\"rlib"] {
            let unit = SOUND.replace("[\"test\"]", &format!("[\"{kind}\"]"));
            let unit = &binaries(&unit, Path::new("/r"))[0];
            assert!(unit.is_unit && unit.has_harness, "{kind}");
        }
    }

    #[test]
    fn programs_without_tests_are_not() {
        let program =
            SOUND.replace("\"opt_level\":\"2\",\"test\":true", "\"opt_level\":\"2\",\"test\":false");
        let library = SOUND.replace("\"executable\":\"/r/target/a \\\"b\\\"\"", "\"executable\":null");
        assert!(program != SOUND && library != SOUND);
        assert_eq!(binaries(&format!("{program}\n{library}"), Path::new("/r")), []);
    }

    #[test]
    fn names_are_listed() {
        assert_eq!(
            names("warning: x\na::b: test\nc d, e: test\nf: benchmark\n\n3 tests"),
            ["a::b", "c d, e"]
        );
    }
}
