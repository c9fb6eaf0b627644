//! PipeWire with pipewire-pulse in place of PulseAudio: its own folder, its own socket, the output that it has where there is
//! no sound card.

use anyhow::{Context, Result, bail};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// How long it may take to start.
const PATIENCE: Duration = Duration::from_secs(20);

/// The server, the manager of its sessions, and what speaks PulseAudio's protocol for it.
const PROGRAMS: &str = "pipewire & sleep 0.5; wireplumber & sleep 0.5; exec pipewire-pulse";

/// All of its processes. They end when it is dropped.
pub struct PipeWire {
    folder: tempfile::TempDir,
    processes: Child,
}

impl PipeWire {
    /// Starts it.
    ///
    /// # Errors
    /// It is not installed, or does not start.
    pub fn start() -> Result<Self> {
        let folder = tempfile::Builder::new().prefix("parafovea-ears-").tempdir()?;
        let log = std::fs::File::create(folder.path().join("log.txt"))?;
        let mut command = Command::new("dbus-run-session");
        command.args(["--", "sh", "-c", PROGRAMS]).env_clear();
        command.env("PATH", std::env::var_os("PATH").unwrap_or_default());
        command.env("HOME", folder.path()).env("XDG_RUNTIME_DIR", folder.path());
        command.stdin(Stdio::null()).stdout(log.try_clone()?).stderr(log).process_group(0);
        let processes = command.spawn().context("dbus-run-session (cargo dev setup brings it)")?;
        let server = Self { folder, processes };
        let start = Instant::now();
        while UnixStream::connect(server.socket()).is_err() {
            if start.elapsed() > PATIENCE {
                let log = std::fs::read_to_string(server.folder.path().join("log.txt")).unwrap_or_default();
                bail!("PipeWire does not start: {log}");
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        Ok(server)
    }

    /// What `XDG_RUNTIME_DIR` has to be for clients to find it.
    pub fn runtime_folder(&self) -> &Path {
        self.folder.path()
    }

    /// Where clients connect to.
    pub fn socket(&self) -> PathBuf {
        self.folder.path().join("pulse/native")
    }
}

impl Drop for PipeWire {
    fn drop(&mut self) {
        // SAFETY: sends a signal to the group of processes that ours leads, which was not waited for yet.
        unsafe { libc::kill(-(self.processes.id() as libc::pid_t), libc::SIGKILL) };
        drop(self.processes.wait());
    }
}
