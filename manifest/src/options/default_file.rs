//! The commented default file.

use std::fmt::Write;

use super::{Allowed, Config, OPTIONS};

/// A configuration file that lists every option with its meaning, what is allowed and its default, all of
/// them commented out: what is not set follows the defaults, also when a later version changes them.
pub fn default_file() -> String {
    let defaults = Config::default();
    let mut text = String::from(
        "# Parafovea. Remove the # before a setting to change it; a running application follows within a second.\n",
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
                    let _ = writeln!(text, "#   \"{name}\":{about}");
                }
            }
            Allowed::Flag | Allowed::Number { .. } | Allowed::Whole { .. } => {
                let _ = writeln!(text, "# Allowed: {}.", option.allowed_with_unit());
            }
        }
        let _ = writeln!(text, "#{} = {}", option.name, option.value(&defaults));
    }
    text
}
