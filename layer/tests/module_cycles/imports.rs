//! Paths within the crate that a source names.

/// A path within the crate.
#[derive(Debug, Clone, PartialEq)]
pub struct Import {
    /// The source that names it.
    pub file: String,
    /// The path, from the crate's root on.
    pub path: Vec<String>,
    /// Whether it is re-exported.
    pub is_public: bool,
}

/// The paths within the crate that a source names, in `use` declarations and elsewhere, except in its unit tests.
pub fn imports(module: &[String], source: &str) -> Vec<Import> {
    let source = without_comments(before_tests(source));
    let mut found = Vec::new();
    let mut rest = source.as_str();
    // Declarations, with their braces.
    let mut others = String::new();
    while let Some((before, start)) = split_at_use(rest) {
        let (declaration, after) = start.split_once(';').unwrap_or((start, ""));
        let line = before.rsplit('\n').next().unwrap_or_default().trim();
        others += before;
        for path in leaves(declaration) {
            found.extend(import(module, &path, line.starts_with("pub")));
        }
        rest = after;
    }
    others += rest;
    for root in ["crate::", "super::"] {
        for (at, _) in others.match_indices(root) {
            let is_start = !others[..at].ends_with(|before: char| before.is_alphanumeric() || before == ':');
            let end = others[at..].find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
            let path = &others[at..end.map_or(others.len(), |end| at + end)];
            if is_start {
                let path: Vec<&str> = path.split("::").filter(|part| !part.is_empty()).collect();
                found.extend(import(module, &path, false));
            }
        }
    }
    found
}

fn before_tests(source: &str) -> &str {
    source.split("#[cfg(test)]\nmod ").next().unwrap_or_default()
}

fn without_comments(source: &str) -> String {
    source.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The text before the next `use` that begins a declaration, and the text behind that word.
fn split_at_use(source: &str) -> Option<(&str, &str)> {
    let starts = |at: usize| {
        let line = source[..at].rsplit('\n').next().unwrap_or_default().trim();
        line.is_empty() || line.starts_with("pub")
    };
    let (at, word) = source.match_indices("use ").find(|(at, _)| starts(*at))?;
    Some((&source[..at], &source[at + word.len()..]))
}

/// The paths of a declaration, without new names.
fn leaves(declaration: &str) -> Vec<Vec<&str>> {
    let Some(open) = declaration.find('{') else {
        return vec![parts_of(declaration.split(" as ").next().unwrap_or_default())];
    };
    let before = parts_of(&declaration[..open]);
    let within = &declaration[open + 1..declaration.rfind('}').unwrap_or(declaration.len())];
    let inner = list(within).into_iter().flat_map(leaves);
    inner.map(|inner| before.iter().copied().chain(inner).collect()).collect()
}

fn parts_of(path: &str) -> Vec<&str> {
    path.split("::").map(str::trim).filter(|part| !part.is_empty()).collect()
}

/// The elements of a list, separated by the commas outside of braces.
fn list(text: &str) -> Vec<&str> {
    let (mut elements, mut from, mut depth) = (Vec::new(), 0, 0);
    for (at, letter) in text.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                elements.push(&text[from..at]);
                from = at + 1;
            }
            _ => {}
        }
    }
    elements.push(&text[from..]);
    elements.retain(|element| !element.trim().is_empty());
    elements
}

/// The import of a path; `None` for one of another crate.
fn import(module: &[String], path: &[&str], is_public: bool) -> Option<Import> {
    let supers = path.iter().take_while(|part| **part == "super").count();
    let base = match path.first() {
        Some(&"crate") => &[],
        Some(&"super") => module.get(..module.len().checked_sub(supers)?)?,
        Some(&"self") => module,
        _ => return None,
    };
    let rest = path.iter().filter(|part| !["crate", "super", "self"].contains(part));
    let path = base.iter().cloned().chain(rest.map(|part| (*part).to_owned())).collect();
    Some(Import { file: format!("{}.rs", module.join("/")), path, is_public })
}
