//! The program that this process runs.

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

/// Name of this process's executable: under Wine, of the Windows program that it runs.
pub fn executable() -> PathBuf {
    let program = std::fs::read_link("/proc/self/exe").unwrap_or_default();
    let first_argument = std::env::args_os().next().unwrap_or_default();
    name(&program, &first_argument)
}

/// `program` is the kernel's name of the program, `first_argument` the process's own. Wine's loaders
/// are all called alike, and set the first argument to the Windows path.
fn name(program: &Path, first_argument: &OsStr) -> PathBuf {
    let program = program.file_name().unwrap_or_default();
    if !program.as_bytes().starts_with(b"wine") {
        return PathBuf::from(program);
    }
    let windows_name = first_argument.as_bytes().rsplit(|byte| matches!(byte, b'\\' | b'/')).next();
    match windows_name {
        Some(name) if !name.is_empty() => PathBuf::from(OsStr::from_bytes(name)),
        _ => PathBuf::from(program),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_the_windows_program_under_wine() {
        let wine = Path::new("/proton/files/bin/wine64-preloader");
        assert_eq!(name(wine, OsStr::new(r"C:\Games\Sky\Game.exe")), Path::new("Game.exe"));
        assert_eq!(name(wine, OsStr::new("")), Path::new("wine64-preloader"));
        assert_eq!(name(Path::new("/usr/bin/hello_xr"), OsStr::new("x")), Path::new("hello_xr"));
    }
}
