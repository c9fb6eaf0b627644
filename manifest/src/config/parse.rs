//! TOML text to [`Config`].

use std::path::Path;
use std::string::FromUtf8Error;

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::error::{ConfigError, ConfigErrors, one_line};
use crate::options::{Config, OPTIONS, OptionSpec, Preset, Setting, keys_named};

/// Greatest number of errors reported of one file.
const MAX_ERRORS: usize = 10;

/// The longest unknown key for which a near one is sought, in bytes.
const MAX_MISSPELT: usize = 64;

/// Least similarity of a key that is proposed (Jaro-Winkler, 0..=1): admits a slip or two, and beginnings.
const MIN_SIMILARITY: f64 = 0.8;

/// The configuration of `text`; options that it does not set have the value of its preset, or their default. `path` is for the errors.
///
/// # Errors
///
/// The text is not TOML (its first error is reported), or has keys or values that are not allowed (all are reported, ten at most). They tell whether
/// the text has `enabled = false`.
pub fn parse(path: &Path, text: &str) -> Result<Config, ConfigErrors> {
    // Editors on Windows put a byte-order mark first.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let (table, syntax_errors) = DeTable::parse_recoverable(text);
    let table = table.get_ref();
    let turns_off = turns_off(table);
    if let Some(first) = syntax_errors.first() {
        return Err(ConfigErrors::of_table(path, vec![syntax_error(text, first)], turns_off));
    }
    let errors = match read(table) {
        Err(findings) => errors(text, findings),
        Ok(config) => match misordered(&config, table) {
            Some(offset) => vec![ConfigError::Misordered {
                line: line_of(text, offset),
                plateau: config.chroma.plateau_deg,
                max: config.chroma.max_eccentricity_deg,
            }],
            None => return Ok(config),
        },
    };
    Err(ConfigErrors::of_table(path, errors, turns_off))
}

/// The error of a file that is not UTF-8. It tells, too, whether the file has `enabled = false`: with a letter of another encoding in a comment, for
/// instance.
pub(super) fn not_text(path: &Path, error: &FromUtf8Error) -> ConfigErrors {
    let line = line_of_bytes(error.as_bytes(), error.utf8_error().valid_up_to());
    let text = String::from_utf8_lossy(error.as_bytes());
    let (table, _) = DeTable::parse_recoverable(&text);
    ConfigErrors::of_table(path, vec![ConfigError::NotText { line }], turns_off(table.get_ref()))
}

/// Whether a table has `enabled = false`.
fn turns_off(table: &DeTable<'_>) -> bool {
    table.get("enabled").is_some_and(|value| value.get_ref().as_bool() == Some(false))
}

/// Something that is not allowed. Cheap to make, since a file can be full of them.
struct Finding<'a> {
    section: &'static str,
    key: &'a Spanned<DeString<'a>>,
    /// `None` where the key is unknown.
    wrong: Option<WrongValue<'a>>,
}

struct WrongValue<'a> {
    value: &'a Spanned<DeValue<'a>>,
    /// `None` where the key is a section's.
    option: Option<&'static OptionSpec>,
}

fn read<'a>(root: &'a DeTable<'a>) -> Result<Config, Vec<Finding<'a>>> {
    // First the preset, wherever it stands: the file's own options take precedence. An invalid preset is found below.
    let preset = root.get("preset").and_then(|value| Preset::read(value.get_ref(), ()));
    let mut config = preset.map_or_else(Config::default, Config::of_preset);
    let mut findings = Vec::new();
    for (key, value) in root {
        match OPTIONS.iter().map(|option| option.section).find(|section| *section == key.get_ref().as_ref()) {
            None | Some("") => read_option("", key, value, &mut config, &mut findings),
            Some(section) => match value.get_ref() {
                DeValue::Table(table) => {
                    for (key, value) in table {
                        read_option(section, key, value, &mut config, &mut findings);
                    }
                }
                _ => findings.push(Finding {
                    section: "",
                    key,
                    wrong: Some(WrongValue { value, option: None }),
                }),
            },
        }
    }
    if findings.is_empty() { Ok(config) } else { Err(findings) }
}

fn read_option<'a>(
    section: &'static str,
    key: &'a Spanned<DeString<'a>>,
    value: &'a Spanned<DeValue<'a>>,
    config: &mut Config,
    findings: &mut Vec<Finding<'a>>,
) {
    let option =
        OPTIONS.iter().find(|option| option.section == section && option.name == key.get_ref().as_ref());
    let wrong = match option {
        None => None,
        Some(option) => match (option.write)(config, value.get_ref()) {
            Ok(()) => return,
            Err(_) => Some(WrongValue { value, option: Some(option) }),
        },
    };
    findings.push(Finding { section, key, wrong });
}

/// Offset of the key to blame if the plateau is not smaller than the angle at which the curves end.
fn misordered(config: &Config, root: &DeTable<'_>) -> Option<usize> {
    if config.chroma.plateau_deg < config.chroma.max_eccentricity_deg {
        return None;
    }
    let set = root.get("chroma")?.get_ref().as_table()?;
    set.iter()
        .filter(|(key, _)| matches!(key.get_ref().as_ref(), "plateau_deg" | "max_eccentricity_deg"))
        .map(|(key, _)| key.span().start)
        .max()
}

fn errors(text: &str, mut findings: Vec<Finding<'_>>) -> Vec<ConfigError> {
    findings.sort_by_key(|finding| finding.key.span().start);
    let omitted = findings.len().saturating_sub(MAX_ERRORS);
    findings.truncate(MAX_ERRORS);
    let mut errors: Vec<_> = findings.iter().map(|finding| error(text, finding)).collect();
    if omitted > 0 {
        errors.push(ConfigError::More { count: omitted });
    }
    errors
}

fn error(text: &str, finding: &Finding<'_>) -> ConfigError {
    let line = line_of(text, finding.key.span().start);
    let name = finding.key.get_ref();
    let key =
        if finding.section.is_empty() { name.to_string() } else { format!("{}.{name}", finding.section) };
    match &finding.wrong {
        None => {
            ConfigError::UnknownKey { line, suggestion: nearest(finding.section, name), key: one_line(&key) }
        }
        Some(wrong) => ConfigError::NotAllowed {
            line,
            value: one_line(text.get(wrong.value.span()).unwrap_or_default()),
            reason: wrong
                .option
                .and_then(|option| (option.reason)(wrong.value.get_ref()))
                .map(|reason| one_line(&reason)),
            allowed: match wrong.option {
                Some(option) => option.allowed_with_unit(),
                None => format!("a section [{key}]"),
            },
            key,
        },
    }
}

fn syntax_error(text: &str, error: &toml::de::Error) -> ConfigError {
    let span = error.span().unwrap_or_default();
    let line = line_of(text, span.start);
    let found = text.get(span).map(str::trim).filter(|found| !found.is_empty());
    let message = one_line(error.message());
    ConfigError::Syntax { line, message, found: found.map(one_line) }
}

/// The line, from 1, of the byte at `offset`.
fn line_of(text: &str, offset: usize) -> usize {
    line_of_bytes(text.as_bytes(), offset)
}

fn line_of_bytes(bytes: &[u8], offset: usize) -> usize {
    1 + bytes.iter().take(offset).filter(|&&byte| byte == b'\n').count()
}

/// The keys that were probably meant: this name in other sections, or the most similar one in this section.
fn nearest(section: &str, name: &str) -> Option<String> {
    if name.len() > MAX_MISSPELT {
        return None;
    }
    if let Some(keys) = keys_named(name) {
        return Some(keys);
    }
    let options = OPTIONS.iter().filter(|option| option.section == section);
    let sections = OPTIONS.iter().map(|option| option.section).filter(|_| section.is_empty());
    options
        .map(|option| (option.name, option.key()))
        .chain(sections.map(|section| (section, section.to_owned())))
        .map(|(candidate, key)| (strsim::jaro_winkler(candidate, name), key))
        .filter(|(similarity, _)| *similarity >= MIN_SIMILARITY)
        .max_by(|(one, _), (other, _)| one.total_cmp(other))
        .map(|(_, key)| key)
}

#[cfg(test)]
mod tests;
