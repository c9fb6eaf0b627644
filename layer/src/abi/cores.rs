//! The processor core of a thread.
//!
//! Linux may wake a thread on the core of its waker though others are idle, where few cores share a cache, and keeps waking it where it ran
//! last. A thread that works beside another one leaves that core.

/// Cores on which a thread may run.
pub struct Cores {
    thread: libc::pid_t,
    /// As the process, or its user (`taskset`), has set them; `None` if the system does not report them.
    allowed: Option<libc::cpu_set_t>,
}

impl Cores {
    /// The allowed cores of the calling thread.
    pub fn of_this_thread() -> Self {
        // SAFETY: all bit patterns of a core set are valid.
        let mut allowed: libc::cpu_set_t = unsafe { std::mem::zeroed() };
        // SAFETY: the set is valid to write to, and 0 is the calling thread.
        let result = unsafe { libc::sched_getaffinity(0, size_of::<libc::cpu_set_t>(), &mut allowed) };
        // SAFETY: has no precondition.
        let thread = unsafe { libc::gettid() };
        Self { thread, allowed: (result == 0).then_some(allowed) }
    }

    /// Makes the calling thread, whose cores these are, run on other cores than `core` from now on, if it runs there and has others.
    pub fn leave(&self, core: u32) {
        if current_core() == Some(core) {
            self.keep_off(core);
        }
    }

    /// Makes the thread, which may be another one than the calling one, run on other cores than `core` from now on, if it has others.
    pub fn keep_off(&self, core: u32) {
        let Some(mut others) = self.allowed else { return };
        let place = core as usize;
        // SAFETY: the set is valid, and the place below its size, as the kernel has given the set and the core.
        unsafe {
            if place < libc::CPU_SETSIZE as usize && libc::CPU_COUNT(&others) > 1 {
                libc::CPU_CLR(place, &mut others);
                // Without success the thread stays where it is.
                libc::sched_setaffinity(self.thread, size_of::<libc::cpu_set_t>(), &others);
            }
        }
    }
}

/// The core on which the calling thread runs; `None` if the system does not report it.
pub fn current_core() -> Option<u32> {
    // SAFETY: has no precondition.
    u32::try_from(unsafe { libc::sched_getcpu() }).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a machine with one core it stays there.
    #[test]
    fn a_thread_leaves_the_core_of_another() {
        // Not the parallelism, which is also limited by quotas of time.
        // SAFETY: the set is valid.
        let others = unsafe { libc::CPU_COUNT(&Cores::of_this_thread().allowed.unwrap()) } > 1;
        let left = std::thread::spawn(|| {
            let cores = Cores::of_this_thread();
            (0..8).all(|_| {
                let core = current_core().unwrap();
                cores.leave(core);
                current_core() != Some(core)
            })
        });
        assert_eq!(left.join().unwrap(), others);
    }

    /// A thread that sleeps is not in the way when it wakes up.
    #[test]
    fn a_thread_is_kept_off_the_core_of_another() {
        let (sender, receiver) = std::sync::mpsc::channel();
        let (wake, woken) = std::sync::mpsc::channel();
        let thread = std::thread::spawn(move || {
            sender.send(Cores::of_this_thread()).unwrap();
            woken.recv().unwrap();
            Cores::of_this_thread()
        });
        let cores = receiver.recv().unwrap();
        let core = current_core().unwrap();
        cores.keep_off(core);
        wake.send(()).unwrap();
        let [before, after] = [cores, thread.join().unwrap()].map(|cores| cores.allowed.unwrap());
        // SAFETY: valid sets, and a core of this machine.
        unsafe {
            assert_eq!(libc::CPU_ISSET(core as usize, &after), libc::CPU_COUNT(&before) == 1);
        }
    }

    #[test]
    fn a_thread_elsewhere_stays() {
        let ran_on = std::thread::spawn(|| {
            let cores = Cores::of_this_thread();
            cores.leave(libc::CPU_SETSIZE as u32);
            cores.leave(u32::MAX);
            // SAFETY: a set of bits, and the calling thread.
            unsafe {
                let mut now: libc::cpu_set_t = std::mem::zeroed();
                libc::sched_getaffinity(0, size_of::<libc::cpu_set_t>(), &mut now);
                libc::CPU_EQUAL(&now, &cores.allowed.unwrap())
            }
        });
        assert!(ran_on.join().unwrap());
    }
}
