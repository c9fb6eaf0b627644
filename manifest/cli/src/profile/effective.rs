//! Effective values, and their sources.

use parafovea_manifest::config::Config;
use parafovea_manifest::options::{OPTIONS, OptionSpec};
use std::collections::BTreeSet;
use toml_edit::{Document, Item};

/// Source of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The file sets it.
    File,
    /// The preset has a value that differs from the default.
    Preset,
    /// Nothing sets it.
    Default,
}

/// An option as it holds.
pub struct Effective {
    /// The option.
    pub option: &'static OptionSpec,
    /// Its value, as it stands in a file.
    pub value: String,
    /// Source of the value.
    pub origin: Origin,
    /// The preset in force, as it stands in a file.
    pub preset: String,
}

/// Every option as it holds by `config`, which was read from `text`.
pub fn effective(config: &Config, text: &str) -> Vec<Effective> {
    let (set, defaults) = (set_in(text), Config::default());
    let preset = OPTIONS.iter().find(|option| option.key() == "preset");
    let preset = preset.map_or(String::new(), |option| option.value(config));
    OPTIONS
        .iter()
        .map(|option| {
            let value = option.value(config);
            let origin = match set.contains(&option.key()) {
                true => Origin::File,
                false if value != option.value(&defaults) => Origin::Preset,
                false => Origin::Default,
            };
            Effective { option, value, origin, preset: preset.clone() }
        })
        .collect()
}

/// Keys of the options that a file sets; none if it is not TOML.
pub fn set_in(text: &str) -> BTreeSet<String> {
    let Ok(document) = Document::parse(text.trim_start_matches('\u{feff}')) else { return BTreeSet::new() };
    let is_set = |option: &&OptionSpec| match option.section {
        "" => document.get(option.name).is_some(),
        section => document
            .get(section)
            .and_then(Item::as_table_like)
            .is_some_and(|table| table.contains_key(option.name)),
    };
    OPTIONS.iter().filter(is_set).map(OptionSpec::key).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_manifest::config::parse;
    use std::path::Path;

    #[test]
    fn each_value_has_its_origin() {
        let text = "preset = 'performance'\nchroma = { mode = 'default' }\nrates.peripheral = '4x4'\n";
        let config = parse(Path::new("x"), text).unwrap();
        let found = effective(&config, text);
        assert_eq!(found.len(), OPTIONS.len());
        let origin = |key: &str| found.iter().find(|value| value.option.key() == key).unwrap().origin;
        for key in ["preset", "chroma.mode", "rates.peripheral"] {
            assert_eq!(origin(key), Origin::File, "{key}");
        }
        assert_eq!(origin("rates.transitional_deg"), Origin::Preset);
        assert_eq!(origin("gaze.source"), Origin::Default);
        assert_eq!(set_in("not = = toml"), BTreeSet::new());
    }
}
