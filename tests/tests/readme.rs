//! Claims of the README on options and files.

use parafovea_manifest::options::{Config, OPTIONS, reference};
use std::path::{Path, PathBuf};

const README: &str = include_str!("../../README.md");

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn the_page_of_options_is_generated() {
    let page = std::fs::read_to_string(root().join("manifest/OPTIONS.md")).unwrap();
    assert!(
        page == reference(),
        "manifest/OPTIONS.md is out of date; to write it: parafovea generate options > manifest/OPTIONS.md"
    );
}

/// The README's own table lists a few options, which exist, with these defaults.
#[test]
fn options_of_the_readme_are_there() {
    let defaults = Config::default();
    let rows = README.lines().filter_map(|line| line.strip_prefix("| `")?.split_once("` | `"));
    let rows: Vec<_> = rows.filter_map(|(key, rest)| Some((key, rest.split_once("` | ")?.0))).collect();
    assert!(rows.len() >= 8, "{rows:?}");
    for (key, value) in rows {
        let option = OPTIONS.iter().find(|option| option.key() == key);
        let option = option.unwrap_or_else(|| panic!("there is no option {key}"));
        assert_eq!(option.value(&defaults), value, "{key}");
    }
}

/// The counts of styles are those of the table.
#[test]
fn styles_of_the_readme_are_counted() {
    let table = std::fs::read_to_string(root().join("tests/baselines/backends.md")).unwrap();
    let rows = table.lines().skip_while(|line| !line.starts_with("| style | rate attachment |")).skip(2);
    let rows: Vec<Vec<&str>> =
        rows.take_while(|line| line.starts_with('|')).map(|line| line.split(" | ").collect()).collect();
    let engaged = |column: usize| rows.iter().filter(|row| row[column] == "engaged").count();
    let words: Vec<&str> = README.split_whitespace().collect();
    let text = words.join(" ");
    for claim in [
        format!("in {} of the [{} tested rendering styles]", engaged(1), rows.len()),
        format!("It works in {} of these styles.", engaged(2)),
    ] {
        assert!(rows.len() > 40 && text.contains(&claim), "not in the README: {claim}");
    }
}

#[test]
fn the_readme_is_short() {
    assert!(README.lines().count() <= 200, "{} lines", README.lines().count());
}

#[test]
fn links_lead_to_files() {
    let root = root();
    let links = README.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    for link in links.filter(|link| !link.starts_with("https://")) {
        assert!(root.join(link).exists(), "{link} does not exist");
    }
}
