//! `layer/README.md` shows the call order of a frame as the code has it.

use std::fs;
use std::path::{Path, PathBuf};

const README: &str = include_str!("../../layer/README.md");

/// A line of the picture: a function, its file, and its depth.
#[derive(Clone, Copy, Debug)]
struct Call<'a> {
    indent: usize,
    name: &'a str,
    file: &'a str,
}

fn calls(picture: &str) -> Vec<Call<'_>> {
    let call = |line| {
        let text = str::trim_start(line);
        let mut words = text.split_whitespace().filter(|word| *word != "=>");
        let (name, file) = (words.next()?, words.next()?);
        let call = Call { indent: line.len() - text.len(), name, file };
        (call.indent > 0).then_some(call)
    };
    picture.lines().filter_map(call).collect()
}

/// The bodies of the functions with that name, one after the other; empty without any.
fn bodies(source: &str, name: &str) -> String {
    let lines: Vec<&str> = source.lines().collect();
    let is_start = |line: &&str| {
        let after = line.split_once(&format!("fn {name}")).map(|(_, after)| after);
        after.is_some_and(|after| after.starts_with(['(', '<']))
    };
    let mut found = String::new();
    for (start, line) in lines.iter().enumerate().filter(|(_, line)| is_start(line)) {
        let end = format!("{}}}", &line[..line.len() - line.trim_start().len()]);
        for line in &lines[start + 1..] {
            found += line;
            found.push('\n');
            if *line == end {
                break;
            }
        }
    }
    found
}

/// The place after the first call of `name` in `body` from `from` on, also through a pointer (`(table.name)()`) or as a part of a
/// longer name (`tell_name()`).
fn call_after(body: &str, name: &str, from: usize) -> Option<usize> {
    let starts = |at: usize| !body[..at].ends_with(|before: char| before.is_alphanumeric());
    let is_called = |end: usize| {
        let after = &body[end..];
        after.trim_start_matches(')').starts_with('(') || after.starts_with("::<")
    };
    let found = body[from..].match_indices(name).map(|(at, _)| (from + at, from + at + name.len()));
    found.into_iter().find(|(at, end)| starts(*at) && is_called(*end)).map(|(_, end)| end)
}

fn source(file: &str) -> String {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../layer/src").join(file);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn complaints(calls: &[Call]) -> Vec<String> {
    let mut complaints = Vec::new();
    for (index, call) in calls.iter().enumerate() {
        let Call { indent, name, file } = *call;
        let body = bodies(&source(file), name);
        if body.is_empty() {
            complaints.push(format!("{file} has no function {name}"));
        }
        // Its own calls: the calls of the next deeper indent, up to one that is not deeper than itself.
        let below = || calls[index + 1..].iter().take_while(|other| other.indent > indent);
        let deeper = below().map(|other| other.indent).min();
        let mut from = 0;
        for inner in below().filter(|other| Some(other.indent) == deeper) {
            match call_after(&body, inner.name, from) {
                Some(end) => from = end,
                None => complaints.push(format!("{name} of {file} does not call {} there", inner.name)),
            }
        }
    }
    complaints
}

#[test]
fn the_picture_of_a_frame_is_the_codes() {
    let picture = README.split("```").nth(1).unwrap();
    let calls = calls(picture);
    assert!(calls.len() > 40, "{calls:?}");
    assert_eq!(complaints(&calls), [""; 0]);
    let crossings = picture.lines().filter(|line| line.contains("=>"));
    assert!(
        crossings.clone().count() > 2 && crossings.into_iter().all(|line| line.contains("vk/link_table.rs"))
    );
}

#[test]
fn a_wrong_picture_is_found() {
    let wrong = [
        (" end xr/frame.rs\n  frame_started xr/plan.rs\n", 2),
        (" deliver xr/frame.rs\n  complete xr/frame/complete.rs\n  process xr/frame.rs\n", 1),
        (" deliver xr/frame.rs\n  poll inputs/audio.rs\n", 1),
    ];
    for (picture, count) in wrong {
        assert_eq!(complaints(&calls(picture)).len(), count, "{picture}");
    }
}

#[test]
fn locks_and_threads_are_the_codes() {
    fn below(folder: &Path, text: &mut String) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                below(&path, text);
            } else {
                *text += &fs::read_to_string(&path).unwrap();
            }
        }
    }
    let mut code = String::new();
    for folder in ["../layer/src", "../layer/audio/src"] {
        below(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut code);
    }
    let named: Vec<&str> = README.split('`').skip(1).step_by(2).collect();
    let locks: Vec<_> = named.iter().filter_map(|name| name.split_once("::")).collect();
    let threads: Vec<_> = named.iter().filter(|name| name.starts_with("parafovea-")).collect();
    assert!(locks.len() > 5 && threads.len() > 5, "{named:?}");
    for (owner, field) in locks {
        let fields = code.split(&format!("pub struct {owner} {{")).nth(1).unwrap_or_default();
        let fields = fields.split("\n}").next().unwrap_or_default();
        assert!(fields.contains(&format!("{field}: Mutex<")), "{owner}::{field} is no lock");
    }
    for thread in threads {
        assert!(code.contains(&format!("\"{thread}\"")), "{thread}");
    }
}
