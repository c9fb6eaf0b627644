//! The time slice of a thread.
//!
//! A thread that wakes up on a busy core waits until the running thread has used its slice, up to 3 ms. From Linux 6.12 on, a thread of the normal
//! policy may ask for a shorter slice, and with it for an earlier turn; its share of the core remains the same, and no right is needed. Earlier
//! systems ignore the value. <https://docs.kernel.org/scheduler/sched-eevdf.html>

use std::io;

/// The shortest slice of Linux, nanoseconds: `sched_attr::sched_runtime` of `sched_setattr(2)`, which is clamped to 0.1..100 ms.
const SHORTEST_NS: u64 = 100_000;

/// Asks for the shortest slice of the calling thread. Policy and niceness remain.
///
/// # Errors
/// Errors of `sched_getattr(2)` and `sched_setattr(2)`, for instance in a sandbox without these calls. The slice then stays as usual.
pub fn shorten() -> io::Result<()> {
    let mut attributes = of_this_thread()?;
    attributes.sched_runtime = SHORTEST_NS;
    // SAFETY: the structure is valid and has its size; 0 is the calling thread; there are no flags.
    let result = unsafe { libc::syscall(libc::SYS_sched_setattr, 0, &attributes, 0) };
    if result == 0 { Ok(()) } else { Err(io::Error::last_os_error()) }
}

/// The scheduling attributes of the calling thread.
fn of_this_thread() -> io::Result<libc::sched_attr> {
    // SAFETY: all fields are numbers, and may be zero.
    let mut attributes: libc::sched_attr = unsafe { std::mem::zeroed() };
    let size = size_of_val(&attributes);
    // SAFETY: the structure is valid to write to, for its size; 0 is the calling thread; there are no flags.
    let result = unsafe { libc::syscall(libc::SYS_sched_getattr, 0, &mut attributes, size, 0) };
    if result == 0 { Ok(attributes) } else { Err(io::Error::last_os_error()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Major and minor version of the running Linux.
    fn linux() -> (u32, u32) {
        let release = std::fs::read_to_string("/proc/sys/kernel/osrelease").unwrap();
        let mut numbers = release.split(['.', '-']).map(|part| part.parse().unwrap());
        (numbers.next().unwrap(), numbers.next().unwrap())
    }

    #[test]
    fn a_thread_has_a_shorter_slice_and_all_else_as_before() {
        let attributes = std::thread::spawn(|| {
            let before = of_this_thread().unwrap();
            shorten().unwrap();
            [before, of_this_thread().unwrap()]
        });
        let [before, after] = attributes.join().unwrap();
        if linux() >= (6, 12) {
            assert_eq!(after.sched_runtime, SHORTEST_NS);
            assert!(before.sched_runtime > SHORTEST_NS, "{}", before.sched_runtime);
        }
        let rest = |of: libc::sched_attr| (of.sched_policy, of.sched_flags, of.sched_nice, of.sched_priority);
        assert_eq!(rest(after), rest(before));
    }

    #[test]
    fn niceness_remains() {
        let attributes = std::thread::spawn(|| {
            // SAFETY: has no precondition; 0 is the calling thread.
            unsafe { libc::setpriority(libc::PRIO_PROCESS, 0, 7) };
            shorten().unwrap();
            of_this_thread().unwrap()
        });
        assert_eq!(attributes.join().unwrap().sched_nice, 7);
    }
}
