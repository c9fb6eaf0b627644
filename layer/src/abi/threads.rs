//! Threads of the layer in the application's process.
//!
//! Signals to the process are the application's. The kernel gives them to any thread that does not block them, and handlers may rely on the
//! threads of the application: Wine's read data that only its own threads have, and `sigwait` needs every thread to block the signal. The
//! threads of the layer therefore block all signals except for faults, as Mesa's drivers do.

use std::io;
use std::mem::MaybeUninit;
use std::thread::{Builder, JoinHandle};

/// Signals of a thread's own faults: undefined behaviour if they are blocked (`sigprocmask(2)`).
const OF_FAULTS: [libc::c_int; 7] =
    [libc::SIGSEGV, libc::SIGBUS, libc::SIGFPE, libc::SIGILL, libc::SIGTRAP, libc::SIGSYS, libc::SIGABRT];

/// Starts a thread that blocks signals. The system shows the first 15 bytes of its name.
///
/// # Errors
/// The system has no room for a thread.
pub fn spawn<T: Send + 'static>(
    name: &str,
    work: impl FnOnce() -> T + Send + 'static,
) -> io::Result<JoinHandle<T>> {
    // A thread begins with the mask of its creator.
    let _blocked = BlockedSignals::new();
    Builder::new().name(name.to_owned()).spawn(work)
}

/// Blocks signals of the calling thread while it lives.
struct BlockedSignals {
    /// The mask of the thread before; `None` if it could not be changed.
    before: Option<libc::sigset_t>,
}

impl BlockedSignals {
    fn new() -> Self {
        let mut blocked = MaybeUninit::uninit();
        let mut before = MaybeUninit::uninit();
        // SAFETY: sigfillset initialises the set before other functions read it, and pthread_sigmask writes the mask before where it returns 0.
        let before = unsafe {
            libc::sigfillset(blocked.as_mut_ptr());
            for signal in OF_FAULTS {
                libc::sigdelset(blocked.as_mut_ptr(), signal);
            }
            let result = libc::pthread_sigmask(libc::SIG_SETMASK, blocked.as_ptr(), before.as_mut_ptr());
            (result == 0).then(|| before.assume_init())
        };
        Self { before }
    }
}

impl Drop for BlockedSignals {
    fn drop(&mut self) {
        if let Some(before) = &self.before {
            // SAFETY: the mask is a valid one, of this thread: the value does not leave the function that made it.
            unsafe { libc::pthread_sigmask(libc::SIG_SETMASK, before, std::ptr::null_mut()) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mask of blocked signals of the calling thread, a bit for each from 1 on.
    fn blocked() -> u64 {
        let status = std::fs::read_to_string("/proc/thread-self/status").unwrap();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigBlk:")).unwrap();
        u64::from_str_radix(mask.trim(), 16).unwrap()
    }

    #[test]
    fn a_thread_blocks_all_signals_but_those_of_faults_and_its_creator_none_more() {
        let before = blocked();
        let within = spawn("parafovea-test", blocked).unwrap().join().unwrap();
        assert_eq!(blocked(), before);
        let has = |signal: libc::c_int| within & (1 << (signal - 1)) != 0;
        for signal in
            [libc::SIGINT, libc::SIGTERM, libc::SIGALRM, libc::SIGPROF, libc::SIGCHLD, libc::SIGUSR1]
        {
            assert!(has(signal), "signal {signal}");
        }
        assert!(!OF_FAULTS.into_iter().any(has));
    }
}
