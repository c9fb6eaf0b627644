//! Packages of Debian, unpacked below the target folder by apt: nothing is installed, and no root's rights are needed.

use crate::archive::archive;
use crate::steps::profile_folder;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Debian's keys, from the package debian-archive-keyring.
const KEYS: &str = "/usr/share/keyrings/debian-archive-keyring.gpg";

/// Packages to be unpacked.
pub struct Set {
    /// The folder below `target`.
    pub folder: &'static str,
    /// The suite of Debian's archive.
    pub suite: &'static str,
    pub packages: &'static [&'static str],
    /// Whether everything is unpacked on which the packages depend, down to the C library.
    pub with_dependencies: bool,
}

/// The list of unpacked packages in a set's folder, `name=version` a line, written last.
const PACKAGES_FILE: &str = "packages";

/// Unpacks a set unless it is unpacked, and returns its folder.
///
/// # Errors
/// Debian's archive cannot be reached; errors of apt and of files.
pub fn unpack(set: &Set) -> Result<PathBuf, String> {
    let to = profile_folder()?.parent().ok_or("the target folder is not known")?.join(set.folder);
    let unpacked = fs::read_to_string(to.join(PACKAGES_FILE)).unwrap_or_default();
    if has_all(&unpacked, set.packages) {
        return Ok(to);
    }
    if !Path::new(KEYS).is_file() {
        return Err(format!("{KEYS} is missing"));
    }
    eprintln!("cargo dev: unpacking packages of Debian {} into target/{}", set.suite, set.folder);
    let work = to.with_extension("part");
    remove(&work)?;
    let apt = Apt::new(&work.join("apt"), set)?;
    apt.run(&["update"])?;
    let listed: Vec<String> = set.packages.iter().map(|name| (*name).to_owned()).collect();
    let names = if set.with_dependencies { apt.dependencies(&listed)? } else { listed };
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let archives = work.join("archives");
    make(&archives)?;
    apt.run_in(&archives, &[&["download"], names.as_slice()].concat())?;
    let root = work.join("root");
    let mut packages = Vec::new();
    for archive in read_folder(&archives)? {
        let mut extract = Command::new("dpkg-deb");
        output(extract.arg("--extract").arg(&archive).arg(&root))?;
        let mut show = Command::new("dpkg-deb");
        packages.push(output(show.arg("--show").arg("--showformat=${Package}=${Version}\n").arg(&archive))?);
    }
    packages.sort();
    write(&root.join(PACKAGES_FILE), &packages.concat())?;
    remove(&to)?;
    fs::rename(&root, &to).map_err(|error| format!("{}: {error}", to.display()))?;
    remove(&work)?;
    Ok(to)
}

/// Whether a list of unpacked packages has all of these.
fn has_all(list: &str, packages: &[&str]) -> bool {
    let names: Vec<&str> = list.lines().filter_map(|line| line.split('=').next()).collect();
    packages.iter().all(|package| names.contains(package))
}

/// apt with lists and a cache of its own, to which no package is installed.
struct Apt {
    options: Vec<String>,
}

impl Apt {
    fn new(folder: &Path, set: &Set) -> Result<Self, String> {
        let [lists, cache, sources, status] =
            ["lists", "cache", "sources.list", "status"].map(|name| folder.join(name));
        // apt makes neither by itself in all its versions.
        make(&lists.join("partial"))?;
        make(&cache.join("archives/partial"))?;
        write(&sources, &format!("deb [signed-by={KEYS}] {} {} main\n", archive()?, set.suite))?;
        write(&status, "")?;
        let folders = [
            ("Dir::Etc::sourcelist", &sources),
            ("Dir::State::lists", &lists),
            ("Dir::State::status", &status),
            ("Dir::Cache", &cache),
        ];
        let mut options: Vec<String> =
            folders.iter().map(|(name, path)| format!("{name}={}", path.display())).collect();
        let fixed = [
            "Dir::Etc::sourceparts=-",
            "Acquire::Languages=none",
            "Acquire::Retries=3",
            // Lists of a mirror that is not kept up to date are signed all the same.
            "Acquire::Check-Valid-Until=false",
            // Root's folder may be closed to the user that apt downloads as.
            "APT::Sandbox::User=root",
        ];
        options.extend(fixed.map(str::to_owned));
        Ok(Self { options })
    }

    fn command(&self, program: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new(program);
        command.arg("--quiet").args(self.options.iter().flat_map(|option| ["-o", option]));
        command.args(arguments).env("LC_ALL", "C");
        command
    }

    fn run(&self, arguments: &[&str]) -> Result<(), String> {
        output(&mut self.command("apt-get", arguments)).map(drop)
    }

    fn run_in(&self, folder: &Path, arguments: &[&str]) -> Result<(), String> {
        output(self.command("apt-get", arguments).current_dir(folder)).map(drop)
    }

    /// The packages and all on which they depend.
    fn dependencies(&self, packages: &[String]) -> Result<Vec<String>, String> {
        let words = ["--simulate", "--no-install-recommends", "install"];
        let names: Vec<&str> = packages.iter().map(String::as_str).collect();
        let plan = output(&mut self.command("apt-get", &[&words, names.as_slice()].concat()))?;
        Ok(installed(&plan))
    }
}

/// The packages of a simulated installation: lines `Inst NAME (VERSION ...`.
fn installed(plan: &str) -> Vec<String> {
    let name = |line: &str| Some(line.strip_prefix("Inst ")?.split_whitespace().next()?.to_owned());
    plan.lines().filter_map(name).collect()
}

/// The output of a command; an error with its complaints.
fn output(command: &mut Command) -> Result<String, String> {
    let name = format!("{:?}", command.get_program());
    let output = command.stdin(Stdio::null()).output().map_err(|error| format!("{name}: {error}"))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    Err(format!("{name} ({}): {}", output.status, String::from_utf8_lossy(&output.stderr).trim()))
}

fn read_folder(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let failed = |error| format!("{}: {error}", folder.display());
    fs::read_dir(folder)
        .map_err(failed)?
        .map(|entry| entry.map(|entry| entry.path()).map_err(failed))
        .collect()
}

fn make(folder: &Path) -> Result<(), String> {
    fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
}

fn remove(folder: &Path) -> Result<(), String> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(format!("{}: {error}", folder.display()))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_without_one_of_the_packages_is_made_again() {
        let list = "libdrm2=2.4.123-1\nmesa-drm-shim=25.0.7-2\n";
        assert!(has_all(list, &["mesa-drm-shim", "libdrm2"]));
        assert!(!has_all(list, &["mesa-drm-shim", "libdrm"]));
        assert!(!has_all("", &["libdrm2"]));
    }

    #[test]
    fn packages_are_read_from_a_simulated_installation() {
        let plan = "Reading package lists...\nInst libdrm2 (2.4.134-3 Debian:unstable [amd64])\n\
            Inst libc6 [2.36] (2.43-7 Debian:unstable [amd64]) []\nConf libdrm2 (2.4.134-3)\n";
        assert_eq!(installed(plan), ["libdrm2", "libc6"]);
    }
}
