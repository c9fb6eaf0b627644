//! The cookie that lets this user in where the kernel's credentials are not enough: in containers.

use std::path::PathBuf;

/// Length of a cookie, bytes; a server does not talk to a client that sends another one.
const COOKIE_BYTES: usize = 256;

/// The content of the first of these files that can be read. Zeros without a cookie.
pub fn read(files: &[PathBuf]) -> Vec<u8> {
    let mut cookie = files.iter().find_map(|file| std::fs::read(file).ok()).unwrap_or_default();
    cookie.resize(COOKIE_BYTES, 0);
    cookie
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cookie_is_that_of_the_first_file_or_zeros() {
        let folder = tempfile::tempdir().unwrap();
        let [missing, first, second] = ["missing", "first", "second"].map(|name| folder.path().join(name));
        std::fs::write(&first, [1; COOKIE_BYTES]).unwrap();
        std::fs::write(&second, [2; COOKIE_BYTES + 1]).unwrap();
        assert_eq!(read(&[missing.clone(), first, second.clone()]), [1; COOKIE_BYTES]);
        assert_eq!(read(&[second]), [2; COOKIE_BYTES]);
        assert_eq!(read(&[missing]), [0; COOKIE_BYTES]);
    }
}
