//! JOD of the pictures that a technique shows, by FovVideoVDP.

use super::JudgedRun;
use super::errors::{shown_to, viewing};
use crate::HarnessError;
use parafovea_models::errors::fvvdp::{Fvvdp, Jod};
use parafovea_models::errors::{Clip, Frame, Picture};

/// JOD of `test` beside `reference`, both [`with_pictures`](super::with_pictures), for one eye (0 left, 1 right) that looks where it truly does.
///
/// # Errors
/// [`HarnessError::File`] where a picture is missing, [`HarnessError::Application`] where FovVideoVDP fails.
pub fn jod(fvvdp: &Fvvdp, reference: JudgedRun, test: JudgedRun, eye: usize) -> Result<Jod, HarnessError> {
    found(fvvdp, test, [&clip(reference, eye)?, &clip(test, eye)?], eye)
}

/// As [`jod`], of the pictures of `reference` as `alter` changes them: it is given frame and picture.
///
/// # Errors
/// As [`jod`].
pub fn jod_shaded(
    fvvdp: &Fvvdp,
    reference: JudgedRun,
    eye: usize,
    alter: impl Fn(u64, &Picture) -> Picture,
) -> Result<Jod, HarnessError> {
    let before = clip(reference, eye)?;
    let mut after = before.clone();
    for (&frame, shown) in reference.scenario.output.save_frames.iter().zip(&mut after.frames) {
        if let Some(eye) = &mut shown.eyes[eye] {
            eye.picture = alter(frame, &eye.picture);
        }
    }
    found(fvvdp, reference, [&before, &after], eye)
}

fn found(
    fvvdp: &Fvvdp,
    test: JudgedRun,
    [before, after]: [&Clip; 2],
    eye: usize,
) -> Result<Jod, HarnessError> {
    fvvdp.jod(before, after, eye, &viewing()).map_err(|error| test.outcome.failed(&error.to_string()))
}

/// The saved frames, as one eye sees them.
fn clip(run: JudgedRun, eye: usize) -> Result<Clip, HarnessError> {
    let frames = run.scenario.output.save_frames.iter().map(|&frame| {
        let mut eyes = [None, None];
        eyes[eye] = shown_to(run, frame, eye)?;
        Ok(Frame { time_s: run.subject.time_s(frame), eyes })
    });
    Ok(Clip { frames: frames.collect::<Result<_, HarnessError>>()? })
}
