//! Results of all tests, for people.

use parafovea_trial::{Ending, Lack};
use std::collections::BTreeMap;
use std::fmt::{self, Display};
use std::time::Duration;

/// Number of the slowest tests in the list.
const SLOWEST: usize = 10;

/// Number of names in the list for a reason.
const NAMES: usize = 3;

/// Result of a test.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Done {
    /// Its binary's label and its name.
    pub name: String,
    pub ending: Ending,
    pub time: Duration,
    /// The longest that it may take.
    pub limit: Duration,
}

impl Done {
    /// Reason why it counts as failed; None if it does not. Skipped tests that `cargo dev setup` should have made possible fail if
    /// that `is_strict`.
    pub fn failure(&self, is_strict: bool) -> Option<String> {
        match &self.ending {
            Ending::Failed(how) => Some(how.clone()),
            Ending::OverLimit => Some(format!("killed at its time limit of {} s", self.limit.as_secs())),
            Ending::Skipped(lack @ Lack::Setup(_)) if is_strict => Some(format!("skipped: {lack}")),
            Ending::Skipped(_) | Ending::Ignored(_) | Ending::Passed => None,
        }
    }
}

/// All tests that were run.
pub struct Summary {
    pub tests: Vec<Done>,
    /// From the start of the first to the end of the last.
    pub time: Duration,
    /// Whether nothing may be skipped that `cargo dev setup` should have made possible.
    pub is_strict: bool,
}

impl Summary {
    /// Number of failed tests.
    pub fn failed(&self) -> usize {
        self.tests.iter().filter(|test| test.failure(self.is_strict).is_some()).count()
    }
}

impl Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut skipped: BTreeMap<String, Vec<&str>> = BTreeMap::new();
        let mut separate: BTreeMap<String, Vec<&str>> = BTreeMap::new();
        let mut passed = 0;
        for test in self.tests.iter().filter(|test| test.failure(self.is_strict).is_none()) {
            match &test.ending {
                Ending::Skipped(lack) => skipped.entry(lack.to_string()).or_default().push(&test.name),
                Ending::Ignored(reason) => separate.entry(reason.clone()).or_default().push(&test.name),
                _ => passed += 1,
            }
        }
        let count = |reasons: &BTreeMap<String, Vec<&str>>| reasons.values().map(Vec::len).sum::<usize>();
        // In the words of Rust's own test runner, which programs that read the output of test runs know.
        writeln!(
            f,
            "test result: {}. {passed} passed; {} failed; {} ignored; 0 measured; 0 filtered out; finished in {:.2}s",
            if self.failed() == 0 { "ok" } else { "FAILED" },
            self.failed(),
            count(&skipped) + count(&separate),
            self.time.as_secs_f64()
        )?;
        for (title, reasons) in [("skipped", &skipped), ("not part of `test`", &separate)] {
            for (reason, names) in reasons {
                let more = if names.len() > NAMES { ", ..." } else { "" };
                let shown = names[..names.len().min(NAMES)].join(", ");
                writeln!(f, "  {title}: {} of them: {reason} ({shown}{more})", names.len())?;
            }
        }
        let mut slowest: Vec<&Done> = self.tests.iter().collect();
        slowest.sort_by_key(|test| std::cmp::Reverse(test.time));
        writeln!(f, "  slowest:")?;
        for test in slowest.into_iter().take(SLOWEST) {
            writeln!(f, "  {:>7.1} s  {}", test.time.as_secs_f64(), test.name)?;
        }
        if self.failed() > 0 {
            writeln!(f, "  failed:")?;
        }
        for test in &self.tests {
            if let Some(how) = test.failure(self.is_strict) {
                writeln!(f, "    {}: {how}", test.name)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn done(name: &str, ending: Ending, seconds: u64) -> Done {
        let name = format!("layer compose {name}");
        Done { name, ending, time: Duration::from_secs(seconds), limit: Duration::from_secs(60) }
    }

    fn summary(is_strict: bool) -> Summary {
        let mut tests = vec![
            done("hangs", Ending::OverLimit, 60),
            done("fails", Ending::Failed("exit status: 101".to_owned()), 2),
            done("no GPU", Ending::Skipped(Lack::machine("a GPU")), 1),
            done("no device", Ending::Skipped(Lack::setup("a Vulkan device")), 1),
            done("matrix", Ending::Ignored("minutes: cargo dev faults".to_owned()), 0),
        ];
        tests.extend((0..20).map(|number| done(&format!("number {number}"), Ending::Passed, number)));
        Summary { tests, time: Duration::from_secs(100), is_strict }
    }

    #[test]
    fn every_failure_is_named_with_its_cause() {
        let text = summary(false).to_string();
        assert!(text.contains("test result: FAILED. 20 passed; 2 failed; 3 ignored; 0 measured; 0 filtered out; finished in 100.00s"), "{text}");
        assert!(text.contains("layer compose hangs: killed at its time limit of 60 s"), "{text}");
        assert!(text.contains("layer compose fails: exit status: 101"), "{text}");
        assert!(text.contains("not on this machine: a GPU (layer compose no GPU)"), "{text}");
        assert!(text.contains("minutes: cargo dev faults (layer compose matrix)"), "{text}");
    }

    #[test]
    fn the_slowest_come_first_and_are_ten() {
        let text = summary(false).to_string();
        let slowest: Vec<&str> = text.lines().filter(|line| line.contains(" s  ")).collect();
        assert_eq!(slowest.len(), SLOWEST, "{text}");
        assert!(slowest[0].ends_with("hangs") && slowest[1].ends_with("number 19"), "{slowest:?}");
    }

    #[test]
    fn a_skipped_test_fails_where_the_setup_should_have_made_it_possible() {
        let strict = summary(true);
        assert_eq!((summary(false).failed(), strict.failed()), (2, 3));
        let text = strict.to_string();
        assert!(text.contains("20 passed; 3 failed; 2 ignored;"), "{text}");
        assert!(text.contains("layer compose no device: skipped: not installed: a Vulkan device"), "{text}");
    }
}
