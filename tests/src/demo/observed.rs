//! Runs for samples and pictures, which are not timed.

use super::EyeView;
use crate::HarnessError;
use crate::compare::max_difference;
use crate::measure::{Effort, JudgedRun, Subject, Technique, judge_runs, with_pictures};
use crate::picture::Picture;
use crate::run::Outcome;
use crate::scenario::Scenario;
use parafovea_models::errors::Report;

/// Frames from the first judged one to the one of the picture: the eyes still rest then.
const SHOWN_AFTER: u64 = 3;

/// A counted run.
pub struct Observed {
    subject: Subject,
    effort: Effort,
    scenario: Scenario,
    outcome: Outcome,
    /// Samples of a frame, as [`super::Cost::samples`].
    pub samples: Option<u64>,
    /// The left eye's view in the middle of a fixation.
    pub picture: Picture,
}

impl Observed {
    /// Runs an application with a technique; without the layer from shortly before the judged frames on, as nothing has to settle.
    ///
    /// # Errors
    /// Errors of the harness, and an application that does not finish.
    pub fn of(subject: &Subject, effort: Effort, technique: &Technique) -> Result<Self, HarnessError> {
        let run_up = effort.of(technique).run_up;
        let (subject, effort) = (&subject.later(effort.run_up - run_up), Effort { run_up, ..effort });
        let scenario = with_pictures(subject.scenario(effort), effort);
        let run = subject.run_as(technique, effort, &scenario)?.counted();
        let outcome = run.finish()?.expect_frames(effort.length())?;
        let samples = outcome.samples_after(effort.run_up).ok().map(|all| all / effort.frames);
        let picture = outcome.eye(0, shown(effort))?;
        Ok(Self { subject: subject.clone(), effort, scenario, outcome, samples, picture })
    }

    /// Runs it for the picture alone, up to that frame.
    ///
    /// # Errors
    /// As for [`Self::of`].
    pub fn picture_of(
        subject: &Subject,
        effort: Effort,
        technique: &Technique,
    ) -> Result<Picture, HarnessError> {
        let effort = Effort { frames: SHOWN_AFTER + 1, ..effort };
        let mut scenario = with_pictures(subject.scenario(effort), effort);
        scenario.output.save_frames = vec![shown(effort)];
        let run = subject.run_as(technique, effort, &scenario)?;
        let outcome = run.finish()?.expect_frames(effort.length())?;
        outcome.eye(0, shown(effort))
    }

    /// Errors of `test`, a run of the same frames, with this one as the reference.
    ///
    /// # Errors
    /// As for [`judge_runs`].
    pub fn judge(&self, test: &Self) -> Result<Report, HarnessError> {
        judge_runs(self.judged(), test.judged())
    }

    fn judged(&self) -> JudgedRun<'_> {
        JudgedRun { subject: &self.subject, scenario: &self.scenario, outcome: &self.outcome }
    }

    /// Largest difference from `test` up to so many degrees from the true gaze, code values, in the frame of the picture, of both
    /// eyes.
    ///
    /// # Errors
    /// [`HarnessError::File`] if an image is missing.
    pub fn fovea_max_error(&self, test: &Self, radius_deg: f32) -> Result<u8, HarnessError> {
        let mut largest = 0;
        for eye in 0..self.scenario.views.len() {
            let picture = |run: &Self| run.outcome.eye(eye, shown(run.effort));
            let [before, after] = [picture(self)?, picture(test)?];
            let view = self.view(eye);
            let inside = |x, y| view.eccentricity_deg(&before, x, y) <= radius_deg;
            largest = largest.max(max_difference(&before, &after, inside));
        }
        Ok(largest)
    }

    /// An eye's view and true gaze in the frame of the picture.
    pub fn view(&self, eye: usize) -> EyeView {
        let view = &self.scenario.views[eye];
        let gaze = self.subject.true_gaze(shown(self.effort), view).normalize();
        EyeView::new(view, gaze)
    }
}

/// The frame of the picture.
fn shown(effort: Effort) -> u64 {
    effort.run_up + SHOWN_AFTER
}
