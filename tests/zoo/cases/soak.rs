//! Sessions of an application, some at a time, one after the other in one process, and the process's resources after each of its lives.
//!
//! Only failures of calls are checked here; the cases check the results.

use crate::app::App;
use crate::cases::stereo::Stereo;
use crate::failure::Failure;
use crate::options::Options;
use crate::sequences::Numbers;
use crate::session::{Layer, Session};
use crate::swapchain::Shape;
use parafovea_zoo::cases::life::Life;
use parafovea_zoo::cases::report::Report;
use std::ffi::c_int;
use std::time::{Duration, Instant};

/// Sessions of a life.
const SESSIONS: u32 = 2;

/// Sizes of the pictures of a session, one after the other.
const RESOLUTIONS: u32 = 2;

/// Most frames of each; a third of them is the least.
const FRAMES: u32 = 90;

unsafe extern "C" {
    /// glibc: returns free memory to the system.
    fn malloc_trim(pad: usize) -> c_int;
}

/// Lives for so long, and prints a [`Life`] as JSON after each.
pub fn run(options: &Options, time: Duration) -> Result<(), Failure> {
    let start = Instant::now();
    let mut numbers = Numbers::new(0);
    // One device for all: drivers and loaders keep something of each that there was.
    let app = App::start(options, &[])?;
    while start.elapsed() < time {
        live(&app, &mut numbers)?;
        *app.report() = Report::default();
        // SAFETY: callable at any time.
        unsafe { malloc_trim(0) };
        let life = Life { seconds: start.elapsed().as_secs_f64(), ..Life::now() };
        println!("{}", serde_json::to_string(&life).unwrap_or_default());
    }
    Ok(())
}

fn live(app: &App, numbers: &mut Numbers) -> Result<(), Failure> {
    for _ in 0..SESSIONS {
        let session = Session::start(app)?;
        for _ in 0..RESOLUTIONS {
            let side = 48 + 16 * numbers.below(6) as u32;
            let shape = Shape::srgb([side, side + 16]);
            let stereo = Stereo::with_shapes(&session, [&shape, &shape])?;
            session.frames(FRAMES / 3 + numbers.below(FRAMES as usize * 2 / 3) as u32, |frame| {
                stereo.paint(frame.index)?;
                session.submit(frame, &[Layer::Projection(stereo.images())])
            })?;
        }
        // Some applications never end their sessions.
        if !numbers.once_in(4) {
            session.finish()?;
        }
    }
    Ok(())
}
