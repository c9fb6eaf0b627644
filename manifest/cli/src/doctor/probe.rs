//! Asking Vulkan and OpenXR, by a program that comes with this one.

use parafovea_manifest::doctor::{ANSWER_PREFIX, Probed};
use parafovea_manifest::json::{DISABLE_VARIABLE, ENABLE_VARIABLE};
use serde::de::DeserializeOwned;
use std::env;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// The program that asks.
const PROGRAM: &str = "parafovea-probe";

/// Variables that make the loaders print to standard output.
const LOADER_DEBUG: [&str; 2] = ["VK_LOADER_DEBUG", "XR_LOADER_DEBUG"];

/// A runtime that starts its service, and a driver that compiles, take seconds.
const PATIENCE: Duration = Duration::from_secs(10);

/// All answers; the questions are asked at the same time.
pub fn probe() -> Probed {
    let Some(program) = program() else {
        let missing = || {
            format!(
                "{PROGRAM} is missing beside this program and in ../lib/parafovea; install Parafovea again"
            )
        };
        return Probed {
            layers: Err(missing()),
            vulkan: Err(missing()),
            created: Err(missing()),
            created_without_layer: Err(missing()),
            openxr: Err(missing()),
        };
    };
    let (layers, vulkan, created, created_without_layer, openxr) = (
        Asked::new(&program, "layers", true),
        Asked::new(&program, "vulkan", false),
        Asked::new(&program, "devices", true),
        Asked::new(&program, "devices", false),
        Asked::new(&program, "openxr", false),
    );
    Probed {
        layers: layers.answer(),
        vulkan: vulkan.answer(),
        created: created.answer(),
        created_without_layer: created_without_layer.answer(),
        openxr: openxr.answer(),
    }
}

/// Beside this program, as a build or an archive puts it, or where a package does.
fn program() -> Option<PathBuf> {
    let own = env::current_exe().ok()?;
    let folder = own.parent()?;
    [".", "../lib/parafovea"]
        .map(|place| folder.join(place).join(PROGRAM))
        .into_iter()
        .find(|path| path.is_file())
}

/// A question that was asked.
struct Asked(Result<(Child, mpsc::Receiver<Option<String>>), String>);

impl Asked {
    /// Asks, with the layer enabled or not. It finds no place for a log, which belongs to games.
    fn new(program: &Path, question: &str, with_layer: bool) -> Self {
        let mut command = Command::new(program);
        command.arg(question).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
        for name in LOADER_DEBUG {
            command.env_remove(name);
        }
        if with_layer {
            command.env(ENABLE_VARIABLE, "1").env_remove(DISABLE_VARIABLE).env("XDG_STATE_HOME", "/dev/null");
        } else {
            command.env(DISABLE_VARIABLE, "1");
        }
        let spawned = command.spawn().map(|mut child| {
            let (sender, receiver) = mpsc::channel();
            let output = child.stdout.take();
            // Only until the answer: a process that the runtime starts may keep the other end open for as long as it runs.
            thread::spawn(move || {
                let lines =
                    output.into_iter().flat_map(|output| BufReader::new(output).split(b'\n')).flatten();
                let _ = sender.send(answer_in(lines));
            });
            (child, receiver)
        });
        Self(spawned.map_err(|error| format!("{}: {error}", program.display())))
    }

    fn answer<T: DeserializeOwned>(self) -> Result<T, String> {
        let (mut child, receiver) = self.0?;
        let Ok(answer) = receiver.recv_timeout(PATIENCE) else {
            let _ = child.kill();
            let _ = child.wait();
            return Err(format!("{PROGRAM} gave no answer within {} seconds", PATIENCE.as_secs()));
        };
        if let Some(answer) = answer {
            // It has said all, and ends: nothing that it left behind in the runtime is waited for.
            thread::spawn(move || child.wait());
            return serde_json::from_str(&answer).map_err(|error| error.to_string())?;
        }
        Err(child.wait().map_err(|error| error.to_string())?.to_string())
    }
}

/// The answer among lines of loaders, layers and drivers.
fn answer_in(mut lines: impl Iterator<Item = Vec<u8>>) -> Option<String> {
    lines.find_map(|line| Some(String::from_utf8_lossy(&line).strip_prefix(ANSWER_PREFIX)?.to_owned()))
}
