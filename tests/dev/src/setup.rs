//! `setup`: brings what is missing where it can, names it where it cannot, and is silent when all is there.

use crate::drivers::unpack_release;
use crate::packages::{Manager, NEEDS, Need, program_in_path};
use crate::steps;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Who asked for the set-up.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Voice {
    /// `cargo dev setup`: always tries, and says so when nothing is missing.
    Asked,
    /// Another task, on its way: what was tried and reported before is not tried and reported again.
    Implied,
}

/// Installs or names what is missing. Something missing is no error: the tasks go on with what is there.
pub fn setup(voice: Voice) -> Result<(), String> {
    if voice == Voice::Asked {
        unpack_release();
    }
    let missing = missing();
    if missing.is_empty() {
        if voice == Voice::Asked {
            println!("cargo dev setup: nothing is missing");
        }
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

fn missing() -> Vec<&'static Need> {
    NEEDS.iter().filter(|need| !need.proof.holds()).collect()
}

fn still(needs: Vec<&'static Need>) -> Vec<&'static Need> {
    needs.into_iter().filter(|need| !need.proof.holds()).collect()
}

/// What to put before a command that needs root: nothing as root, `sudo -n` where it asks no password.
fn root_prefix() -> Option<Vec<&'static str>> {
    let prints_zero = Command::new("id").arg("-u").output().is_ok_and(|id| id.stdout.trim_ascii() == b"0");
    if prints_zero {
        return Some(vec![]);
    }
    let sudo = Command::new("sudo").args(["-n", "true"]).stdout(Stdio::null()).stderr(Stdio::null()).status();
    sudo.is_ok_and(|status| status.success()).then(|| vec!["sudo", "-n"])
}

/// One `apt-get update` and one `apt-get install`. A failure is reported by what is then still missing.
fn install_with_apt(root: &[&str], missing: &[&Need]) {
    let wanted = packages(missing, Manager::Apt);
    eprintln!("cargo dev: installing {}", wanted.join(" "));
    let apt = |arguments: &[&str]| {
        // `env` because sudo drops variables of its own accord.
        let words =
            [root, &["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "--quiet"], arguments].concat();
        let outcome = Command::new(words[0]).args(&words[1..]).stdin(Stdio::null()).status();
        if !outcome.is_ok_and(|status| status.success()) {
            eprintln!("cargo dev: apt-get {} did not succeed", arguments.join(" "));
        }
    };
    apt(&["update"]);
    // Releases differ in what they package; one unknown name would make apt-get install nothing at all.
    let (known, unknown): (Vec<&str>, Vec<&str>) =
        wanted.into_iter().partition(|package| has_candidate(package));
    for package in unknown {
        eprintln!("cargo dev: this release has no package {package}");
    }
    if !known.is_empty() {
        apt(&[&["install", "--yes", "--no-install-recommends"], known.as_slice()].concat());
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

/// Says what is missing, what is lost by it, and the one command that brings it; remembers having said so.
fn report(missing: &[&Need], manager: Option<Manager>) -> Result<(), String> {
    if missing.is_empty() {
        return Ok(());
    }
    eprintln!("cargo dev: missing on this machine, continuing without:");
    for need in missing {
        eprintln!("  {}: without it {}", need.what, need.without);
    }
    match manager {
        Some(manager) => {
            eprintln!("as root: {}", manager.install_command(&packages(missing, manager)));
        }
        None => {
            for manager in Manager::ALL {
                eprintln!("as root: {}", manager.install_command(&packages(missing, manager)));
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

/// The text that stands for a set of missing things; a different set is reported anew.
fn stamp(missing: &[&Need]) -> String {
    missing.iter().map(|need| format!("{}\n", need.what)).collect()
}

fn stamp_path() -> Result<PathBuf, String> {
    Ok(steps::profile_folder()?.join("dev-setup-reported"))
}
