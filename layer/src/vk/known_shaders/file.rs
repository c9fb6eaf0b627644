//! The file of facts: a line with version and checksum, then a line for each shader: identifier, effects, name.

use super::{Facts, Identifier};
use crate::vk::rates::shader::{Effects, FragmentShaders};
use std::fmt::Write as _;
use std::fs::{self, DirBuilder, OpenOptions};
use std::io::{self, Read, Write as _};
use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt};
use std::path::Path;
use std::sync::Arc;

/// Beginning of the first line. The number changes with the format and with the facts read from shaders.
const HEADER: &str = "parafovea shaders 1 ";

/// A larger file is none of ours.
const MAX_BYTES: u64 = 8 << 20;

/// The facts of a file; `None` for a missing, damaged or differently versioned one.
pub(super) fn read(path: &Path) -> Option<Facts> {
    let flags = libc::O_NOFOLLOW | libc::O_NONBLOCK;
    let file = OpenOptions::new().read(true).custom_flags(flags).open(path).ok()?;
    if !file.metadata().ok()?.is_file() {
        return None;
    }
    let mut text = String::new();
    file.take(MAX_BYTES).read_to_string(&mut text).ok()?;
    parse(&text)
}

/// Writes facts to another file, which then takes the place of the one at `path`.
pub(super) fn write(path: &Path, facts: &Facts) -> io::Result<()> {
    let folder = path.parent().ok_or(io::ErrorKind::InvalidInput)?;
    DirBuilder::new().recursive(true).mode(0o700).create(folder)?;
    let next = folder.join(format!(".shaders.{}", std::process::id()));
    let mut file = OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(true)
        .mode(0o600)
        .custom_flags(libc::O_NOFOLLOW)
        .open(&next)?;
    let written = file.write_all(print(facts).as_bytes()).and_then(|()| fs::rename(&next, path));
    written.inspect_err(|_| drop(fs::remove_file(&next)))
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
    format!("{HEADER}{:016x}\n{lines}", checksum(&lines))
}

pub(super) fn parse(text: &str) -> Option<Facts> {
    let (first, lines) = text.split_once('\n')?;
    if u64::from_str_radix(first.strip_prefix(HEADER)?, 16) != Ok(checksum(lines)) {
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
    let is_whole = digits.len().is_multiple_of(2) && !digits.is_empty() && digits.len() <= 64;
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
    if is_whole { digits.chunks_exact(2).map(byte).collect() } else { None }
}

/// FNV-1a, 64 bits: against damage, not against somebody.
fn checksum(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}
