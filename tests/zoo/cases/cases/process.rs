//! The process itself: children of it.

use super::stereo::Stereo;
use super::{FRAMES, Outcome};
use crate::app::App;
use crate::failure::Failure;
use crate::session::{Layer, Session};
use std::ffi::{c_char, c_int};
use std::ptr::null;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// A child that has not ended by then hangs.
const PATIENCE: Duration = Duration::from_secs(20);

/// A child's exit status.
const CODE: c_int = 7;

unsafe extern "C" {
    fn fork() -> c_int;
    fn execv(path: *const c_char, arguments: *const *const c_char) -> c_int;
    fn atexit(call: extern "C" fn()) -> c_int;
    fn exit(code: c_int) -> !;
    fn _exit(code: c_int) -> !;
    fn kill(process: c_int, signal: c_int) -> c_int;
    fn waitpid(process: c_int, status: *mut c_int, options: c_int) -> c_int;
}

/// Way in which a child process exits.
#[derive(Clone, Copy, Debug)]
enum End {
    /// Exit by `exit`: handlers for the end of the thread and of the process run, in a process with one thread; the driver's handlers do
    /// not, see [`leave_driver_out`].
    Exit,
    /// By `_exit`, at once.
    AtOnce,
    /// As another program.
    Program,
}

/// Ends a child by `exit`, after the thread's own handlers and before handlers that were registered earlier.
///
/// Mesa joins the threads of its queues there. A child does not have those threads, and crashes or hangs by chance, with any
/// layers or none.
extern "C" fn leave_driver_out() {
    if PROCESS.get() != Some(&std::process::id()) {
        // SAFETY: may be called at any time.
        unsafe { _exit(CODE) }
    }
}

/// The application's own process.
static PROCESS: OnceLock<u32> = OnceLock::new();

/// Processes are forked off amid frames, as by crash handlers and launchers, and end before the frame does.
pub fn forks(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    PROCESS.get_or_init(std::process::id);
    // SAFETY: the call may be made at the end of any process.
    unsafe { atexit(leave_driver_out) };
    session.frames(FRAMES, |frame| {
        let end = [End::Exit, End::AtOnce, End::Program][frame.index as usize % 3];
        fork_off(app, end)?;
        stereo.paint(frame.index)?;
        fork_off(app, end)?;
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// Forks, and waits for the child's end.
fn fork_off(app: &App, end: End) -> Result<(), Failure> {
    let program = c"/bin/true";
    let arguments = [program.as_ptr(), null()];
    // SAFETY: the child calls functions that may be called there, and `exit`, which applications expect to work there, too.
    let child = unsafe { fork() };
    if child == 0 {
        // SAFETY: as above; the arguments end with null.
        unsafe {
            match end {
                End::Exit => exit(CODE),
                End::AtOnce => _exit(CODE),
                End::Program => execv(program.as_ptr(), arguments.as_ptr()),
            };
            _exit(1)
        }
    }
    let start = Instant::now();
    let mut status = -1;
    // SAFETY: a child of this process, and room for its status; 1 is WNOHANG.
    while unsafe { waitpid(child, &mut status, 1) } == 0 {
        if start.elapsed() > PATIENCE {
            // SAFETY: the child has not been waited for, so the number is still its; 9 is SIGKILL.
            unsafe { kill(child, 9) };
            return Err(Failure::Unsupported(format!("a child that ends by {end:?} hangs")));
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let expected = if matches!(end, End::Program) { 0 } else { CODE << 8 };
    app.report().fact(&format!("status after {end:?}"), status, expected);
    Ok(())
}
