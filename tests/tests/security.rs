//! SECURITY.md does not claim more than tests hold.

use std::path::{Path, PathBuf};

/// All sources of the workspace.
fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_source = path.extension().is_some_and(|extension| extension == "rs");
        let is_built = path.file_name().is_some_and(|name| name == "target");
        if path.is_dir() && !is_built {
            sources(&path, into);
        } else if is_source {
            into.push(path);
        }
    }
}

/// The names in the last column of the table.
fn tests_of(row: &str) -> impl Iterator<Item = &str> {
    row.trim_end_matches('|').rsplit('|').next().unwrap_or_default().split('`').skip(1).step_by(2)
}

#[test]
fn each_point_has_its_tests() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut files = Vec::new();
    ["core", "layer", "manifest", "tests"].into_iter().for_each(|name| sources(&root.join(name), &mut files));
    let text: String = files.iter().map(|file| std::fs::read_to_string(file).unwrap()).collect();
    let claims = std::fs::read_to_string(root.join("SECURITY.md")).unwrap();
    let rows: Vec<&str> = claims.lines().filter(|line| line.starts_with('|')).skip(2).collect();
    assert!(rows.len() >= 10, "{rows:?}");
    for row in rows {
        assert!(tests_of(row).next().is_some(), "without a test: {row}");
        for name in tests_of(row) {
            assert!(text.contains(&format!("fn {name}(")), "there is no test `{name}`, of: {row}");
        }
    }
}

#[test]
fn the_last_column_is_read() {
    let names: Vec<&str> = tests_of("| A | `b` c | `d`, `e` |").collect();
    assert_eq!(names, ["d", "e"]);
}
