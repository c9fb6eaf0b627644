//! Frames in turn with those of other applications, so that what disturbs the machine for a while disturbs all alike.

use std::io::{Error, Read, Result};
use std::os::fd::AsRawFd;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// The socket that `clock.turns` names.
#[derive(Debug)]
pub(crate) struct Turns {
    /// None once the other end is gone: then no frame waits any more.
    stream: Mutex<Option<UnixStream>>,
}

impl Turns {
    /// Whoever gives turns listens there.
    pub fn connect(path: &Path) -> Result<Self> {
        UnixStream::connect(path).map(|stream| Self { stream: Mutex::new(Some(stream)) })
    }

    /// Asks for a frame, which says that the one before is done, and waits for it.
    pub fn next(&self) {
        let mut stream = self.stream.lock().unwrap_or_else(PoisonError::into_inner);
        // Not `write`, which would kill an application that does not ignore SIGPIPE.
        let asked = |stream: &mut UnixStream| {
            // SAFETY: the socket is open, and the byte is there for the time of the call.
            let sent =
                unsafe { libc::send(stream.as_raw_fd(), [0u8].as_ptr().cast(), 1, libc::MSG_NOSIGNAL) };
            if sent == 1 { stream.read_exact(&mut [0]) } else { Err(Error::last_os_error()) }
        };
        if stream.as_mut().is_some_and(|stream| asked(stream).is_err()) {
            *stream = None;
        }
    }
}
