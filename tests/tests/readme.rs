//! What the README says of options, tasks and files is so.

use parafovea_manifest::options::{Config, OPTIONS};
use std::path::Path;

const README: &str = include_str!("../../README.md");

/// The option table, as the README has to have it.
fn table() -> String {
    let defaults = Config::default();
    let mut table = "| option | default | allowed | meaning |\n|---|---|---|---|\n".to_owned();
    for option in OPTIONS {
        let (key, value, allowed) = (option.key(), option.value(&defaults), option.allowed_with_unit());
        table += &format!("| `{key}` | `{value}` | {allowed} | {} |\n", option.doc);
    }
    table
}

#[test]
fn has_the_option_table() {
    let table = table();
    assert!(README.contains(&table), "the README's option table is not this:\n{table}");
}

#[test]
fn links_lead_to_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let links = README.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    for link in links.filter(|link| !link.starts_with("https://")) {
        assert!(root.join(link).exists(), "{link} does not exist");
    }
}
