//! The string literals of a Rust source, read by a small scanner.

/// Texts of a source's string literals, up to its tests, without reasons of lints; with doc comments where these are help texts.
pub fn literals(source: &str, with_doc_comments: bool) -> Vec<String> {
    let source = source.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let mut found = Vec::new();
    let mut rest = source;
    while let Some(first) = rest.chars().next() {
        if rest.starts_with("//") {
            let line = rest.lines().next().unwrap_or_default();
            if let Some(text) = line.strip_prefix("/// ").filter(|_| with_doc_comments) {
                found.push(text.to_owned());
            }
            rest = &rest[line.len()..];
        } else if let Some((text, after)) = raw(rest).or_else(|| quoted(rest)) {
            let before = source[..source.len() - rest.len()].trim_end();
            if !before.ends_with("reason =") {
                found.push(text);
            }
            rest = after;
        } else if let Some(after) = character(rest) {
            rest = after;
        } else {
            rest = &rest[first.len_utf8()..];
        }
    }
    found
}

/// `r"..."` and `r#"..."#`.
fn raw(rest: &str) -> Option<(String, &str)> {
    let after = rest.strip_prefix('r')?;
    let hashes = after.len() - after.trim_start_matches('#').len();
    let body = after[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let at = body.find(&end)?;
    Some((body[..at].to_owned(), &body[at + end.len()..]))
}

/// `"..."`, with its escapes.
fn quoted(rest: &str) -> Option<(String, &str)> {
    let body = rest.strip_prefix('"')?;
    let mut text = String::new();
    let mut characters = body.char_indices();
    while let Some((at, character)) = characters.next() {
        match character {
            '"' => return Some((text, &body[at + 1..])),
            '\\' => match characters.next()?.1 {
                // The line goes on behind the white space of the next.
                '\n' => {
                    let after = characters.as_str();
                    let skipped = after.len() - after.trim_start().len();
                    (0..skipped).for_each(|_| _ = characters.next());
                }
                'n' => text.push('\n'),
                escaped => text.push(escaped),
            },
            other => text.push(other),
        }
    }
    None
}

/// `'x'` and `'\x'`, which may be quotation marks; lifetimes are not.
fn character(rest: &str) -> Option<&str> {
    let body = rest.strip_prefix('\'')?;
    let after = match body.strip_prefix('\\') {
        Some(escaped) => escaped.get(escaped.find('\'').filter(|at| *at > 0)?..)?,
        None => body.get(body.chars().next()?.len_utf8()..)?,
    };
    after.strip_prefix('\'')
}
