//! Frames in turn with other applications' frames, so that a disturbance of the machine affects all alike.

use crate::clock::process_cpu_ns;
use std::io::{Error, Read, Result};
use std::os::fd::AsRawFd;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Mutex, PoisonError};

/// The socket that `clock.turns` names.
#[derive(Debug)]
pub(crate) struct Turns {
    /// None once the other end is gone: then no frame waits any more.
    stream: Mutex<Option<UnixStream>>,
    held_cpu_ns: AtomicI64,
}

impl Turns {
    /// Connects to the socket at `path`, which gives the turns.
    pub fn connect(path: &Path) -> Result<Self> {
        let stream = Mutex::new(Some(UnixStream::connect(path)?));
        Ok(Self { stream, held_cpu_ns: AtomicI64::new(0) })
    }

    /// CPU time that the process has spent while it waited, nanoseconds: work of its own threads, such as sound capture, which is not a part
    /// of a frame that waits for all the others.
    pub fn held_cpu_ns(&self) -> i64 {
        self.held_cpu_ns.load(Ordering::Relaxed)
    }

    /// Asks for a frame, which marks the one before as done, and waits for it.
    pub fn next(&self) {
        let mut stream = self.stream.lock().unwrap_or_else(PoisonError::into_inner);
        // Not `write`, which would kill an application that does not ignore SIGPIPE.
        let asked = |stream: &mut UnixStream| {
            // SAFETY: the socket is open, and the byte is there for the time of the call.
            let sent =
                unsafe { libc::send(stream.as_raw_fd(), [0u8].as_ptr().cast(), 1, libc::MSG_NOSIGNAL) };
            if sent == 1 { stream.read_exact(&mut [0]) } else { Err(Error::last_os_error()) }
        };
        let before_ns = process_cpu_ns();
        if stream.as_mut().is_some_and(|stream| asked(stream).is_err()) {
            *stream = None;
        }
        self.held_cpu_ns.fetch_add(process_cpu_ns() - before_ns, Ordering::Relaxed);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failed step is a failed test")]
mod tests {
    use super::*;
    use std::io::Write;
    use std::os::unix::net::UnixListener;

    /// Work of another thread counts meanwhile, and work of this one after its turn has come does not.
    #[test]
    fn cpu_time_of_a_waiting_frame_is_separate() {
        const BUSY_NS: i64 = 50_000_000;
        let busy = || {
            let start_ns = process_cpu_ns();
            while process_cpu_ns() - start_ns < BUSY_NS {}
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("turns");
        let listener = UnixListener::bind(&path).unwrap();
        let turns = Turns::connect(&path).unwrap();
        let (mut asks, _) = listener.accept().unwrap();
        std::thread::scope(|scope| {
            scope.spawn(move || {
                asks.read_exact(&mut [0]).unwrap();
                busy();
                asks.write_all(&[0]).unwrap();
            });
            turns.next();
        });
        let held_ns = turns.held_cpu_ns();
        assert!(held_ns >= BUSY_NS, "{held_ns}");
        busy();
        assert_eq!(turns.held_cpu_ns(), held_ns);
    }
}
