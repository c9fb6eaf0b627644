//! All tests of the workspace, in processes with a time limit: unit tests share some, every other test has its own.

mod binaries;
mod group;
mod summary;
mod times;
mod workers;

use crate::steps::profile_folder;
use crate::tasks::{in_root, workspace};
use binaries::{Binary, binaries, names};
use group::{Ended, Group};
use parafovea_trial::{Ending, watch};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use summary::Done;
pub use summary::Summary;
use times::Times;

/// The longest that a test, or a process with several, may take: far above the slowest, since machines are shared.
const LIMIT: Duration = Duration::from_secs(1800);

/// The longest that a test binary may take to list its tests.
const LIST_LIMIT: Duration = Duration::from_secs(120);

/// Unit tests that share a process at most: few enough that processors share the work.
const GROUP: usize = 64;

/// Processes at a time for each processor: some tests wait for servers, and for frames in real time.
const PER_PROCESSOR: usize = 2;

/// Selection of tests, and the meaning of a failure.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Options {
    /// Whether a skipped test is a failure if `cargo dev setup` should have made it possible.
    pub is_strict: bool,
    /// A part of the names of the tests to be run. None: all.
    pub part: Option<String>,
}

impl Options {
    /// The arguments of `cargo dev test`; CI (the variable `CI`) is strict.
    pub fn parse(arguments: &[String], is_ci: bool) -> Result<Self, String> {
        let mut options = Self { is_strict: is_ci, part: None };
        for argument in arguments {
            match argument.as_str() {
                "--strict" => options.is_strict = true,
                option if option.starts_with('-') => {
                    return Err(format!(
                        "`test` accepts --strict and a part of the test names, not `{option}`"
                    ));
                }
                part if options.part.is_none() => options.part = Some(part.to_owned()),
                extra => {
                    return Err(format!("`test` accepts one part of the test names; unexpected: `{extra}`"));
                }
            }
        }
        Ok(options)
    }

    fn wants(&self, name: &str) -> bool {
        self.part.as_ref().is_none_or(|part| name.contains(part))
    }
}

/// Tests that share a process, and the names under which they are reported.
pub struct Named {
    names: Vec<String>,
    group: Group,
}

/// Runs the tests, twice as many processes at once as there are processors, and prints each.
///
/// # Errors
/// The file with the times of the last run cannot be written.
pub fn run(mut named: Vec<Named>, is_strict: bool) -> Result<Summary, String> {
    let file = profile_folder()?.join("dev-test-times");
    let mut times = Times::load(&file);
    let time = |named: &Named| times.of(named.names.iter().map(String::as_str));
    named.sort_by_key(|named| std::cmp::Reverse(time(named)));
    let workers = PER_PROCESSOR * std::thread::available_parallelism().map_or(1, usize::from);
    let count: usize = named.iter().map(|named| named.names.len()).sum();
    eprintln!("cargo dev: {count} tests, {workers} processes at a time");
    let start = Instant::now();
    let tests = workers::run(workers, named, |named| run_group(named, is_strict));
    let tests: Vec<Done> = tests.into_iter().flatten().collect();
    let time = start.elapsed();
    tests.iter().for_each(|test| times.set(&test.name, test.time));
    times.save(&file).map_err(|error| format!("cannot write {}: {error}", file.display()))?;
    Ok(Summary { tests, time, is_strict })
}

fn run_group(named: Named, is_strict: bool) -> Vec<Done> {
    let ended = named.group.run(LIMIT);
    named.names.into_iter().zip(ended).map(|(name, ended)| report(name, ended, is_strict)).collect()
}

fn report(name: String, ended: Ended, is_strict: bool) -> Done {
    let Ended { ending, time, output } = ended;
    let done = Done { name, ending, time, limit: LIMIT };
    let seconds = done.time.as_secs_f64();
    match (&done.ending, done.failure(is_strict)) {
        // One write, so that nothing of another worker comes between.
        (_, Some(how)) => eprintln!("FAILED   {seconds:>7.2} s  {}: {how}\n{output}", done.name),
        (Ending::Skipped(lack), None) => eprintln!("skipped  {seconds:>7.2} s  {}: {lack}", done.name),
        (Ending::Ignored(_), None) => {}
        (_, None) => eprintln!("passed   {seconds:>7.2} s  {}", done.name),
    }
    done
}

/// Builds all test binaries, and returns the wanted tests.
///
/// # Errors
/// Cargo cannot build them, a binary does not list its tests, or none is wanted.
pub fn build(options: &Options) -> Result<Vec<Named>, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().map_err(|error| format!("{}: {error}", root.display()))?;
    let mut tests = Vec::new();
    for binary in built(&root)? {
        let names = if binary.has_harness { listed(&binary)? } else { vec![None] };
        tests.extend(groups(&binary, names, options));
    }
    if tests.is_empty() { Err("no test has this in its name".to_owned()) } else { Ok(tests) }
}

/// The wanted tests of a binary, by the processes that they share.
fn groups(binary: &Binary, names: Vec<Option<String>>, options: &Options) -> Vec<Named> {
    let label = &binary.label;
    let full =
        |name: &Option<String>| name.as_ref().map_or_else(|| label.clone(), |name| format!("{label} {name}"));
    let wanted: Vec<Option<String>> = names.into_iter().filter(|name| options.wants(&full(name))).collect();
    let group = |names: &[Option<String>]| Named {
        names: names.iter().map(full).collect(),
        group: Group { binary: binary.path.clone(), folder: binary.folder.clone(), names: names.to_vec() },
    };
    wanted.chunks(if binary.is_unit { GROUP } else { 1 }).map(group).collect()
}

fn built(root: &Path) -> Result<Vec<Binary>, String> {
    let mut command = workspace("test");
    in_root(command.args(["--no-run", "--message-format=json-render-diagnostics"])).stdout(Stdio::piped());
    let output = command.spawn().and_then(|child| child.wait_with_output());
    let output = output.map_err(|error| format!("cargo test --no-run: {error}"))?;
    if !output.status.success() {
        return Err(format!("cargo test --no-run ({})", output.status));
    }
    Ok(binaries(&String::from_utf8_lossy(&output.stdout), root))
}

fn listed(binary: &Binary) -> Result<Vec<Option<String>>, String> {
    let failed = |how: String| format!("{} does not list its tests: {how}", binary.label);
    let mut command = Command::new(&binary.path);
    command.args(["--list", "--format", "terse"]).current_dir(&binary.folder);
    let watched = watch(&mut command, LIST_LIMIT).map_err(|error| failed(error.to_string()))?;
    match watched.status {
        Some(status) if status.success() => Ok(names(&watched.output).into_iter().map(Some).collect()),
        Some(status) => Err(failed(format!("{status}\n{}", watched.output))),
        None => Err(failed(format!("no answer within {} s", LIST_LIMIT.as_secs()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(arguments: &[&str], is_ci: bool) -> Result<Options, String> {
        Options::parse(&arguments.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>(), is_ci)
    }

    #[test]
    fn unit_tests_share_processes_and_other_tests_do_not() {
        let options = parse(&["wanted"], false).unwrap();
        let names: Vec<_> = (0..200).map(|number| Some(format!("wanted_{number}"))).collect();
        let names = [names, vec![Some("other".to_owned())]].concat();
        let binary = |is_unit| Binary {
            label: "core parafovea_core".to_owned(),
            path: "/r/target/a".into(),
            folder: "/r/core".into(),
            has_harness: true,
            is_unit,
        };
        let counts = |is_unit| {
            let groups = groups(&binary(is_unit), names.clone(), &options);
            assert_eq!(groups[0].names[0], "core parafovea_core wanted_0");
            groups.iter().map(|named| named.names.len()).collect::<Vec<_>>()
        };
        assert_eq!(counts(true), [64, 64, 64, 8]);
        assert_eq!(counts(false), [1; 200]);
    }

    #[test]
    fn ci_and_an_option_are_strict() {
        assert!(!parse(&[], false).unwrap().is_strict);
        assert!(parse(&[], true).unwrap().is_strict);
        let options = parse(&["--strict", "pipewire"], false).unwrap();
        assert!(
            options.is_strict && options.wants("tests/sound sound pipewire::x") && !options.wants("silence")
        );
        assert!(parse(&["--srtict"], false).is_err() && parse(&["a", "b"], false).is_err());
    }
}
