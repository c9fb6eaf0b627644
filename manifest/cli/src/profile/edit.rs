//! Changing one option of a file, with all else in it as it was.

use parafovea_manifest::options::{Allowed, OptionSpec};
use toml_edit::{DocumentMut, Item, Table, TableLike, TomlError, Value};

/// A change of one option.
#[derive(Clone, Copy, Debug)]
pub enum Change<'a> {
    /// The value that it gets, as it was typed.
    Set(&'a str),
    /// It is removed.
    Unset,
}

/// Reason why a file cannot be changed.
#[derive(Debug, thiserror::Error)]
pub enum EditError {
    /// It is not TOML.
    #[error("is not valid TOML and stays unchanged; to see the error: parafovea profile validate")]
    Syntax(#[from] TomlError),
    /// The name of a section has a value.
    #[error("{0} is not a section in this file")]
    NoSection(&'static str),
}

/// `text` with the change. Whether the value is allowed is not looked at here.
///
/// # Errors
/// See [`EditError`].
pub fn apply(text: &str, option: &OptionSpec, change: Change<'_>) -> Result<String, EditError> {
    let mut document: DocumentMut = text.trim_start_matches('\u{feff}').parse()?;
    let root = document.as_table_mut();
    let table: &mut dyn TableLike = match option.section {
        "" => root,
        section => {
            if matches!(change, Change::Unset) && !root.contains_key(section) {
                return Ok(text.to_owned());
            }
            let item = root.entry(section).or_insert_with(|| Item::Table(Table::new()));
            item.as_table_like_mut().ok_or(EditError::NoSection(option.section))?
        }
    };
    match change {
        Change::Unset => drop(table.remove(option.name)),
        Change::Set(typed) => {
            let mut new = value(option, typed);
            match table.get_mut(option.name) {
                Some(Item::Value(old)) => {
                    // The text behind the value, such as a comment, stays.
                    *new.decor_mut() = old.decor().clone();
                    *old = new;
                }
                _ => drop(table.insert(option.name, Item::Value(new))),
            }
        }
    }
    Ok(document.to_string())
}

/// The typed text as a value of TOML: text needs no quotes.
fn value(option: &OptionSpec, typed: &str) -> Value {
    let parsed = typed.trim().parse::<Value>().ok();
    let is_text = matches!(option.allowed(), Allowed::Choice(_) | Allowed::Text(_));
    match parsed {
        Some(value) if !is_text || value.is_str() => value,
        _ => Value::from(typed.trim()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_manifest::config::parse;
    use parafovea_manifest::options::{Config, OPTIONS, default_file};
    use std::path::Path;

    fn option(key: &str) -> &'static OptionSpec {
        OPTIONS.iter().find(|option| option.key() == key).unwrap()
    }

    fn set(text: &str, key: &str, value: &str) -> String {
        apply(text, option(key), Change::Set(value)).unwrap()
    }

    #[test]
    fn comments_and_order_stay() {
        let text = "# mine\nenabled = true # always\n\n[chroma] # colour\n# how\nmode = 'off' # for now\nplateau_deg = 7\n";
        assert_eq!(set(text, "chroma.mode", "default"), text.replace("'off'", "\"default\""));
        assert_eq!(set(text, "enabled", "false"), text.replace("true", "false"));
        assert_eq!(set(text, "chroma.plateau_deg", "8.5"), text.replace("= 7", "= 8.5"));
        assert_eq!(set(text, "gaze.hold_ms", "100"), format!("{text}\n[gaze]\nhold_ms = 100\n"));
        let unset = apply(text, option("chroma.plateau_deg"), Change::Unset).unwrap();
        assert_eq!(unset, text.replace("plateau_deg = 7\n", ""));
        assert_eq!(apply(text, option("gaze.hold_ms"), Change::Unset).unwrap(), text);
    }

    #[test]
    fn every_option_can_be_set_in_any_file_and_in_none() {
        let config = Config::default();
        for text in ["", "[rates]\n", "rates.mode = 'off'\nchroma = { mode = 'off' }\n", &default_file()] {
            for option in OPTIONS {
                let after = apply(text, option, Change::Set(&option.value(&config))).unwrap();
                let read = parse(Path::new("x"), &after).unwrap_or_else(|errors| panic!("{errors}\n{after}"));
                assert_eq!(option.value(&read), option.value(&config), "{after}");
                let without = apply(&after, option, Change::Unset).unwrap();
                assert!(!super::super::effective::set_in(&without).contains(&option.key()), "{without}");
            }
        }
    }

    #[test]
    fn text_needs_no_quotes_even_where_it_looks_like_a_number() {
        assert_eq!(set("", "reuse.periods", "11223"), "[reuse]\nperiods = \"11223\"\n");
        assert_eq!(set("", "rates.peripheral", "\"2x2\""), "[rates]\nperipheral = \"2x2\"\n");
        assert_eq!(
            set("", "rates.passes", "exclude 64x64; left"),
            "[rates]\npasses = \"exclude 64x64; left\"\n"
        );
    }

    #[test]
    fn a_file_that_is_no_toml_is_left_alone() {
        assert!(matches!(apply("a = = 1", option("enabled"), Change::Unset), Err(EditError::Syntax(_))));
        assert!(matches!(
            apply("chroma = 1", option("chroma.mode"), Change::Unset),
            Err(EditError::NoSection("chroma"))
        ));
    }
}
