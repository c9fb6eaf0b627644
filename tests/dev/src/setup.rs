//! `setup`: installs missing requirements, or names them, and prints nothing if none is missing.

use crate::drivers::unpack_release;
use crate::meter::Meter;
use crate::packages::{Manager, NEEDS, Need, program_in_path};
use crate::steps;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, ExitStatus, Stdio};

/// Origin of the request for the set-up.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Voice {
    /// `cargo dev setup`: always tries, and prints a line if nothing is missing.
    Asked,
    /// Runs as part of another task: an attempt that was made and reported before is not repeated.
    Implied,
}

/// Installs or names missing requirements. A missing requirement is not an error: the tasks go on without it.
pub fn setup(voice: Voice) -> Result<(), String> {
    if voice == Voice::Asked {
        unpack_release();
    }
    let missing = missing(|_| true);
    if missing.is_empty() && voice == Voice::Asked {
        println!("cargo dev setup: nothing is missing");
    }
    bring(voice, missing)
}

/// As [`setup`] implied by a task, of the demo's needs alone: a first look is not to wait for servers and compilers of the tests.
pub fn setup_for_demo() -> Result<(), String> {
    bring(Voice::Implied, missing(|need| need.for_demo))
}

fn bring(voice: Voice, missing: Vec<&'static Need>) -> Result<(), String> {
    if missing.is_empty() {
        return Ok(());
    }
    if voice == Voice::Implied && already_reported(&missing) {
        let names: Vec<&str> = missing.iter().map(|need| need.what).collect();
        eprintln!("cargo dev: still missing: {} (`cargo dev setup` tries again)", names.join("; "));
        return Ok(());
    }
    let manager = Manager::ALL.into_iter().find(|manager| program_in_path(manager.program()));
    if manager == Some(Manager::Apt)
        && let Some(prefix) = root_prefix()
    {
        install_with_apt(&prefix, &missing);
    }
    report(&still(missing), manager)
}

fn missing(is_asked: impl Fn(&Need) -> bool) -> Vec<&'static Need> {
    NEEDS.iter().filter(|need| is_asked(need) && !need.proof.holds()).collect()
}

fn still(needs: Vec<&'static Need>) -> Vec<&'static Need> {
    needs.into_iter().filter(|need| !need.proof.holds()).collect()
}

/// Prefix of a command that needs root: none as root, `sudo -n` if it asks for no password.
fn root_prefix() -> Option<Vec<&'static str>> {
    let prints_zero = Command::new("id").arg("-u").output().is_ok_and(|id| id.stdout.trim_ascii() == b"0");
    if prints_zero {
        return Some(vec![]);
    }
    let sudo = Command::new("sudo").args(["-n", "true"]).stdout(Stdio::null()).stderr(Stdio::null()).status();
    sudo.is_ok_and(|status| status.success()).then(|| vec!["sudo", "-n"])
}

/// One `apt-get update` and one `apt-get install`. A failure shows in the requirements that are still missing afterwards.
fn install_with_apt(root: &[&str], missing: &[&Need]) {
    let wanted = packages(missing, Manager::Apt);
    eprintln!("cargo dev: installing {}", wanted.join(" "));
    let apt = |arguments: &[&str]| {
        // `env` because sudo drops variables of its own accord.
        let apt_get: &[&str] =
            &["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "--quiet", "-o", "APT::Status-Fd=9"];
        let words = [root, &STATUS_APART, apt_get, arguments].concat();
        if !run_with_progress(&words).is_ok_and(|status| status.success()) {
            eprintln!("cargo dev: apt-get {} failed", arguments.join(" "));
        }
    };
    apt(&["update"]);
    // Releases differ in their packages; one unknown name would make apt-get install nothing at all.
    let (known, unknown): (Vec<&str>, Vec<&str>) =
        wanted.into_iter().partition(|package| has_candidate(package));
    for package in unknown {
        eprintln!("cargo dev: this release of the system has no package {package}");
    }
    if !known.is_empty() {
        apt(&[&["install", "--yes", "--no-install-recommends"], known.as_slice()].concat());
    }
}

/// Prefix of a command: its descriptor 9 goes to standard output, and its messages are dropped. If apt-get's state went to its own standard
/// output, installation scripts that print would fail on systems without /dev/pts. The shell is behind sudo, which closes descriptors.
const STATUS_APART: [&str; 4] = ["sh", "-c", "exec \"$@\" 9>&1 >/dev/null", "sh"];

/// Runs apt-get, whose state comes from standard output, and shows its progress. Its errors go to standard error.
fn run_with_progress(words: &[&str]) -> std::io::Result<ExitStatus> {
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).stdin(Stdio::null()).stdout(Stdio::piped());
    let mut child = command.spawn()?;
    let mut meter = Meter::new("apt-get");
    for line in child.stdout.take().into_iter().flat_map(|output| BufReader::new(output).split(b'\n')) {
        if let Some((done, what)) = apt_progress(&String::from_utf8_lossy(&line?)) {
            meter.show(done, what);
        }
    }
    meter.end();
    child.wait()
}

/// The share of the whole that apt-get has done, downloads for one half and installation for the other, and the work in hand; none for
/// other lines.
fn apt_progress(line: &str) -> Option<(f64, &str)> {
    let mut fields = line.splitn(4, ':');
    let (kind, _, percent, what) = (fields.next()?, fields.next()?, fields.next()?, fields.next()?);
    let share = percent.parse::<f64>().ok()? / 100.0;
    match kind {
        "dlstatus" => Some((share / 2.0, what)),
        "pmstatus" => Some((0.5 + share / 2.0, what)),
        _ => None,
    }
}

fn has_candidate(package: &str) -> bool {
    let policy = Command::new("apt-cache").env("LC_ALL", "C").args(["policy", package]).output();
    policy.is_ok_and(|policy| {
        let text = String::from_utf8_lossy(&policy.stdout).into_owned();
        text.contains("Candidate:") && !text.contains("Candidate: (none)")
    })
}

fn packages(needs: &[&Need], manager: Manager) -> Vec<&'static str> {
    let mut names: Vec<&str> = needs.iter().map(|need| need.package(manager)).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// Names missing requirements, the consequence, and the one command that installs them; remembers the message.
fn report(missing: &[&Need], manager: Option<Manager>) -> Result<(), String> {
    if missing.is_empty() {
        return Ok(());
    }
    eprintln!("cargo dev: missing on this machine; continuing without:");
    for need in missing {
        eprintln!("  {}: without it {}", need.what, need.without);
    }
    match manager {
        Some(manager) => {
            eprintln!("to install, as root: {}", manager.install_command(&packages(missing, manager)));
        }
        None => {
            for manager in Manager::ALL {
                eprintln!("to install, as root: {}", manager.install_command(&packages(missing, manager)));
            }
        }
    }
    let path = stamp_path()?;
    std::fs::write(&path, stamp(missing)).map_err(|error| format!("cannot write {}: {error}", path.display()))
}

fn already_reported(missing: &[&Need]) -> bool {
    let earlier = stamp_path().ok().and_then(|path| std::fs::read_to_string(path).ok());
    earlier.is_some_and(|earlier| earlier == stamp(missing))
}

/// The text that stands for a set of missing things; a different set is reported again.
fn stamp(missing: &[&Need]) -> String {
    missing.iter().map(|need| format!("{}\n", need.what)).collect()
}

fn stamp_path() -> Result<PathBuf, String> {
    Ok(steps::profile_folder()?.join("dev-setup-reported"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn apt_tells_downloads_from_installation() {
        assert_eq!(
            apt_progress("dlstatus:3:50.0000:Retrieving file 3 of 7"),
            Some((0.25, "Retrieving file 3 of 7"))
        );
        assert_eq!(apt_progress("pmstatus:libc6:50.0:Unpacking libc6"), Some((0.75, "Unpacking libc6")));
        assert_eq!(apt_progress("Reading package lists..."), None);
        assert_eq!(apt_progress("Setting up x: a: b: c"), None);
    }
    #[test]
    fn the_state_of_apt_is_apart_from_its_messages() {
        let apt_get = ["sh", "-c", "echo message; echo pmstatus:a:50.0:Unpacking a >&9"];
        let words = [&STATUS_APART[..], &apt_get].concat();
        let output = Command::new(words[0]).args(&words[1..]).output().unwrap();
        assert_eq!(output.stdout, b"pmstatus:a:50.0:Unpacking a\n");
        assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}
