//! A process and all that it started, found in `/proc`: process groups and parents are left by daemons, the environment is
//! inherited by all but the few that clear it.

use std::collections::BTreeSet;
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{fs, io};

/// A process that is alive.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Process {
    pub id: u32,
    parent: u32,
    /// The name of its program, as `ps` prints it.
    pub name: String,
    is_marked: bool,
}

impl Process {
    /// None for a process that has ended.
    fn read(id: u32, mark: &str) -> Option<Self> {
        let (name, state, parent) = parse_stat(&fs::read_to_string(format!("/proc/{id}/stat")).ok()?)?;
        let is_of_the_kernel = id == KERNEL_THREADS || parent == KERNEL_THREADS;
        let environment = if is_of_the_kernel {
            Vec::new()
        } else {
            environment(|| fs::read(format!("/proc/{id}/environ")))
        };
        let is_marked = environment.split(|byte| *byte == 0).any(|variable| variable == mark.as_bytes());
        (state != 'Z' && state != 'X').then_some(Self { id, parent, name, is_marked })
    }

    /// Whether it has not ended: after a kill, that takes a busy machine a moment.
    pub fn is_alive(&self) -> bool {
        Self::read(self.id, "").is_some_and(|now| now.name == self.name)
    }
}

/// The process that starts the threads of the kernel, which have no environment.
const KERNEL_THREADS: u32 = 2;

/// Reads of an environment that is empty, and the time between two: a process has none while it replaces its program by another.
const READS: u32 = 4;
const BETWEEN_READS: Duration = Duration::from_millis(1);

/// An environment by `read`; empty for a process of another user, as its environment is private.
fn environment(mut read: impl FnMut() -> io::Result<Vec<u8>>) -> Vec<u8> {
    for _ in 1..READS {
        match read() {
            Ok(environment) if environment.is_empty() => std::thread::sleep(BETWEEN_READS),
            result => return result.unwrap_or_default(),
        }
    }
    read().unwrap_or_default()
}

/// The name, the state and the parent of a line of `/proc/PID/stat`. The name may contain anything.
fn parse_stat(line: &str) -> Option<(String, char, u32)> {
    let (before, after) = line.rsplit_once(") ")?;
    let name = before.split_once('(')?.1.to_owned();
    let mut fields = after.split(' ');
    Some((name, fields.next()?.chars().next()?, fields.next()?.parse().ok()?))
}

/// Live processes with `mark` (`VARIABLE=value`) in their environment, and all that these and `root` started.
pub fn family(root: Option<u32>, mark: &str) -> Vec<Process> {
    let entries = fs::read_dir("/proc").into_iter().flatten().flatten();
    let ids = entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    members(root, ids.filter_map(|id| Process::read(id, mark)).collect())
}

fn members(root: Option<u32>, all: Vec<Process>) -> Vec<Process> {
    let marked = all.iter().filter(|process| process.is_marked || Some(process.id) == root);
    let mut ids: BTreeSet<u32> = marked.map(|process| process.id).collect();
    loop {
        let before = ids.len();
        let children = all.iter().filter(|process| ids.contains(&process.parent));
        let children: Vec<u32> = children.map(|process| process.id).collect();
        ids.extend(children);
        if ids.len() == before {
            return all.into_iter().filter(|process| ids.contains(&process.id)).collect();
        }
    }
}

/// Kills processes. One that has ended is not an error.
pub fn kill(processes: &[Process]) {
    if processes.is_empty() {
        return;
    }
    let ids: Vec<String> = processes.iter().map(|process| process.id.to_string()).collect();
    // The standard library has no way to kill a process that it did not start.
    let mut command = Command::new("sh");
    command.args(["-c", "kill -s KILL \"$@\"", "sh"]).args(ids);
    drop(command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_may_contain_anything() {
        let line = "42 (a ) b) S 7 42 42 0 -1 4194560";
        assert_eq!(parse_stat(line), Some(("a ) b".to_owned(), 'S', 7)));
        assert_eq!(parse_stat(""), None);
    }

    #[test]
    fn an_environment_is_read_again_where_it_is_empty() {
        let found = |answers: &[Option<&str>]| {
            let mut answers = answers.iter();
            let environment = environment(|| {
                let answer = answers.next().expect("no more reads than answers");
                answer.map(|text| text.as_bytes().to_vec()).ok_or(io::ErrorKind::PermissionDenied.into())
            });
            (String::from_utf8(environment).unwrap(), answers.len())
        };
        assert_eq!(found(&[Some("A=1"), Some("B=2")]), ("A=1".to_owned(), 1));
        assert_eq!(found(&[Some(""), Some(""), Some(""), Some("A=1")]), ("A=1".to_owned(), 0));
        assert_eq!(found(&[Some(""); 5]), (String::new(), 1));
        assert_eq!(found(&[None, Some("A=1")]), (String::new(), 1));
    }

    #[test]
    fn a_family_is_the_root_the_marked_and_their_children() {
        let process = |id, parent, is_marked| Process { id, parent, name: String::new(), is_marked };
        // 5 cleared its environment and is a child of 4, which lost its parent.
        let all = vec![
            process(1, 0, false),
            process(2, 1, false),
            process(3, 2, false),
            process(5, 4, false),
            process(4, 1, true),
            process(6, 1, false),
        ];
        let ids = |root| members(root, all.clone()).iter().map(|process| process.id).collect::<Vec<_>>();
        assert_eq!(ids(Some(2)), [2, 3, 5, 4]);
        assert_eq!(ids(None), [5, 4]);
    }
}
