//! More than one session.

use super::stereo::Stereo;
use super::{FRAMES, Outcome};
use crate::app::App;
use crate::session::{Layer, Session};

/// A session ends, and another begins on the same instance and device.
pub fn two_sessions(app: &App) -> Outcome {
    for turn in 0..2 {
        let session = Session::start(app)?;
        let stereo = Stereo::create(&session)?;
        session.frames(FRAMES / 2, |frame| {
            stereo.paint(turn * FRAMES + frame.index)?;
            session.submit(frame, &[Layer::Projection(stereo.images())])
        })?;
        drop(stereo);
        session.finish()?;
    }
    Ok(())
}
