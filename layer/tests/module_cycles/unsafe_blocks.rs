//! Unsafe blocks are short, so that each has one argument: safe code stands outside. Unsafe functions state their demands.

use super::{modules, source_folder};
use std::collections::BTreeMap;

/// Most lines of an unsafe block, including its braces.
const LONGEST: usize = 15;

/// Unsafe blocks of a source: the number of the first line, from 1, and the number of lines.
fn unsafe_blocks(source: &str) -> Vec<[usize; 2]> {
    let code = without_text(source);
    let starts = code.match_indices("unsafe").filter_map(|(at, word)| {
        let is_word = !code[..at].ends_with(|before: char| before.is_alphanumeric() || before == '_');
        let open = at + word.len();
        let open = open + code[open..].find(|letter: char| !letter.is_whitespace())?;
        (is_word && code[open..].starts_with('{')).then_some((at, open))
    });
    let lines = |text: &str| text.matches('\n').count() + 1;
    starts.map(|(at, open)| [lines(&code[..at]), lines(&code[at..closing_brace(&code, open)])]).collect()
}

/// Index of the brace that closes the one at `open`; the end of the code without one.
fn closing_brace(code: &str, open: usize) -> usize {
    let mut depth = 0;
    for (at, letter) in code[open..].char_indices() {
        match letter {
            '{' => depth += 1,
            '}' if depth == 1 => return open + at,
            '}' => depth -= 1,
            _ => {}
        }
    }
    code.len()
}

/// The code of a source, with its lines, but without comments, strings and characters.
fn without_text(source: &str) -> String {
    let mut code = String::new();
    let mut rest = source;
    while let Some(first) = rest.chars().next() {
        let text = text_length(rest);
        let is_name = code.ends_with(|before: char| before.is_alphanumeric() || before == '_');
        let (kept, length) = match text {
            Some(length) if first != 'r' || !is_name => {
                ("\n".repeat(rest[..length].matches('\n').count()), length)
            }
            _ => (first.to_string(), first.len_utf8()),
        };
        code += &kept;
        rest = &rest[length..];
    }
    code
}

/// The length of the comment, string or character that a source begins with; `None` if it begins with code.
fn text_length(source: &str) -> Option<usize> {
    let until = |end: &str, from: usize| Some(source[from..].find(end).map_or(source.len(), |at| from + at));
    let behind = |end: &str, from: usize| Some(until(end, from)?.saturating_add(end.len()).min(source.len()));
    if source.starts_with("//") {
        return until("\n", 0);
    }
    if source.starts_with("/*") {
        return behind("*/", 2);
    }
    if let Some(raw) = source.strip_prefix('r') {
        let marks = raw.len() - raw.trim_start_matches('#').len();
        return match raw[marks..].starts_with('"') {
            true => behind(&format!("\"{}", "#".repeat(marks)), marks + 2),
            false => None,
        };
    }
    let quote = source.chars().next().filter(|first| ['"', '\''].contains(first))?;
    let mut letters = source.char_indices().skip(1).peekable();
    // A lifetime has no second quote.
    let is_escaped = source[1..].starts_with('\\');
    if quote == '\'' && !is_escaped && source.chars().nth(2) != Some('\'') {
        return None;
    }
    while let Some((at, letter)) = letters.next() {
        match letter {
            '\\' => drop(letters.next()),
            found if found == quote => return Some(at + 1),
            _ => {}
        }
    }
    Some(source.len())
}

#[test]
fn unsafe_blocks_are_short() {
    let mut sources = BTreeMap::new();
    modules(&source_folder(), &[], &mut sources);
    let mut count = 0;
    let mut long = Vec::new();
    for (module, source) in &sources {
        for [line, lines] in unsafe_blocks(source) {
            count += 1;
            if lines > LONGEST {
                long.push(format!("{}.rs:{line}: {lines} lines", module.join("/")));
            }
        }
    }
    assert!(count > 700, "{count} unsafe blocks");
    assert!(long.is_empty(), "unsafe blocks of more than {LONGEST} lines:\n{}", long.join("\n"));
}

/// Unsafe functions of a source without a section on safety in their documentation: the numbers of their lines, from 1. A method of a trait
/// has the section of the trait.
fn silent_functions(source: &str) -> Vec<usize> {
    let is_documentation = |line: &&str| line.starts_with("///") || line.starts_with("#[");
    let mut silent = Vec::new();
    let lines: Vec<&str> = source.lines().map(str::trim_start).collect();
    for (index, line) in lines.iter().enumerate() {
        let function = line.split_once("unsafe ").is_some_and(|(before, after)| {
            let of_abi = after.strip_prefix("extern \"").and_then(|abi| abi.split_once("\" "));
            let is_start = before.is_empty() || before.starts_with("pub") && before.ends_with(' ');
            is_start && of_abi.map_or(after, |(_, after)| after).starts_with("fn ")
        });
        let mut above = lines[..index].iter().rev().copied().take_while(is_documentation);
        if function && !above.any(|line| line == "/// # Safety") {
            silent.push(index + 1);
        }
    }
    silent
}

/// Methods whose trait states the demands.
const OF_TRAITS: [&str; 1] = ["unsafe fn record_upload(&self"];

#[test]
fn unsafe_functions_state_their_demands() {
    let mut sources = BTreeMap::new();
    modules(&source_folder(), &[], &mut sources);
    let mut silent = Vec::new();
    for (module, source) in &sources {
        for line in silent_functions(source) {
            let text = source.lines().nth(line - 1).unwrap_or_default();
            if !OF_TRAITS.iter().any(|method| text.contains(method)) {
                silent.push(format!("{}.rs:{line}: {text}", module.join("/")));
            }
        }
    }
    assert!(silent.is_empty(), "unsafe functions without `# Safety`:\n{}", silent.join("\n"));
}

#[test]
fn silent_unsafe_functions_are_found() {
    let source = "
        /// # Safety
        ///
        /// The device is live.
        #[cold]
        pub(super) unsafe fn a() {}
        /// Nothing.
        unsafe fn b() {}
        pub unsafe extern \"system\" fn c() {}
        type D = unsafe extern \"C\" fn();
        fn e() -> unsafe fn() { unsafe { f() } }
    ";
    assert_eq!(silent_functions(source), [8, 9]);
}

#[test]
fn unsafe_blocks_are_found_among_text() {
    let source = r##"
        unsafe fn f<'a>(text: &'a str) { /* unsafe { */ }
        unsafe impl Send for A {}
        fn g() {
            // SAFETY: no block: unsafe {
            let brace = unsafe { h('{', '\'', "unsafe { \" }") };
            let four = unsafe
            {
                if (r#"}"} unsafe {"#, "\\") == i() { j() }
            };
            not_unsafe { "" };
        }
        unsafe extern "C" { fn k(); }
    "##;
    assert_eq!(unsafe_blocks(source), [[6, 1], [7, 4]]);
}
