//! Text that users read: no sentence begins with a relative clause, and none has a wording of `wording/banned.txt`.

#[path = "wording/literals.rs"]
mod literals;
#[path = "wording/summaries.rs"]
mod summaries;

use literals::literals;
use parafovea_manifest::options::{Allowed, OPTIONS};
use std::fs;
use std::path::{Path, PathBuf};

const BANNED: &str = include_str!("wording/banned.txt");

/// First words of relative clauses. A question may begin with them.
const RELATIVE: [&str; 10] =
    ["what", "whatever", "who", "whoever", "whose", "which", "whichever", "where", "wherever", "those"];

/// Documents and the installer; all of `tests/baselines` too.
const DOCUMENTS: [&str; 15] = [
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "core/README.md",
    "layer/README.md",
    "manifest/GUIDE.md",
    "manifest/HOW-IT-WORKS.md",
    "manifest/OPTIONS.md",
    "tests/gpu-results/README.md",
    "tests/models/src/errors/README.md",
    "tests/report/README.md",
    "tests/runtime/README.md",
    "tests/scene/README.md",
    "tests/src/dist/install.sh",
];

/// Sources with messages and help texts.
const SOURCES: [&str; 13] = [
    "core/src",
    "layer/audio/src",
    "layer/src",
    "manifest/cli/src",
    "manifest/src",
    "tests/dev/src",
    "tests/sound/src",
    "tests/fuzz/src",
    "tests/report/src",
    "tests/scene/src",
    "tests/src",
    "tests/dev/trial",
    "tests/zoo/src",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Banned wordings, in lower case.
fn banned() -> Vec<String> {
    let lines = BANNED.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty());
    lines.map(|line| line.split("->").next().unwrap_or_default().trim().to_lowercase()).collect()
}

/// Sentences, list items and cells of a text, each with one space between words.
fn sentences(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for block in text.split("\n\n") {
        for item in format!("\n{block}").split("\n- ").flat_map(|item| item.split('|')) {
            let words: Vec<&str> = item.split_whitespace().collect();
            let mut sentence = String::new();
            for (index, word) in words.iter().enumerate() {
                let is_last = index + 1 == words.len();
                sentence += word.trim_start_matches(['#', '*', '_', '`', '"', '(']);
                if is_last || word.ends_with(['.', '?', '!', ':', ';']) {
                    found.push(std::mem::take(&mut sentence));
                } else {
                    sentence.push(' ');
                }
            }
        }
    }
    found.iter().map(|sentence| sentence.trim().to_owned()).filter(|sentence| !sentence.is_empty()).collect()
}

/// Whether `text` has `wording`, neither within a longer word.
fn has(text: &str, wording: &str) -> bool {
    let is_word = |character: Option<char>| character.is_some_and(|character| character.is_alphanumeric());
    text.match_indices(wording).any(|(at, _)| {
        !is_word(text[..at].chars().next_back()) && !is_word(text[at + wording.len()..].chars().next())
    })
}

/// Complaints about a text.
fn complaints(text: &str, banned: &[String]) -> Vec<String> {
    let mut found = Vec::new();
    for sentence in sentences(text) {
        let lower = sentence.to_lowercase();
        let first = lower.split(|character: char| !character.is_alphabetic()).next().unwrap_or_default();
        if RELATIVE.contains(&first) && !sentence.ends_with('?') {
            found.push(format!("begins with a relative clause: {sentence}"));
        }
        for wording in banned.iter().filter(|wording| has(&lower, wording)) {
            found.push(format!("{wording:?} in: {sentence}"));
        }
    }
    found
}

fn rust_files(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            if name != "tests" {
                rust_files(&path, into);
            }
        } else if name.ends_with(".rs") && name != "tests.rs" {
            into.push(path);
        }
    }
}

/// A document without boxes of code, and without code in sentences.
fn prose(document: &str) -> String {
    let outside: Vec<&str> = document.split("```").step_by(2).collect();
    let outside = outside.join("\n\n");
    let lines: Vec<&str> = outside.lines().filter(|line| !line.starts_with("    ")).collect();
    lines.join("\n").split('`').step_by(2).collect::<Vec<_>>().join("code")
}

#[test]
fn documents_are_in_plain_english() {
    let banned = banned();
    let mut found = Vec::new();
    let baselines = fs::read_dir(root().join("tests/baselines")).unwrap().map(|entry| entry.unwrap().path());
    let baselines: Vec<PathBuf> = baselines.filter(|path| path.extension() == Some("md".as_ref())).collect();
    assert!(baselines.len() > 10, "{baselines:?}");
    for path in DOCUMENTS.map(|name| root().join(name)).into_iter().chain(baselines) {
        let (text, name) = (prose(&fs::read_to_string(&path).unwrap()), path.display());
        assert!(text.len() > 500, "{name}: {} bytes", text.len());
        found.extend(complaints(&text, &banned).into_iter().map(|complaint| format!("{name}: {complaint}")));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn option_help_is_in_plain_english() {
    let banned = banned();
    let mut texts: Vec<&str> = OPTIONS.iter().map(|option| option.doc).collect();
    for option in OPTIONS {
        if let Allowed::Choice(choices) = option.allowed() {
            texts.extend(choices.iter().map(|(_, about)| *about));
        }
    }
    assert!(texts.len() > 80, "{}", texts.len());
    let found: Vec<String> = texts.iter().flat_map(|text| complaints(text, &banned)).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
    // Each stands alone: a noun phrase or an imperative, no question in disguise.
    for text in texts {
        let first = text.split_whitespace().next().unwrap_or_default().to_lowercase();
        assert!(!["whether", "how", "when", "for", "if"].contains(&&*first), "{text}");
    }
}

#[test]
fn messages_and_help_are_in_plain_english() {
    let banned = banned();
    let (mut files, mut found, mut texts) = (Vec::new(), Vec::new(), 0);
    SOURCES.iter().for_each(|folder| rust_files(&root().join(folder), &mut files));
    for file in files {
        let source = fs::read_to_string(&file).unwrap();
        let is_cli = file.components().any(|part| part.as_os_str() == "cli");
        for text in literals(&source, is_cli).iter().filter(|text| text.trim().contains(' ')) {
            texts += 1;
            let complaints = complaints(text, &banned);
            found.extend(complaints.into_iter().map(|complaint| format!("{}: {complaint}", file.display())));
        }
    }
    assert!(texts > 500, "{texts} texts");
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn bad_sentences_are_found() {
    let banned = banned();
    let count = |text: &str| complaints(text, &banned).len();
    for sentence in [
        "What is less loud counts as this.",
        "Whoever asks for it gets it.",
        "Fine. Where the device has none, a mask does it.",
        "- fine\n- which passes are the scene",
        "| fine | whose size is known |",
        "dropped, because it does not pay",
        "active, but nothing is to\nbe seen of it",
        "Those that are left",
        "the size of a texel is no power of two",
        "a device that has room for no more",
        "it takes root's rights",
        "the log says why",
    ] {
        assert!(count(sentence) > 0, "{sentence}");
    }
    for fine in [
        "Where does it work?",
        "It lists which passes are left alone, and where.",
        "shading rates: dropped: a slowdown of 20 %",
        "a theme song; thosemes",
        "an impayable sum does not payload",
    ] {
        assert_eq!(complaints(fine, &banned), [""; 0], "{fine}");
    }
    let source = "/// Help\nfn a() { log(\"what is\\\n    here\"); } // \"not this\"\n#[cfg(test)]\nmod tests { x(\"no\") }";
    assert_eq!(literals(source, true), ["Help", "what ishere"]);
    assert_eq!(
        literals("#[allow(x, reason = \"what is\")] let a = ('\"', r#\"raw\"#, \"b\\\"c\");", false),
        ["raw", "b\"c"]
    );
}
