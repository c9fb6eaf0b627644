//! Signals by which a test reports that it cannot run here.

use std::fmt::{self, Display};
use std::io::Write;

/// Set for tests that run as a process of their own; children inherit it.
pub(crate) const VARIABLE: &str = "PARAFOVEA_TRIAL";

/// The exit code of a skipped test, as in Automake's test harness.
pub(crate) const EXIT_CODE: i32 = 77;

/// Begins the line with the reason.
pub(crate) const LINE: &str = "skipped: ";

/// Something that a test needs and that is not here.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Lack {
    /// `cargo dev setup` installs it: in CI, its absence is a failure.
    Setup(String),
    /// A property of this machine, such as its GPU, its kernel's settings or its distribution.
    Machine(String),
}

const SETUP: &str = "not installed: ";
const MACHINE: &str = "not on this machine: ";

impl Lack {
    /// Something that `cargo dev setup` installs.
    pub fn setup(what: impl Display) -> Self {
        Self::Setup(what.to_string())
    }

    /// A property of this machine.
    pub fn machine(what: impl Display) -> Self {
        Self::Machine(what.to_string())
    }

    /// The inverse of `to_string`; None for the text of something else.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let setup = || text.strip_prefix(SETUP).map(Self::setup);
        text.strip_prefix(MACHINE).map(Self::machine).or_else(setup)
    }
}

/// A reason for libtest-mimic's `Completion::ignored_with` too.
impl Display for Lack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Setup(what) => write!(f, "{SETUP}{what}"),
            Self::Machine(what) => write!(f, "{MACHINE}{what}"),
        }
    }
}

/// Ends the running test as skipped, which takes its process. Where the process is not the test's own (`cargo test`), the
/// test fails: the standard harness cannot skip a test that has begun, and a pass would be a lie.
///
/// # Panics
/// The process is not the test's own.
pub fn skip(lack: &Lack) -> ! {
    if std::env::var_os(VARIABLE).is_none() {
        eprintln!("cannot run here: {lack} (`cargo dev test` skips it)");
        std::panic::panic_any(lack.clone());
    }
    // Nothing can be done about a closed stderr; the exit code reports the same.
    drop(writeln!(std::io::stderr(), "\n{LINE}{lack}"));
    std::process::exit(EXIT_CODE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_read_as_they_are_written() {
        for lack in [Lack::setup("hello_xr"), Lack::machine("no GPU")] {
            assert_eq!(Lack::parse(&lack.to_string()), Some(lack));
        }
        assert_eq!(Lack::parse("minutes: cargo dev faults"), None);
    }
}
