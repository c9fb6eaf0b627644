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

/// Two sessions exist at once, on one device, and show frames by turns.
pub fn two_sessions_at_once(app: &App) -> Outcome {
    // Events are taken by the session that asks for them: each is begun before the other is there.
    let first = Session::start(app)?;
    let second = Session::start(app)?;
    let sessions = [(&first, Stereo::create(&first)?), (&second, Stereo::create(&second)?)];
    for turn in 0..FRAMES {
        let (session, stereo) = &sessions[turn as usize % 2];
        session.frames(1, |frame| {
            stereo.paint(turn)?;
            session.submit(frame, &[Layer::Projection(stereo.images())])
        })?;
    }
    drop(sessions);
    second.finish()?;
    let stereo = Stereo::create(&first)?;
    first.frames(FRAMES / 2, |frame| {
        stereo.paint(FRAMES + frame.index)?;
        first.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    first.finish()
}
