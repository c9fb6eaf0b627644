//! The file of facts: a line with version and checksum, then a line for each shader: identifier, effects, name.

use super::{Facts, Identifier};
use crate::cache_file::{self, checksum};
use crate::vk::shaders::effects::{Effects, FragmentShaders};
use std::fmt::Write as _;
use std::io;
use std::path::Path;
use std::sync::Arc;

/// Beginning of the first line. The number changes with the format and with the facts read from shaders.
const HEADER: &str = "parafovea shaders 2 ";

/// A larger file is not ours.
const MAX_BYTES: u64 = 8 << 20;

/// The facts of a file; `None` for a missing, damaged or differently versioned one.
pub(super) fn read(path: &Path) -> Option<Facts> {
    parse(str::from_utf8(&cache_file::read(path, MAX_BYTES)?).ok()?)
}

/// Writes facts to another file, which then takes the place of the one at `path`.
pub(super) fn write(path: &Path, facts: &Facts) -> io::Result<()> {
    cache_file::write(path, print(facts).as_bytes())
}

pub(super) fn print(facts: &Facts) -> String {
    let mut lines = String::new();
    for (identifier, shaders) in facts.iter() {
        // A name that would not be one line is left out: nothing is known of it then.
        for (name, effects) in shaders.iter().filter(|(name, _)| !name.contains('\n')) {
            for byte in identifier {
                // Writing to a String cannot fail.
                let _ = write!(lines, "{byte:02x}");
            }
            let _ = writeln!(lines, " {:02x} {name}", effects.to_bits());
        }
    }
    format!("{HEADER}{:016x}\n{lines}", checksum(lines.as_bytes()))
}

pub(super) fn parse(text: &str) -> Option<Facts> {
    let (first, lines) = text.split_once('\n')?;
    if u64::from_str_radix(first.strip_prefix(HEADER)?, 16) != Ok(checksum(lines.as_bytes())) {
        return None;
    }
    let mut facts = Facts::default();
    let mut of_module: (Identifier, Vec<(Box<str>, Effects)>) = Default::default();
    for line in lines.lines() {
        let mut words = line.splitn(3, ' ');
        let (identifier, bits, name) = (words.next()?, words.next()?, words.next()?);
        let identifier = bytes(identifier)?;
        let effects = Effects::from_bits(u8::from_str_radix(bits, 16).ok()?)?;
        if identifier != of_module.0 {
            let (of, shaders) = std::mem::replace(&mut of_module, (identifier, Vec::new()));
            keep(&mut facts, of, shaders);
        }
        of_module.1.push((name.into(), effects));
    }
    keep(&mut facts, of_module.0, of_module.1);
    Some(facts)
}

fn keep(facts: &mut Facts, identifier: Identifier, shaders: Vec<(Box<str>, Effects)>) {
    if !shaders.is_empty() {
        facts.insert(identifier, Arc::new(FragmentShaders::from_iter(shaders)));
    }
}

fn bytes(hexadecimal: &str) -> Option<Identifier> {
    let digits = hexadecimal.as_bytes();
    let is_complete = digits.len().is_multiple_of(2) && !digits.is_empty() && digits.len() <= 64;
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
    if is_complete { digits.chunks_exact(2).map(byte).collect() } else { None }
}
