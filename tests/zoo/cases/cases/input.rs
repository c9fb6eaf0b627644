//! Calls of applications about input, at any time and in any order. Every call and every event is in the trace.

pub mod attaching;
pub mod gaze;
pub mod sessions;
pub mod synchronising;

use super::Outcome;
use super::stereo::Stereo;
use crate::failure::Failure;
use crate::session::{Frame, Layer, Session};

/// Frames of a loading screen: longer than any layer waits that takes an application for one without input.
const LOADING: u32 = 130;

/// Frames in which input is used.
const PLAYED: u32 = 12;

/// Shows frames of one picture; `each` comes before it is submitted.
fn show<'s>(
    session: &'s Session<'s>,
    count: u32,
    mut each: impl FnMut(&Frame) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let stereo = Stereo::create(session)?;
    session.frames(count, |frame| {
        session.app.report().trace.push(format!("frame {}", frame.index));
        each(frame)?;
        if frame.index == 0 {
            stereo.paint(0)?;
        }
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })
}
