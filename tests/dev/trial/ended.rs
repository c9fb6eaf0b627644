//! Outcome of a test, read from its process.

use crate::skip::{self, Lack};
use crate::watch::Watched;
use std::process::ExitStatus;

/// Outcome of a test.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Ending {
    /// It passed.
    Passed,
    /// It failed; how its process ended, and anything else that was wrong.
    Failed(String),
    /// It was still running at its time limit, and was killed.
    OverLimit,
    /// It needs something that is not here.
    Skipped(Lack),
    /// Text of its `#[ignore]`, the condition under which it runs; may be empty.
    Ignored(String),
}

impl Ending {
    pub(crate) fn of(name: Option<&str>, watched: &Watched) -> Self {
        let Some(status) = watched.status else { return Self::OverLimit };
        if !watched.left_behind.is_empty() {
            return Self::Failed(format!(
                "left processes behind, which were killed: {}",
                watched.left_behind.join(", ")
            ));
        }
        read(name, status, &watched.output)
    }
}

fn read(name: Option<&str>, status: ExitStatus, output: &str) -> Ending {
    if status.code() == Some(skip::EXIT_CODE) {
        let reason = output.lines().rev().find_map(|line| Lack::parse(line.strip_prefix(skip::LINE)?));
        return reason.map_or_else(|| Ending::Failed("skipped without a reason".to_owned()), Ending::Skipped);
    }
    if !status.success() {
        return Ending::Failed(status.to_string());
    }
    let Some(name) = name else { return Ending::Passed };
    let ignored = format!("test {name} ... ignored");
    if let Some(rest) = output.lines().find_map(|line| line.strip_prefix(&ignored)) {
        let reason = rest.trim_start_matches([',', ' ']);
        return match Lack::parse(reason) {
            Some(lack) => Ending::Skipped(lack),
            None => Ending::Ignored(reason.to_owned()),
        };
    }
    // A harness is content with a filter that nothing matches.
    if output.contains("test result: ok. 1 passed;") {
        Ending::Passed
    } else {
        Ending::Failed("the test binary did not run it".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::process::ExitStatusExt;

    fn exit(code: i32) -> ExitStatus {
        ExitStatus::from_raw(code << 8)
    }

    #[test]
    fn only_a_test_that_ran_has_passed() {
        let ran = "running 1 test\ntest a::b ... ok\n\ntest result: ok. 1 passed; 0 failed; 0 ignored;";
        assert_eq!(read(Some("a::b"), exit(0), ran), Ending::Passed);
        let none = "running 0 tests\n\ntest result: ok. 0 passed; 0 failed; 0 ignored;";
        assert!(matches!(read(Some("a::b"), exit(0), none), Ending::Failed(_)));
        assert_eq!(read(None, exit(0), "a table"), Ending::Passed);
        assert_eq!(read(Some("a::b"), exit(101), ran), Ending::Failed("exit status: 101".to_owned()));
        let killed = ExitStatus::from_raw(11);
        assert!(matches!(read(None, killed, ""), Ending::Failed(how) if how.contains("signal: 11")));
    }

    #[test]
    fn reasons_are_found() {
        let skipped = "test a ... \nskipped: not installed: hello_xr\n";
        assert_eq!(read(Some("a"), exit(77), skipped), Ending::Skipped(Lack::setup("hello_xr")));
        assert!(matches!(read(Some("a"), exit(77), "no reason"), Ending::Failed(_)));
        let marked = "test a ... ignored, minutes: cargo dev faults\n\ntest result: ok. 0 passed;";
        assert_eq!(read(Some("a"), exit(0), marked), Ending::Ignored("minutes: cargo dev faults".to_owned()));
        let mimic = "test a ... ignored, not on this machine: no GPU\n\ntest result: ok. 0 passed;";
        assert_eq!(read(Some("a"), exit(0), mimic), Ending::Skipped(Lack::machine("no GPU")));
        assert_eq!(read(Some("a"), exit(0), "test a ... ignored\n"), Ending::Ignored(String::new()));
    }
}
