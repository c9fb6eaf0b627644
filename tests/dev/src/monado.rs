//! A second opinion on the mock runtime: applications on Monado, with a simulated headset and nothing to show pictures on, in a Debian trixie
//! of their own, with newer loaders, drivers and validation than the tests have elsewhere. Takes root's rights.

use crate::archive::archive;
use crate::setup::{Voice, setup};
use crate::steps::{Steps, cargo, profile_folder};
use crate::tasks;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const PACKAGES: [&str; 7] = [
    "libopenxr-loader1",
    "libopenxr-utils",
    "libopenxr1-monado",
    "libvulkan1",
    "mesa-vulkan-drivers",
    "monado-service",
    "vulkan-validationlayers",
];

/// Files to copy there, to `/opt/parafovea`.
const PROGRAMS: [&str; 5] =
    ["libparafovea.so", "parafovea", "parafovea-probe", "parafovea-scene", "parafovea-zoo"];

/// Everything on.
const CONFIG: &str = "[gaze]\nsource = \"centre\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n\
    [reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n";

/// Starts Monado, runs a program that ends by itself or with its input, and ends Monado: their output goes to files in `/tmp`.
const RUN: &str = r#"
export HOME=/root XDG_RUNTIME_DIR=/run/monado XRT_COMPOSITOR_NULL=1
export XR_RUNTIME_JSON=/usr/share/openxr/1/openxr_monado.json
export VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation VK_KHRONOS_VALIDATION_VALIDATE_SYNC=true
rm -rf /run/monado "$HOME/.local/state/parafovea"
mkdir -m 700 /run/monado
mkfifo /run/monado/input
exec 7<> /run/monado/input
monado-service < /run/monado/input > /tmp/monado.log 2>&1 &
service=$!
for turn in $(seq 150); do test -S /run/monado/monado_comp_ipc && break; sleep 0.1; done
# hello_xr ends at a line of input, also where it has failed: three seconds after its session shows (PLAYED: in tenths of a second), however
# long that takes.
rm -f /run/monado/ended /tmp/output.log
until_ended() { for turn in $(seq "$1"); do test -e /run/monado/ended && break; grep -qs "$2" /tmp/output.log && break; sleep 0.1; done; }
(until_ended 600 'STATE_FOCUSED\|failure \['; until_ended "${PLAYED:-30}" "no such line"; echo) |
    { timeout 120 stdbuf -oL "$@" > /tmp/output.log 2>&1; code=$?; touch /run/monado/ended; exit $code; }
code=$?
kill $service
wait $service
exit $code
"#;

/// Runs a program there, from outside of it: the folder, the program, its arguments.
const ENTER: &str = r#"
root=$1 program=$2
shift 2
cp "$program" "$root/opt/parafovea/test"
mount --bind /proc "$root/proc"
mount --bind /dev "$root/dev"
exec chroot "$root" /opt/parafovea/test "$@"
"#;

/// Runs the tests of the passes on the GPU there, then hello_xr with OSC packets, then hello_xr, our scene and the zoo, off and on; or only the
/// applications with the argument in their names. `gaze`: hello_xr with OSC packets alone.
pub fn monado(arguments: &[String]) -> Result<(), String> {
    let wanted = match arguments {
        [] => "",
        [wanted] if !wanted.starts_with('-') => wanted,
        _ => return Err("usage: cargo dev monado [PART]".to_owned()),
    };
    setup(Voice::Implied)?;
    let mut steps = Steps::default();
    tasks::build(&mut steps)?;
    let Some(root) = prepared(&mut steps)? else { return Ok(()) };
    if wanted.is_empty() {
        passes(&mut steps, &root)?;
    }
    if ["", "gaze"].contains(&wanted) {
        let followed = steps.run("gaze", Command::new(profile_folder()?.join("parafovea-monado")).arg(&root));
        // The other applications have the configuration of this task.
        write_config(&root)?;
        followed?;
    }
    if wanted == "gaze" {
        steps.summary();
        return Ok(());
    }
    let cases: Vec<Vec<String>> =
        cases()?.into_iter().filter(|case| case.join(" ").contains(wanted)).collect();
    if cases.is_empty() {
        return Err(format!("no application has {wanted:?} in its name or arguments"));
    }
    let mut wrong = 0;
    for case in &cases {
        match compare(&root, case) {
            Ok(()) => println!("{}: same behaviour", case.join(" ")),
            Err(reason) => {
                wrong += 1;
                println!("{}: {reason}", case.join(" "));
            }
        }
    }
    println!("{} applications, {wrong} with different behaviour", cases.len());
    steps.summary();
    if wrong == 0 {
        Ok(())
    } else {
        Err(format!("different behaviour in {wrong} of {} applications", cases.len()))
    }
}

/// The tests of the passes on the GPU, with that system's driver and validation.
fn passes(steps: &mut Steps, root: &Path) -> Result<(), String> {
    let rustc =
        Command::new("rustc").arg("-vV").output().map_err(|error| format!("cannot start rustc: {error}"))?;
    let rustc = String::from_utf8_lossy(&rustc.stdout).into_owned();
    let host =
        rustc.lines().find_map(|line| line.strip_prefix("host: ")).ok_or("rustc does not name its host")?;
    let runner = format!("CARGO_TARGET_{}_RUNNER", host.to_uppercase().replace(['-', '.'], "_"));
    let enter = root.join("opt/parafovea/enter.sh");
    let mut command = cargo();
    command.args(["test", "--locked", "--package", "parafovea-layer"]);
    let tests = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../layer/tests"))
        .map_err(|error| format!("layer/tests: {error}"))?;
    for test in tests {
        let name = test.map_err(|error| format!("layer/tests: {error}"))?.file_name();
        // The test of import cycles reads the sources, which that system does not have.
        if name != "module_cycles" {
            command.arg("--test").arg(name);
        }
    }
    command.env(runner, format!("unshare --mount sh -e {} {}", enter.display(), root.display()));
    steps.run("passes", tasks::in_root(&mut command))
}

/// Programs and their arguments.
fn cases() -> Result<Vec<Vec<String>>, String> {
    let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
    let list = Command::new(profile_folder()?.join("parafovea-zoo"))
        .arg("--list")
        .output()
        .map_err(|error| format!("the list of styles: {error}"))?;
    let list = String::from_utf8_lossy(&list.stdout).into_owned();
    let styles = list.lines().filter_map(|line| line.split_whitespace().next());
    let zoo = styles
        .map(|style| words(&format!("/opt/parafovea/parafovea-zoo --size 64 --frames 20 --style {style}")));
    let fixed = ["hello_xr -g Vulkan", "hello_xr -g Vulkan2", "/opt/parafovea/parafovea-scene --frames 20"]
        .map(words);
    Ok(fixed.into_iter().chain(zoo).collect())
}

/// The folder of the system, made and filled; none where that cannot be.
fn prepared(steps: &mut Steps) -> Result<Option<PathBuf>, String> {
    let is_root = Command::new("id").arg("-u").output().is_ok_and(|id| id.stdout.trim_ascii() == b"0");
    let is_installed = |program: &str| Command::new(program).arg("--version").output().is_ok();
    if is_root && !is_installed("debootstrap") && is_installed("apt-get") {
        for arguments in [&["update"][..], &["install", "--yes", "debootstrap"]] {
            let mut command = Command::new("apt-get");
            command.env("DEBIAN_FRONTEND", "noninteractive").arg("--quiet").args(arguments);
            steps.run(&format!("apt-get {}", arguments.join(" ")), &mut command)?;
        }
    }
    if !is_root || !is_installed("debootstrap") {
        println!("skipped: needs root and debootstrap");
        return Ok(None);
    }
    let folder = profile_folder()?;
    let root = folder.parent().ok_or("the target folder is not known")?.join("monado/trixie");
    let is_there = root.join("usr/bin/monado-service").exists();
    if !is_there {
        let failed = |error| format!("{}: {error}", root.display());
        fs::create_dir_all(&root).map_err(failed)?;
        let mut command = Command::new("debootstrap");
        command.args(["--variant=minbase", "trixie"]).arg(&root).arg(archive()?);
        steps.run("debootstrap", &mut command)?;
        let mut install = inside(&root);
        install.args(["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "--quiet", "install", "--yes"]);
        steps.run("apt-get install", install.arg("--no-install-recommends").args(PACKAGES))?;
    }
    let own = root.join("opt/parafovea");
    let config = root.join("root/.config/parafovea");
    let failed = |path: &Path| {
        let path = path.display().to_string();
        move |error| format!("{path}: {error}")
    };
    for path in [&own, &config] {
        fs::create_dir_all(path).map_err(failed(path))?;
    }
    for program in PROGRAMS {
        let to = own.join(program);
        fs::copy(folder.join(program), &to).map_err(failed(&to))?;
    }
    for (path, text) in [(own.join("run.sh"), RUN), (own.join("enter.sh"), ENTER)] {
        fs::write(&path, text).map_err(failed(&path))?;
    }
    write_config(&root)?;
    let mut install = inside(&root);
    steps.run(
        "parafovea install",
        install.args(["env", "HOME=/root", "/opt/parafovea/parafovea", "install"]),
    )?;
    Ok(Some(root))
}

fn write_config(root: &Path) -> Result<(), String> {
    let path = root.join("root/.config/parafovea/config.toml");
    fs::write(&path, CONFIG).map_err(|error| format!("{}: {error}", path.display()))
}

/// A command in that system, with the kernel's folders for as long as it runs.
fn inside(root: &Path) -> Command {
    let mut command = Command::new("unshare");
    let script = r#"mount --bind /proc "$0/proc" && mount --bind /dev "$0/dev" && exec chroot "$0" "$@""#;
    command.args(["--mount", "sh", "-c", script]).arg(root);
    command
}

/// Output of an application and Monado.
struct Seen {
    code: Option<i32>,
    /// Complaints, without their numbers, with the count of each.
    complaints: BTreeMap<String, usize>,
    log: String,
}

fn run(root: &Path, words: &[String]) -> Result<Seen, String> {
    let mut command = inside(root);
    let status = command.args(["bash", "/opt/parafovea/run.sh"]).args(words).status();
    let status = status.map_err(|error| format!("cannot start: {error}"))?;
    let read = |path: PathBuf| String::from_utf8_lossy(&fs::read(path).unwrap_or_default()).into_owned();
    let mut complaints = BTreeMap::new();
    for line in read(root.join("tmp/output.log")).lines().filter(|line| is_complaint(line)) {
        *complaints.entry(without_numbers(line)).or_default() += 1;
    }
    // Its warnings are about late frames only, and are left out.
    for line in read(root.join("tmp/monado.log")).lines().filter(|line| line.contains("ERROR")) {
        *complaints.entry(format!("Monado: {}", without_numbers(line))).or_default() += 1;
    }
    let logs = fs::read_dir(root.join("root/.local/state/parafovea")).into_iter().flatten().flatten();
    Ok(Seen { code: status.code(), complaints, log: logs.map(|file| read(file.path())).collect() })
}

/// Of validation, loaders, hello_xr and Monado's part in the application.
fn is_complaint(line: &str) -> bool {
    [
        "Validation Error",
        "Validation Warning",
        "Validation Performance",
        "[Error",
        "[Warning",
        "ERROR",
        " WARN ",
    ]
    .iter()
    .any(|sign| line.contains(sign))
}

/// Times and handles differ in every run.
fn without_numbers(text: &str) -> String {
    let words = text.split(|character: char| !character.is_ascii_alphanumeric());
    let words: Vec<&str> = words
        .filter(|word| !word.is_empty() && !word.starts_with(|first: char| first.is_ascii_digit()))
        .collect();
    words.join(" ")
}

/// With the layer it ends as without, with no complaint more, and the layer is at work.
fn compare(root: &Path, words: &[String]) -> Result<(), String> {
    let off = run(root, words)?;
    let launcher = ["/opt/parafovea/parafovea", "run", "--"].map(str::to_owned);
    let on = run(root, &[&launcher, words].concat())?;
    if off.code != on.code {
        return Err(format!("exit code {:?} instead of {:?}\n{}", on.code, off.code, on.log));
    }
    let is_more =
        |(text, count): &(&String, &usize)| off.complaints.get(*text).is_none_or(|before| before < count);
    let more: Vec<_> = on.complaints.iter().filter(is_more).collect();
    if !more.is_empty() {
        return Err(format!("new messages: {more:#?}"));
    }
    // Without a session there is no work for the layer: lavapipe does not meet Monado's needs for devices of XR_KHR_vulkan_enable.
    let has_session = off.code == Some(0);
    if has_session && !on.log.contains("session active")
        || on.log.contains(" WARN ")
        || on.log.contains(" ERROR ")
    {
        // A test that no device here supports ends before its session.
        let is_skipped =
            fs::read_to_string(root.join("tmp/output.log")).is_ok_and(|text| text.contains("skipped: "));
        return if is_skipped { Ok(()) } else { Err(format!("the layer's log\n{}", on.log)) };
    }
    Ok(())
}
