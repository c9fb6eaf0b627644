//! Summaries of doc comments name things by nouns: none begins with a clause, and a ratchet bounds the share with the word "what".

use super::{has, root};
use std::fs;
use std::path::{Path, PathBuf};

/// Allowed share of summaries with "what" below each folder, percent: the last measured value, rounded up. The aim is 2 % everywhere.
const MOST_PERCENT: [(&str, f64); 4] = [("core", 1.0), ("layer", 1.0), ("manifest", 1.0), ("tests", 1.0)];

/// A share that is lower by more than this, percentage points, lowers [`MOST_PERCENT`].
const SLACK_PERCENT: f64 = 1.0;

/// First sentences of the doc comments of a source.
pub(super) fn summaries(source: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut marker_before = None;
    for line in source.lines().map(str::trim_start) {
        let marker =
            ["///", "//!"].into_iter().find(|marker| line.starts_with(marker) && !line.starts_with("////"));
        if let Some(marker) = marker {
            if marker_before != Some(marker) {
                found.push(String::new());
            }
            let text = line[marker.len()..].trim();
            if let Some(comment) = found.last_mut() {
                *comment += if text.is_empty() { "\n" } else { " " };
                *comment += text;
            }
        }
        marker_before = marker;
    }
    let first_sentence = |comment: &String| {
        let paragraph = comment.trim().split('\n').next().unwrap_or_default();
        let end = paragraph.find(". ").map_or(paragraph.len(), |at| at + 1);
        paragraph[..end].to_owned()
    };
    found.iter().map(first_sentence).collect()
}

fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            into.push(path);
        }
    }
}

#[test]
fn summaries_name_things_by_nouns() {
    let mut complaints = Vec::new();
    for (folder, most) in MOST_PERCENT {
        let mut files = Vec::new();
        sources(&root().join(folder), &mut files);
        let (mut all, mut with_what) = (0, 0);
        for file in files {
            let summaries = summaries(&fs::read_to_string(file).unwrap());
            all += summaries.len();
            with_what += summaries.iter().filter(|summary| has(&summary.to_lowercase(), "what")).count();
        }
        assert!(all > 500, "{folder}: {all} summaries");
        let share = 100.0 * with_what as f64 / all as f64;
        println!("{folder}: {with_what} of {all} summaries with \"what\", {share:.2} %");
        if share > most {
            complaints.push(format!("{folder}: {share:.2} %, more than {most} %"));
        } else if share < most - SLACK_PERCENT {
            complaints.push(format!("{folder}: {share:.2} %: lower its share in MOST_PERCENT"));
        }
    }
    assert!(complaints.is_empty(), "summaries with \"what\": {}", complaints.join("; "));
}

/// Beginnings of clauses in the place of a noun.
const CLAUSES: [&str; 13] = [
    "What",
    "Whatever",
    "Who",
    "Whoever",
    "Whose",
    "Which",
    "Whichever",
    "Where",
    "Wherever",
    "Those",
    "How",
    "Why",
    "When",
];

/// Whether a summary begins with a clause.
fn begins_with_a_clause(summary: &str) -> bool {
    let first = summary.trim_start().split(|character: char| !character.is_alphabetic()).next();
    first.is_some_and(|first| CLAUSES.contains(&first))
}

#[test]
fn no_summary_begins_with_a_clause() {
    let mut found = Vec::new();
    for (folder, _) in MOST_PERCENT {
        let mut files = Vec::new();
        sources(&root().join(folder), &mut files);
        for file in files {
            let summaries = summaries(&fs::read_to_string(&file).unwrap());
            let clauses = summaries.into_iter().filter(|summary| begins_with_a_clause(summary));
            found.extend(clauses.map(|summary| format!("{}: {summary}", file.display())));
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
    for clause in
        ["Where the eyes look.", "How many frames", "Those that are left.", "Why it fails.", "When it ends."]
    {
        assert!(begins_with_a_clause(clause), "{clause}");
    }
    for noun in ["Whether the gaze is known.", "Whereabouts", "Number of frames", "`Which` of them"] {
        assert!(!begins_with_a_clause(noun), "{noun}");
    }
}

#[test]
fn summaries_are_first_sentences() {
    let source = "//! A file. What follows\n//! is no summary.\n\n/// A thing of\n/// two lines.\n///\n/// What else.\n\
                  struct A {\n    /// What is in it\n    b: u8, // what\n}\n//// what\n";
    assert_eq!(summaries(source), ["A file.", "A thing of two lines.", "What is in it"]);
}
