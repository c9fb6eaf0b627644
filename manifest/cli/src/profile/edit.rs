//! Changing one option of a file, with all else in it as it was.

use parafovea_manifest::options::{Allowed, OptionSpec};
use toml_edit::{Document, DocumentMut, Item, Table, TableLike, TomlError, Value};

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
    #[error("{0} has a value in this file, but is a section; replace that line by the section [{0}]")]
    NoSection(&'static str),
}

/// `text` with the change. Whether the value is allowed is not looked at here.
///
/// # Errors
/// See [`EditError`].
pub fn apply(text: &str, option: &OptionSpec, change: Change<'_>) -> Result<String, EditError> {
    match change {
        Change::Set(typed) => set(text.trim_start_matches('\u{feff}'), option, typed),
        Change::Unset => unset(text, option),
    }
}

fn set(text: &str, option: &OptionSpec, typed: &str) -> Result<String, EditError> {
    let mut document: DocumentMut = text.parse()?;
    if !option.section.is_empty() && !document.contains_key(option.section) {
        // Comments at the end of the file belong to the section above, and stay there.
        let mut above = document.trailing().as_str().unwrap_or_default().to_owned();
        if !above.is_empty() && !above.ends_with('\n') {
            above.push('\n');
        }
        let is_first = document.is_empty() && above.is_empty();
        let mut table = Table::new();
        table.decor_mut().set_prefix(if is_first { above } else { above + "\n" });
        document.set_trailing("");
        document.insert(option.section, Item::Table(table));
    }
    let root = document.as_table_mut();
    let table: &mut dyn TableLike = match option.section {
        "" => root,
        section => {
            let item = root.get_mut(section).ok_or(EditError::NoSection(section))?;
            item.as_table_like_mut().ok_or(EditError::NoSection(section))?
        }
    };
    let mut new = value(option, typed);
    match table.get_mut(option.name) {
        Some(Item::Value(old)) => {
            // The text behind the value, such as a comment, stays.
            *new.decor_mut() = old.decor().clone();
            *old = new;
        }
        _ => drop(table.insert(option.name, Item::Value(new))),
    }
    Ok(document.to_string())
}

fn unset(text: &str, option: &OptionSpec) -> Result<String, EditError> {
    let body = text.trim_start_matches('\u{feff}');
    let document = Document::parse(body)?;
    let root = document.as_table();
    let section = root.get(option.section);
    let table: &dyn TableLike = match (option.section, section) {
        ("", _) => root,
        (_, None) => return Ok(text.to_owned()),
        (name, Some(item)) => item.as_table_like().ok_or(EditError::NoSection(name))?,
    };
    let Some((key, item)) = table.get_key_value(option.name) else { return Ok(text.to_owned()) };
    let is_in_line = section.is_some_and(Item::is_inline_table) || !item.is_value();
    if let (Some(key), Some(value), false) = (key.span(), item.span(), is_in_line) {
        // Its lines alone: toml_edit would take the comments above them, too, which may be settings of other options.
        let start = body[..key.start].rfind('\n').map_or(0, |end_of_line| end_of_line + 1);
        let end = body[value.end..].find('\n').map_or(body.len(), |length| value.end + length + 1);
        return Ok(format!("{}{}", &body[..start], &body[end..]));
    }
    let mut document = document.into_mut();
    let table: Option<&mut dyn TableLike> = match option.section {
        "" => Some(document.as_table_mut()),
        section => document.get_mut(section).and_then(Item::as_table_like_mut),
    };
    drop(table.and_then(|table| table.remove(option.name)));
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
        for end in ["# transitional_deg = 40\n", "# a\n\n# b", "\n"] {
            let text = format!("[rates]\nfoveal_deg = 20\n{end}");
            let line = if end.ends_with('\n') { "" } else { "\n" };
            assert_eq!(
                set(&text, "gaze.hold_ms", "100"),
                format!("{text}{line}\n[gaze]\nhold_ms = 100\n"),
                "comments stay in their section"
            );
        }
        assert_eq!(set("# all\n", "gaze.hold_ms", "100"), "# all\n\n[gaze]\nhold_ms = 100\n");
        assert_eq!(set("", "gaze.hold_ms", "100"), "[gaze]\nhold_ms = 100\n");
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

    /// In the default file, each option is a commented line, so each comment may be a setting.
    #[test]
    fn unset_takes_no_comment_with_it() {
        let default = default_file();
        for option in OPTIONS {
            let setting = format!("\n#{} = ", option.name);
            let header = format!("[{}]", option.section);
            let section = if option.section.is_empty() { 0 } else { default.find(&header).unwrap() };
            let at = section + default[section..].find(&setting).unwrap() + 1;
            let uncommented = format!("{}{}", &default[..at], &default[at + 1..]);
            let line = default[at..].lines().next().unwrap();
            let unset = apply(&uncommented, option, Change::Unset).unwrap();
            let without = format!("{}{}", &default[..at], &default[at + line.len() + 1..]);
            assert_eq!(unset, without, "{}", option.key());
        }
        let unset = |text: &str, key: &str| apply(text, option(key), Change::Unset).unwrap();
        assert_eq!(
            unset("# a\n[reuse]\n# b\nmode = 'on' # c\n# d\n", "reuse.mode"),
            "# a\n[reuse]\n# b\n# d\n"
        );
        assert_eq!(unset("# a\nrates.mode = 'off'", "rates.mode"), "# a\n");
        assert_eq!(
            unset("# a\nchroma = { mode = 'off', rim_fade = 1 }\n", "chroma.mode"),
            "# a\nchroma = { rim_fade = 1 }\n"
        );
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
