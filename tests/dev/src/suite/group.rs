//! Unit tests of one binary that share a process: the start of a process costs more than most of them.

use parafovea_trial::{Ending, Trial, Watched, watch};
use std::collections::BTreeMap;
use std::io::Result;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

/// Tests of one binary.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Group {
    pub binary: PathBuf,
    /// The folder of the package.
    pub folder: PathBuf,
    /// The tests' names in the binary, at least one. `None` for a binary without a harness, which is one test.
    pub names: Vec<Option<String>>,
}

/// Outcome of a test of a group.
pub struct Ended {
    pub ending: Ending,
    /// A mean over the tests of its process.
    pub time: Duration,
    pub output: String,
}

impl Group {
    /// Runs the tests, each process within `limit`. Several tests share a process at first; each test that does not pass in it runs again in
    /// a process of its own, which decides its outcome: a test that hangs, ends its process or is skipped does so under its own name.
    pub fn run(&self, limit: Duration) -> Vec<Ended> {
        let shared = if self.names.len() > 1 { self.run_together(limit).ok() } else { None };
        let (outcomes, time) = shared.unwrap_or_default();
        let of = |name: &Option<String>| match name.as_ref().and_then(|name| outcomes.get(name)) {
            Some(Outcome::Passed) => Ended { ending: Ending::Passed, time, output: String::new() },
            outcome => alone(self.run_alone(name.clone(), limit), outcome.is_some()),
        };
        self.names.iter().map(of).collect()
    }

    fn run_alone(&self, name: Option<String>, limit: Duration) -> Result<(Ending, Watched)> {
        let (binary, folder) = (self.binary.clone(), Some(self.folder.clone()));
        Trial { binary, name, even_ignored: false, folder }.run(limit)
    }

    /// Outcomes by name, none for a test that had none; and the mean time of a test.
    fn run_together(&self, limit: Duration) -> Result<(BTreeMap<String, Outcome>, Duration)> {
        let mut command = Command::new(&self.binary);
        command.args(self.names.iter().flatten()).args(["--exact", "--test-threads", "1"]);
        command.current_dir(&self.folder).env("CARGO_MANIFEST_DIR", &self.folder);
        let watched = watch(&mut command, limit)?;
        let mean = watched.time / self.names.len().max(1) as u32;
        // Which of the tests left a process behind is not known.
        let outcomes =
            if watched.left_behind.is_empty() { outcomes(&watched.output) } else { BTreeMap::new() };
        Ok((outcomes, mean))
    }
}

fn alone(run: Result<(Ending, Watched)>, failed_in_group: bool) -> Ended {
    match run {
        Ok((Ending::Passed, watched)) if failed_in_group => Ended {
            ending: Ending::Failed("passes alone, and fails in a process with others".to_owned()),
            time: watched.time,
            output: watched.output,
        },
        Ok((ending, watched)) => Ended { ending, time: watched.time, output: watched.output },
        Err(error) => Ended {
            ending: Ending::Failed(format!("cannot be started: {error}")),
            time: Duration::ZERO,
            output: String::new(),
        },
    }
}

/// Outcome of a test in a process with others.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Outcome {
    Passed,
    Failed,
}

/// Outcomes in the output of the standard harness, by the names of tests. Ignored tests have none.
fn outcomes(output: &str) -> BTreeMap<String, Outcome> {
    let outcome = |line: &str| {
        let (name, ending) = line.strip_prefix("test ")?.split_once(" ... ")?;
        let outcome = match ending {
            "ok" => Outcome::Passed,
            "FAILED" => Outcome::Failed,
            _ => return None,
        };
        Some((name.strip_suffix(" - should panic").unwrap_or(name).to_owned(), outcome))
    };
    output.lines().filter_map(outcome).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn outcomes_are_read_from_the_harness() {
        let output = "\nrunning 4 tests\ntest a::b ... ok\ntest c ... ignored, minutes\ntest d - should panic ... ok\n\
            test e ... FAILED\n\nfailures:\n";
        let expected = [("a::b", Outcome::Passed), ("d", Outcome::Passed), ("e", Outcome::Failed)];
        assert_eq!(outcomes(output), expected.map(|(name, outcome)| (name.to_owned(), outcome)).into());
    }

    /// A test binary of shell: its tests `good` and `bad` pass and fail, `odd` fails beside others, `skipped` ends its process.
    const HARNESS: &str = r#"#!/bin/sh
case $# in 3) is_alone=1;; esac
for name in "$@"; do
    case $name in
        good) echo "test good ... ok";;
        bad) echo "test bad ... FAILED"; failed=1;;
        odd) if [ $is_alone ]; then echo "test odd ... ok"; else echo "test odd ... FAILED"; fi;;
        skipped) echo "skipped: not installed: a server"; exit 77;;
        hanging) sleep 600;;
    esac
done
[ $failed ] && exit 101
echo "test result: ok. 1 passed;"
"#;

    fn endings(names: &[&str], limit: Duration) -> Vec<Ending> {
        let folder =
            std::env::temp_dir().join(format!("parafovea-group-{}-{}", std::process::id(), names.concat()));
        std::fs::create_dir_all(&folder).unwrap();
        let binary = folder.join("harness");
        std::fs::write(&binary, HARNESS).unwrap();
        std::fs::set_permissions(&binary, std::fs::Permissions::from_mode(0o755)).unwrap();
        let names = names.iter().map(|name| Some((*name).to_owned())).collect();
        let ended = Group { binary, folder: folder.clone(), names }.run(limit);
        std::fs::remove_dir_all(folder).unwrap();
        ended.into_iter().map(|ended| ended.ending).collect()
    }

    #[test]
    fn every_test_of_a_group_ends_under_its_own_name() {
        let found = endings(&["good", "bad", "odd", "skipped"], Duration::from_secs(60));
        assert_eq!(found[0], Ending::Passed);
        assert!(matches!(&found[1], Ending::Failed(how) if how.contains("101")), "{found:?}");
        assert!(matches!(&found[2], Ending::Failed(how) if how.contains("with others")), "{found:?}");
        assert!(matches!(found[3], Ending::Skipped(_)), "{found:?}");
    }

    #[test]
    fn a_test_that_hangs_is_killed_and_others_pass() {
        let found = endings(&["good", "hanging", "good"], Duration::from_secs(2));
        assert_eq!(found, [Ending::Passed, Ending::OverLimit, Ending::Passed]);
    }
}
