//! PipeWire with pipewire-pulse in place of PulseAudio: its own folder, its own socket, the output that it has where there is
//! no sound card.

use anyhow::{Context, Result, bail, ensure};
use parafovea_trial::watch;
use std::fs::File;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The longest that each program may take to be ready.
const PATIENCE: Duration = Duration::from_secs(60);

/// Interval between checks for that.
const POLL: Duration = Duration::from_millis(20);

/// The longest that a question to PipeWire may take; it is asked again.
const ANSWER_LIMIT: Duration = Duration::from_secs(10);

/// The key under which WirePlumber names the default output.
const OUTPUT_KEY: &str = "default.audio.sink";

/// The server, the manager of its sessions, and the server for PulseAudio's protocol. They end when it is dropped.
pub struct PipeWire {
    /// Ended in this order.
    processes: Vec<(&'static str, Child)>,
    folder: tempfile::TempDir,
}

impl PipeWire {
    /// Starts the programs, each once the one before it is ready.
    ///
    /// # Errors
    /// One of them is not installed, or is not ready in time.
    pub fn start() -> Result<Self> {
        let folder = tempfile::Builder::new().prefix("parafovea-sound-").tempdir()?;
        let mut server = Self { processes: Vec::new(), folder };
        let address = format!("--address={}", server.bus_address());
        server.launch("dbus-daemon", &["--session", "--nofork", &address])?;
        server.wait("a message bus", |server| UnixStream::connect(server.path("bus")).is_ok())?;
        server.launch("pipewire", &[])?;
        server.wait("PipeWire's socket", |server| UnixStream::connect(server.path("pipewire-0")).is_ok())?;
        server.launch("wireplumber", &[])?;
        server.launch("pipewire-pulse", &[])?;
        server.wait("the socket for PulseAudio", |server| UnixStream::connect(server.socket()).is_ok())?;
        // Until WirePlumber has chosen it, a client that wants to play waits.
        server.wait("a default output", PipeWire::has_output)?;
        Ok(server)
    }

    /// Value of `XDG_RUNTIME_DIR` with which clients find it.
    pub fn runtime_folder(&self) -> &Path {
        self.folder.path()
    }

    /// Socket for clients.
    pub fn socket(&self) -> PathBuf {
        self.path("pulse/native")
    }

    /// Plugs an output in that leads nowhere, whose monitor does not contain its volume, and makes it the default.
    ///
    /// # Errors
    /// PipeWire refuses, or a program is not installed.
    pub fn plug(&mut self, name: &str) -> Result<()> {
        let properties = format!(
            "{{ factory.name=support.null-audio-sink node.name={name} media.class=Audio/Sink object.linger=true \
             audio.position=[FL FR] monitor.channel-volumes=false }}"
        );
        self.ask("pw-cli", &["create-node", "adapter", &properties])?;
        self.wait("the output", |server| server.ask("pactl", &["set-default-sink", name]).is_ok())?;
        let is_default = |server: &Self| {
            server.ask("pactl", &["get-default-sink"]).is_ok_and(|answer| answer.trim() == name)
        };
        self.wait("that output as the default", is_default)
    }

    /// Sets the volume of an output, percent.
    ///
    /// # Errors
    /// There is no such output.
    pub fn set_volume(&self, name: &str, percent: u32) -> Result<()> {
        self.ask("pactl", &["set-sink-volume", name, &format!("{percent}%")]).map(drop)
    }

    /// Kills one of the programs; none that does not run.
    pub fn kill(&mut self, program: &str) {
        for (_, process) in self.processes.iter_mut().filter(|(name, _)| *name == program) {
            kill(process);
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn bus_address(&self) -> String {
        format!("unix:path={}", self.path("bus").display())
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env_clear().env("PATH", std::env::var_os("PATH").unwrap_or_default());
        command.env("HOME", self.folder.path()).env("XDG_RUNTIME_DIR", self.folder.path());
        command.env("DBUS_SESSION_BUS_ADDRESS", self.bus_address());
        command
    }

    fn launch(&mut self, program: &'static str, arguments: &[&str]) -> Result<()> {
        let log = File::options().create(true).append(true).open(self.path("log.txt"))?;
        let mut command = self.command(program);
        command.args(arguments).stdin(Stdio::null()).stdout(log.try_clone()?).stderr(log).process_group(0);
        let process = command.spawn().with_context(|| format!("{program} (cargo dev setup installs it)"))?;
        self.processes.insert(0, (program, process));
        Ok(())
    }

    /// Waits until it `is_ready`.
    fn wait(&mut self, what: &str, is_ready: impl Fn(&Self) -> bool) -> Result<()> {
        let start = Instant::now();
        while !is_ready(self) {
            let ended = self.processes.iter_mut().find_map(|(name, process)| {
                (!matches!(process.try_wait(), Ok(None))).then(|| format!("; {name} has ended"))
            });
            let ended = ended.unwrap_or_default();
            if start.elapsed() > PATIENCE || !ended.is_empty() {
                let log = std::fs::read_to_string(self.path("log.txt")).unwrap_or_default();
                bail!(
                    "PipeWire does not have {what} after {:.0} s{ended}:\n{log}",
                    start.elapsed().as_secs_f64()
                );
            }
            std::thread::sleep(POLL);
        }
        Ok(())
    }

    /// Whether WirePlumber has chosen the default output.
    fn has_output(&self) -> bool {
        let answer = self.ask("pw-metadata", &["-n", "default", "0", OUTPUT_KEY]);
        answer.is_ok_and(|answer| answer.contains(OUTPUT_KEY))
    }

    /// The answer of a program that asks the server.
    ///
    /// # Errors
    /// The program is not installed, or fails.
    fn ask(&self, program: &str, arguments: &[&str]) -> Result<String> {
        let mut command = self.command(program);
        let answer = watch(command.args(arguments), ANSWER_LIMIT).with_context(|| program.to_owned())?;
        ensure!(answer.status.is_some_and(|status| status.success()), "{program}: {}", answer.output);
        Ok(answer.output)
    }
}

/// Kills a process and all that it started.
fn kill(process: &mut Child) {
    if !matches!(process.try_wait(), Ok(None)) {
        return;
    }
    // SAFETY: sends a signal to the group of processes that this child leads, which was not waited for yet.
    unsafe { libc::kill(-(process.id() as libc::pid_t), libc::SIGKILL) };
    // Fails only for a process that was waited for before.
    drop(process.wait());
}

impl Drop for PipeWire {
    fn drop(&mut self) {
        self.processes.iter_mut().for_each(|(_, process)| kill(process));
    }
}
