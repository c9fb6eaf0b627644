//! Errors of the images that a technique shows.

use super::{Effort, Subject, Technique};
use crate::HarnessError;
use crate::run::Outcome;
use crate::scenario::{Picture, Scenario, View};
use parafovea_core::geometry::Fov;
use parafovea_models::errors::{Eye, Frame, Judge, Report, Viewing};
use parafovea_scene::scene::FRAMES_PER_SECOND;
use parafovea_scene::script::WHITE_CD_M2;

/// Frames that are not judged at the start of a run: rates and colour ramp from nothing there.
pub const RUN_UP: u64 = 10;

/// Shows `subject` with each of `techniques`, the first of which is the reference, and judges the eyes' images, after the runtime's
/// compositor, around the true gaze. The results are in the order of the techniques behind the first.
///
/// `progress` is called before every run.
///
/// # Errors
/// Errors of the harness, and an application that does not finish.
pub fn errors(
    subject: &Subject,
    techniques: &[Technique],
    effort: Effort,
    mut progress: impl FnMut(&str),
) -> Result<Vec<Report>, HarnessError> {
    let scenario = with_pictures(subject.scenario(effort), effort);
    let mut show = |technique: &Technique| -> Result<Outcome, HarnessError> {
        progress(&format!("{}: {}, pictures", subject.name(), technique.name));
        subject.run_as(technique, effort, &scenario)?.finish()?.expect_frames(effort.length())
    };
    let Some((reference, others)) = techniques.split_first() else { return Ok(Vec::new()) };
    let reference = show(reference)?;
    others.iter().map(|technique| judge(subject, &scenario, &reference, &show(technique)?)).collect()
}

/// The display: an sRGB one of 100 cd/m^2.
pub(super) fn viewing() -> Viewing {
    Viewing { white_cd_m2: WHITE_CD_M2, refresh_hz: FRAMES_PER_SECOND as f32, ..Viewing::default() }
}

/// The same, with the eyes' images of the frames after the run-up kept for [`judge`].
pub fn with_pictures(mut scenario: Scenario, effort: Effort) -> Scenario {
    scenario.output.save_frames = (effort.run_up..effort.length()).collect();
    scenario.output.save = vec![Picture::Eye];
    scenario
}

/// Computes the errors of the images of `test` against `reference`, both runs of `subject` in one scenario
/// [`with_pictures`].
///
/// # Errors
/// [`HarnessError::File`] if an image is missing, [`HarnessError::Application`] if they do not belong together.
pub fn judge(
    subject: &Subject,
    scenario: &Scenario,
    reference: &Outcome,
    test: &Outcome,
) -> Result<Report, HarnessError> {
    let run = |outcome| JudgedRun { subject, scenario, outcome };
    judge_runs(run(reference), run(test))
}

/// A run whose pictures are judged.
#[derive(Clone, Copy)]
pub struct JudgedRun<'a> {
    /// The application, and the script of head and eyes.
    pub subject: &'a Subject,
    /// Its scenario, [`with_pictures`].
    pub scenario: &'a Scenario,
    /// Its outcome.
    pub outcome: &'a Outcome,
}

/// As [`judge`], of two runs that come to the same frames of the script after different run-ups.
///
/// # Errors
/// As [`judge`].
pub fn judge_runs(reference: JudgedRun, test: JudgedRun) -> Result<Report, HarnessError> {
    let failed = |error| test.outcome.failed(&format!("its pictures cannot be judged: {error}"));
    let mut judge = Judge::new(viewing()).map_err(failed)?;
    let frames = |run: JudgedRun| run.scenario.output.save_frames.clone();
    for (before, after) in frames(reference).into_iter().zip(frames(test)) {
        let shown = |run: JudgedRun, frame| shown(run.subject, run.scenario, run.outcome, frame);
        judge.push(&shown(reference, before)?, &shown(test, after)?).map_err(failed)?;
    }
    Ok(judge.finish())
}

/// As [`judge`], of the pictures of `reference` as `alter` changes them: it is given frame, eye and picture.
///
/// # Errors
/// As [`judge`].
pub fn judge_shaded(
    subject: &Subject,
    scenario: &Scenario,
    reference: &Outcome,
    alter: impl Fn(u64, usize, &parafovea_models::errors::Picture) -> parafovea_models::errors::Picture,
) -> Result<Report, HarnessError> {
    let failed = |error| reference.failed(&format!("its pictures cannot be judged: {error}"));
    let mut judge = Judge::new(viewing()).map_err(failed)?;
    for &frame in &scenario.output.save_frames {
        let before = shown(subject, scenario, reference, frame)?;
        let mut after = before.clone();
        for (index, eye) in (0..).zip(&mut after.eyes) {
            if let Some(eye) = eye {
                eye.picture = alter(frame, index, &eye.picture);
            }
        }
        judge.push(&before, &after).map_err(failed)?;
    }
    Ok(judge.finish())
}

/// Images of both eyes in a frame.
fn shown(
    subject: &Subject,
    scenario: &Scenario,
    outcome: &Outcome,
    frame: u64,
) -> Result<Frame, HarnessError> {
    let eye = |index| shown_to(JudgedRun { subject, scenario, outcome }, frame, index);
    Ok(Frame { time_s: subject.time_s(frame), eyes: [eye(0)?, eye(1)?] })
}

/// Image of one eye (0 left, 1 right) in a frame; none where the scenario has no such view.
pub(super) fn shown_to(run: JudgedRun, frame: u64, eye: usize) -> Result<Option<Eye>, HarnessError> {
    let Some(view) = run.scenario.views.get(eye) else { return Ok(None) };
    let picture = run.outcome.eye(eye, frame)?;
    let codes = parafovea_models::errors::Picture::from_srgb8(picture.width, picture.height, &picture.pixels);
    let gaze = run.subject.true_gaze(frame, view);
    Ok(codes.map(|picture| Eye { picture, fov: fov(view), gaze, age: None }))
}

/// Field of view of a view, radians.
pub fn fov(view: &View) -> Fov {
    let degrees = view.fov_deg;
    let [left, right, up, down] =
        [degrees.left, degrees.right, degrees.up, degrees.down].map(f32::to_radians);
    Fov { left, right, up, down }
}
