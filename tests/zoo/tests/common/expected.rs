//! Masks in the table of `tests/baselines/backends.md`.

use parafovea_zoo::{STYLES, Style};
use std::collections::BTreeMap;
use std::path::Path;

/// The table's row of a style.
#[derive(Clone, Debug)]
pub enum Expected {
    /// Its passes of the scene have masks.
    Engaged,
    /// They have none, because.
    Refused(String),
    /// No device of the machine that made the table can run it.
    NotRun,
}

/// Every style with its row of the table, or the error in it.
pub fn expected() -> Vec<(&'static Style, Result<Expected, String>)> {
    let table = column(MASK);
    let of_style = |style: &'static Style| {
        let expected = match table.get(style.name).map(String::as_str) {
            Some("engaged") => Ok(Expected::Engaged),
            Some(says) if says.starts_with("not run: ") => Ok(Expected::NotRun),
            Some(says) => match says.strip_prefix("refused: ") {
                Some(reason) => Ok(Expected::Refused(reason.to_owned())),
                None => Err(format!("the table says {says:?}")),
            },
            None => Err("the table says nothing".to_owned()),
        };
        (style, expected)
    };
    STYLES.iter().copied().map(of_style).collect()
}

/// Beginning of the table's first row.
const HEADER: &str = "| style | rate attachment |";

/// The number of the column of masks.
const MASK: usize = 2;

/// A column of the table by its number, by style.
pub fn column(number: usize) -> BTreeMap<String, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../baselines/backends.md");
    let text = std::fs::read_to_string(path).unwrap();
    let rows = text.lines().skip_while(|line| !line.starts_with(HEADER)).skip(1);
    let rows = rows.filter(|line| line.starts_with("| "));
    rows.map(|row| {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        (cells[0].to_owned(), cells[number].to_owned())
    })
    .collect()
}
