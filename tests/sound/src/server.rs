//! A PulseAudio server of one's own, without a sound card: its own folder, its own socket, outputs that lead nowhere.

use anyhow::{Context, Result, bail};
use std::io::{Read, Write};
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for a start or an answer.
const PATIENCE: Duration = Duration::from_secs(60);

/// A server, and the folder that only it knows. Ends when it is dropped.
pub struct Server {
    folder: tempfile::TempDir,
    arguments: Vec<String>,
    process: Option<Child>,
}

/// The options of an output.
#[derive(Clone, Copy, Debug)]
pub struct Sink<'a> {
    /// Its name.
    pub name: &'a str,
    /// Frames a second.
    pub sample_rate_hz: u32,
}

impl Sink<'_> {
    fn module(&self) -> String {
        let Self { name, sample_rate_hz } = self;
        // Floats, so that nothing is limited or rounded on the way; and without rewinds, or it works two seconds ahead while
        // nothing is played, which no sound card does.
        format!(
            "module-null-sink sink_name={name} format=float32le rate={sample_rate_hz} channels=2 norewinds=1"
        )
    }
}

impl Server {
    /// Starts a server with these outputs, of which the first is the default.
    ///
    /// # Errors
    /// There is no `pulseaudio`, or it does not start.
    pub fn start(sinks: &[Sink<'_>]) -> Result<Self> {
        let folder = tempfile::Builder::new().prefix("parafovea-sound-").tempdir()?;
        std::fs::create_dir(folder.path().join("pulse"))?;
        let socket = folder.path().join("pulse/native");
        let mut arguments: Vec<String> =
            ["-n", "--daemonize=no", "--use-pid-file=no", "--exit-idle-time=-1", "--disable-shm=yes"]
                .map(str::to_owned)
                .into();
        arguments.extend(["--realtime=no", "--high-priority=no"].map(str::to_owned));
        arguments
            .push(format!("--load=module-native-protocol-unix auth-anonymous=1 socket={}", socket.display()));
        let cli = folder.path().join("cli");
        arguments.push(format!("--load=module-cli-protocol-unix socket={}", cli.display()));
        arguments.extend(sinks.iter().map(|sink| format!("--load={}", sink.module())));
        let mut server = Self { folder, arguments, process: None };
        server.restart()?;
        Ok(server)
    }

    /// Value of `XDG_RUNTIME_DIR` with which clients find it.
    pub fn runtime_folder(&self) -> &Path {
        self.folder.path()
    }

    /// Socket for clients.
    pub fn socket(&self) -> PathBuf {
        self.folder.path().join("pulse/native")
    }

    /// Restarts it with the same arguments.
    ///
    /// # Errors
    /// It does not start.
    pub fn restart(&mut self) -> Result<()> {
        self.kill();
        let folder = self.folder.path();
        let log = std::fs::File::create(folder.join("log.txt"))?;
        let mut command = Command::new("pulseaudio");
        command.args(&self.arguments).env_clear().env("PATH", std::env::var_os("PATH").unwrap_or_default());
        command
            .env("HOME", folder)
            .env("XDG_RUNTIME_DIR", folder)
            .env("PULSE_RUNTIME_PATH", folder.join("pulse"));
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(log);
        self.process = Some(command.spawn().context("pulseaudio (cargo dev setup installs it)")?);
        let start = Instant::now();
        // The server answers when all is loaded.
        while self.command("stat").is_err() {
            if start.elapsed() > PATIENCE {
                let log = std::fs::read_to_string(folder.join("log.txt")).unwrap_or_default();
                bail!("pulseaudio does not start: {log}");
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        Ok(())
    }

    /// Ends it without a word to anybody.
    pub fn kill(&mut self) {
        if let Some(mut process) = self.process.take() {
            // Both fail only for a process that has ended already.
            drop(process.kill());
            drop(process.wait());
            for socket in ["cli", "pulse/native"] {
                drop(std::fs::remove_file(self.folder.path().join(socket)));
            }
        }
    }

    /// Makes it stand still, or go on.
    ///
    /// # Errors
    /// It is not there.
    pub fn set_stalled(&self, is_stalled: bool) -> Result<()> {
        let process = self.process.as_ref().context("no server")?;
        let signal = if is_stalled { libc::SIGSTOP } else { libc::SIGCONT };
        // SAFETY: sends a signal to a child of ours that was not waited for yet.
        let result = unsafe { libc::kill(process.id() as libc::pid_t, signal) };
        if result == 0 { Ok(()) } else { Err(std::io::Error::last_os_error().into()) }
    }

    /// Sends it a command (`pulse-cli-syntax(5)`), and returns its answer.
    ///
    /// # Errors
    /// It is not there, or does not answer.
    pub fn command(&self, command: &str) -> Result<String> {
        let mut socket = UnixStream::connect(self.folder.path().join("cli"))?;
        socket.set_read_timeout(Some(PATIENCE))?;
        writeln!(socket, "{command}")?;
        // After the end of the input, the server closes the connection once the command is done.
        socket.shutdown(Shutdown::Write)?;
        let mut answer = String::new();
        socket.read_to_string(&mut answer)?;
        Ok(answer)
    }

    /// Plugs an output in.
    ///
    /// # Errors
    /// As for [`Self::command`].
    pub fn plug(&self, sink: Sink<'_>) -> Result<()> {
        self.command(&format!("load-module {}", sink.module())).map(drop)
    }

    /// Unplugs the output of that name.
    ///
    /// # Errors
    /// There is none of that name.
    pub fn unplug(&self, name: &str) -> Result<()> {
        let modules = self.command("list-modules")?;
        let argument = format!("sink_name={name} ");
        let before = modules.split(&argument).next().filter(|before| before.len() < modules.len());
        let index =
            before.and_then(|before| before.rsplit("index: ").next()).and_then(|rest| rest.lines().next());
        let index = index.with_context(|| format!("no output {name}"))?.trim();
        self.command(&format!("unload-module {index}")).map(drop)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.kill();
    }
}
