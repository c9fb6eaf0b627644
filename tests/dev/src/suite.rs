//! All tests of the workspace, each as a process of its own with a time limit.

mod binaries;
mod summary;

use crate::tasks::{in_root, workspace};
use binaries::{Binary, binaries, names};
use parafovea_trial::{Ending, Trial, watch};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};
use summary::Done;
pub use summary::Summary;

/// The longest that a test may take: far above the slowest, since machines are shared.
const LIMIT: Duration = Duration::from_secs(600);

/// The longest that a test binary may take to list its tests.
const LIST_LIMIT: Duration = Duration::from_secs(120);

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

/// A test, and the name under which it is reported.
struct Named {
    name: String,
    trial: Trial,
}

/// Runs the tests, as many at once as there are processors, and prints each.
///
/// # Errors
/// There is no test, or cargo cannot build them.
pub fn run(options: &Options) -> Result<Summary, String> {
    let named = all(options)?;
    if named.is_empty() {
        return Err("no test has this in its name".to_owned());
    }
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    eprintln!("cargo dev: {} tests, {workers} at a time", named.len());
    let (queue, done) = (Mutex::new(named.into_iter()), Mutex::new(Vec::new()));
    let start = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some(test) = lock(&queue).next() {
                    let test = run_one(test, options.is_strict);
                    lock(&done).push(test);
                }
            });
        }
    });
    let tests = std::mem::take(&mut *lock(&done));
    Ok(Summary { tests, time: start.elapsed(), is_strict: options.is_strict })
}

/// A worker that panics ends the scope with a panic: its locks are of no interest any more.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

fn run_one(test: Named, is_strict: bool) -> Done {
    let Named { name, trial } = test;
    let (ending, time, output) = match trial.run(LIMIT) {
        Ok((ending, watched)) => (ending, watched.time, watched.output),
        Err(error) => (Ending::Failed(format!("cannot be started: {error}")), Duration::ZERO, String::new()),
    };
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

/// All tests that are wanted. Binaries are built, and say what they have.
fn all(options: &Options) -> Result<Vec<Named>, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().map_err(|error| format!("{}: {error}", root.display()))?;
    let mut tests = Vec::new();
    for binary in built(&root)? {
        let names = if binary.has_harness { listed(&binary)? } else { vec![None] };
        let named = names.into_iter().map(|name| {
            let label = &binary.label;
            let full = name.as_ref().map_or_else(|| label.clone(), |name| format!("{label} {name}"));
            let (path, folder) = (binary.path.clone(), Some(binary.folder.clone()));
            Named { name: full, trial: Trial { binary: path, name, even_ignored: false, folder } }
        });
        tests.extend(named.filter(|test| options.wants(&test.name)));
    }
    Ok(tests)
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
    fn ci_and_an_option_are_strict() {
        assert!(!parse(&[], false).unwrap().is_strict);
        assert!(parse(&[], true).unwrap().is_strict);
        let options = parse(&["--strict", "pipewire"], false).unwrap();
        assert!(
            options.is_strict && options.wants("tests/ears ears pipewire::x") && !options.wants("silence")
        );
        assert!(parse(&["--srtict"], false).is_err() && parse(&["a", "b"], false).is_err());
    }
}
