//! The commented default file.

use std::fmt::Write;

use super::{Allowed, Config, OPTIONS};

/// A configuration file that lists every option with its meaning, allowed values and default, all of them commented out: unset options
/// follow the defaults, also when a later version changes them.
pub fn default_file() -> String {
    let defaults = Config::default();
    let mut text = String::from(
        "# Parafovea. Remove the # before a setting to change it; a running application applies the change within a second.\n",
    );
    let mut section = "";
    for option in OPTIONS {
        if option.section != section {
            section = option.section;
            // Writing to a String cannot fail.
            let _ = write!(text, "\n[{section}]\n");
        }
        let _ = write!(text, "\n# {}\n", option.doc);
        match option.allowed() {
            Allowed::Choice(choices) => {
                for (name, about) in choices {
                    let _ = writeln!(text, "#   \"{name}\": {}", about.trim_ascii());
                }
            }
            Allowed::Flag | Allowed::Number { .. } | Allowed::Whole { .. } | Allowed::Text(_) => {
                let _ = writeln!(text, "# Allowed: {}.", option.allowed_with_unit());
            }
        }
        let _ = writeln!(text, "#{} = {}", option.name, option.value(&defaults));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::parse;
    use std::path::Path;

    /// The default file with its settings in force.
    fn uncommented() -> String {
        let setting = |line: &str| {
            line.strip_prefix('#').filter(|rest| !rest.starts_with(' ')).unwrap_or(line).to_owned() + "\n"
        };
        default_file().lines().map(setting).collect()
    }

    #[test]
    fn it_changes_nothing_with_its_settings_commented_out_or_not() {
        for text in [default_file(), uncommented()] {
            assert_eq!(parse(Path::new("default.toml"), &text).unwrap(), Config::default(), "{text}");
        }
    }

    #[test]
    fn it_sets_every_option_once() {
        let table: toml::Table = uncommented().parse().unwrap();
        let count: usize = table.values().map(|value| value.as_table().map_or(1, toml::Table::len)).sum();
        assert_eq!(count, OPTIONS.len());
        for option in OPTIONS {
            let section =
                if option.section.is_empty() { &table } else { table[option.section].as_table().unwrap() };
            assert!(section.contains_key(option.name), "{}", option.key());
        }
    }
}
