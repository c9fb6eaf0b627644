//! Data of a study, from which the coefficients can be fitted anew (paper A, Algorithm 1, lines 1-8).
//!
//! Comma-separated text (RFC 4180) with a header, in any order of columns:
//!
//! | column | meaning | allowed |
//! |---|---|---|
//! | `loudness_lufs` or `gamma_ld` | integrated loudness in LUFS, or gamma_ld of Eq. 1 in loudness units | -200 to 20, 0 to 25 |
//! | `frequency_khz` or `gamma_fq` | frequency in kHz, or gamma_fq of Eq. 3 in kilo-mel | 0.02 to 20, 0.0317 to 3.817 |
//! | `gamma_vis` | visual loss of Eq. 11 in units of Tursun's sensitivity | 0 to 1e9 |
//! | `mu` | score that was given, or a mean of scores | 0 to 100 |
//!
//! Other columns are ignored, and so are lines that begin with `#`.

use super::GAMMA_LD;
use crate::audio::{AudioSettings, gamma_fq, gamma_ld, mel_of_hz};
use csv::{Position, ReaderBuilder, StringRecord, Trim};
use std::ops::RangeInclusive;
use thiserror::Error;

/// One row of D of Algorithm 1: features of sound and picture, and their score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Loudness units, 0..=25.
    pub gamma_ld: f32,
    /// Kilo-mel, 1..=2.5457: limited as in the budget, so that the model that is fitted is the one that is used.
    pub gamma_fq_kilomel: f32,
    /// >= 0, in units of Tursun's sensitivity.
    pub gamma_vis: f32,
    /// Score.
    pub mu: f32,
}

/// Why a study cannot be read. Lines are counted from 1, the header's.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum StudyError {
    /// A column is absent.
    #[error("line {line}: there is no column {wanted}; the header has: {found}")]
    MissingColumn {
        /// Line of the header.
        line: u64,
        /// The name, or both names that would do.
        wanted: String,
        /// The header as it is.
        found: String,
    },
    /// A column is there twice, or in two units.
    #[error("line {line}: {columns} have the same meaning; remove one of them")]
    RepeatedColumn {
        /// Line of the header.
        line: u64,
        /// Their names.
        columns: String,
    },
    /// A value is not a number, or out of range.
    #[error(
        "line {line}, column {column}: {value:?} is not allowed; allowed: a number from {least} to {greatest}"
    )]
    Value {
        /// Line of the text.
        line: u64,
        /// Name of the column.
        column: &'static str,
        /// The text of the cell.
        value: String,
        /// Least number allowed, as written.
        least: String,
        /// Greatest number allowed, as written.
        greatest: String,
    },
    /// A row has more or fewer fields than the header.
    #[error("line {line} has {found} fields; the header has {wanted}")]
    Fields {
        /// Line of the text.
        line: u64,
        /// Fields of this line.
        found: u64,
        /// Fields of the header.
        wanted: u64,
    },
    /// There is no header.
    #[error("the study is empty; the first line names the columns")]
    Empty,
    /// Any other error of the parser.
    #[error("{0}")]
    Syntax(String),
}

/// A column that a study may have.
struct Column {
    name: &'static str,
    allowed: RangeInclusive<f32>,
    /// From the value in the text to the feature.
    feature: fn(f32) -> f32,
}

const LOUDNESS: [Column; 2] = [
    Column {
        name: "loudness_lufs",
        allowed: -200.0..=20.0,
        feature: |lufs| gamma_ld(lufs, &AudioSettings::default()),
    },
    Column { name: "gamma_ld", allowed: GAMMA_LD[0]..=GAMMA_LD[1], feature: same },
];
const FREQUENCY: [Column; 2] = [
    Column {
        name: "frequency_khz",
        allowed: 0.02..=20.0,
        feature: |khz| gamma_fq(Some(mel_of_hz(1000.0 * f64::from(khz)))),
    },
    // Eq. 2 of the same frequencies.
    Column {
        name: "gamma_fq",
        allowed: 0.0317..=3.817,
        feature: |kilomel| gamma_fq(Some(1000.0 * f64::from(kilomel))),
    },
];
const VISUAL_LOSS: [Column; 1] = [Column { name: "gamma_vis", allowed: 0.0..=1e9, feature: same }];
const SCORE: [Column; 1] = [Column { name: "mu", allowed: 0.0..=100.0, feature: same }];

fn same(value: f32) -> f32 {
    value
}

/// Reads a study, row by row, as it is: see [`averaged`] for line 8 of the algorithm.
///
/// Surrounding spaces do not matter. A header without rows is an empty study.
///
/// # Errors
/// Says where the first thing is that is wrong, and what is allowed there: see [`StudyError`].
pub fn parse(text: &str) -> Result<Vec<Entry>, StudyError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut reader = ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| syntax(text, &error))?.clone();
    if header.iter().all(str::is_empty) {
        return Err(StudyError::Empty);
    }
    let loudness = find(text, &header, &LOUDNESS)?;
    let frequency = find(text, &header, &FREQUENCY)?;
    let visual_loss = find(text, &header, &VISUAL_LOSS)?;
    let score = find(text, &header, &SCORE)?;
    reader
        .records()
        .map(|record| {
            let record = record.map_err(|error| syntax(text, &error))?;
            Ok(Entry {
                gamma_ld: value(text, &record, loudness)?,
                gamma_fq_kilomel: value(text, &record, frequency)?,
                gamma_vis: value(text, &record, visual_loss)?,
                mu: value(text, &record, score)?,
            })
        })
        .collect()
}

/// Algorithm 1, line 8: entries with identical features become one, with the mean of their scores, in the order of
/// loudness, frequency and visual loss.
///
/// Identical means equal as f32, to seven digits: what differs by less is rounding in whatever wrote the text.
pub fn averaged(entries: &[Entry]) -> Vec<Entry> {
    // + 0 makes -0 equal to 0.
    let key = |entry: &Entry| [entry.gamma_ld, entry.gamma_fq_kilomel, entry.gamma_vis].map(|x| x + 0.0);
    let mut sorted = entries.to_vec();
    sorted.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.iter().zip(&b).fold(std::cmp::Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(b)))
    });
    let same = |a: &Entry, b: &Entry| key(a).map(f32::to_bits) == key(b).map(f32::to_bits);
    let mean = |group: &[Entry]| {
        let sum: f64 = group.iter().map(|entry| f64::from(entry.mu)).sum();
        Entry { mu: (sum / group.len() as f64) as f32, ..group[0] }
    };
    sorted.chunk_by(same).map(mean).collect()
}

/// Where the one of `columns` stands that the header has.
fn find<'c>(
    text: &str,
    header: &StringRecord,
    columns: &'c [Column],
) -> Result<(usize, &'c Column), StudyError> {
    let line = line(text, header.position());
    let mut found = columns.iter().flat_map(|column| {
        let named = |&(_, name): &(usize, &str)| name == column.name;
        header.iter().enumerate().filter(named).map(move |(index, _)| (index, column))
    });
    let Some(first) = found.next() else {
        let wanted = columns.iter().map(|column| column.name).collect::<Vec<_>>().join(" or ");
        let found = header.iter().collect::<Vec<_>>().join(", ");
        return Err(StudyError::MissingColumn { line, wanted, found });
    };
    match found.next() {
        None => Ok(first),
        Some((_, second)) => {
            let columns = format!("{} and {}", first.1.name, second.name);
            Err(StudyError::RepeatedColumn { line, columns })
        }
    }
}

fn value(text: &str, record: &StringRecord, (index, column): (usize, &Column)) -> Result<f32, StudyError> {
    // The parser has made sure that every record has as many fields as the header.
    let field = record.get(index).unwrap_or_default();
    match field.parse::<f32>() {
        Ok(number) if column.allowed.contains(&number) => Ok((column.feature)(number)),
        _ => Err(StudyError::Value {
            line: line(text, record.position()),
            column: column.name,
            value: field.to_owned(),
            least: column.allowed.start().to_string(),
            greatest: column.allowed.end().to_string(),
        }),
    }
}

fn syntax(text: &str, error: &csv::Error) -> StudyError {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            StudyError::Fields { line: line(text, pos.as_ref()), found: *len, wanted: *expected_len }
        }
        _ => StudyError::Syntax(error.to_string()),
    }
}

/// The line of a record. The parser says where it began to look for it, which is before any blank lines and remarks.
fn line(text: &str, position: Option<&Position>) -> u64 {
    let Some(position) = position else { return 1 };
    let rest = text.get(position.byte() as usize..).unwrap_or_default();
    let skipped = rest.split('\n').map(|line| line.trim_end_matches('\r'));
    position.line() + skipped.take_while(|line| line.is_empty() || line.starts_with('#')).count() as u64
}

#[cfg(test)]
mod tests;
