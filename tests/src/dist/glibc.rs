//! Version of the C library that a file needs: games and runtimes bring older ones than the build machine.

/// The newest version that anything may need: that of Ubuntu 22.04.
pub const NEWEST_GLIBC: [u32; 2] = [2, 35];

/// The newest version of a symbol that `library` asks for, major and minor; `None` where it asks for none. Versions stand as text
/// in the table of strings of an ELF file (`.dynstr`).
pub fn newest_glibc(library: &[u8]) -> Option<[u32; 2]> {
    const PREFIX: &[u8] = b"GLIBC_";
    let found = library.windows(PREFIX.len()).enumerate().filter(|(_, window)| *window == PREFIX);
    let version = |(at, _): (usize, &[u8])| {
        let rest = &library[at + PREFIX.len()..];
        let end = rest.iter().position(|byte| !byte.is_ascii_digit() && *byte != b'.')?;
        let mut numbers =
            std::str::from_utf8(&rest[..end]).ok()?.split('.').map(|number| number.parse().ok());
        Some([numbers.next()??, numbers.next()??])
    };
    found.filter_map(version).max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_is_by_number() {
        let strings = b"\0GLIBC_2.4\0GLIBC_2.34\0GLIBC_2.2.5\0GLIBC_PRIVATE\0GLIBC_2.9\0";
        assert_eq!(newest_glibc(strings), Some([2, 34]));
        assert_eq!(newest_glibc(b"\x7fELF"), None);
    }
}
