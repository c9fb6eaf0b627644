//! Runs for samples and pictures, which are not timed.

use super::{Exhibit, EyeView, work};
use crate::HarnessError;
use crate::compare::max_difference;
use crate::measure::{Effort, Technique, judge, with_pictures};
use crate::picture::Picture;
use crate::progress::Progress;
use crate::run::Outcome;
use crate::scenario::Scenario;
use parafovea_errors::Report;

/// Frames from the first judged one to the one of the picture: the eyes still rest then.
const SHOWN_AFTER: u64 = 3;

/// A counted run.
pub struct Observed<'a> {
    exhibit: &'a Exhibit,
    scenario: Scenario,
    outcome: Outcome,
    /// Samples of a frame, as [`super::Cost::samples`].
    pub samples: Option<u64>,
    /// The left eye's view in the middle of a fixation.
    pub picture: Picture,
}

impl<'a> Observed<'a> {
    /// Runs the exhibit with a technique.
    ///
    /// # Errors
    /// Those of the harness, and an application that does not come to its end.
    pub fn of(
        exhibit: &'a Exhibit,
        technique: &Technique,
        progress: &mut Progress,
    ) -> Result<Self, HarnessError> {
        progress.next(&format!("{}: {}, pictures and samples", exhibit.name(), technique.name));
        let effort = exhibit.counted;
        let scenario = with_pictures(exhibit.subject.scenario(effort), effort);
        let run = exhibit.subject.run_as(technique, effort, &scenario)?.counted();
        let outcome = run.finish()?.expect_frames(effort.length())?;
        progress.add(work::rendering(exhibit, effort));
        let samples = outcome.samples_after(effort.run_up).ok().map(|all| all / effort.frames);
        let picture = outcome.eye(0, shown(effort))?;
        Ok(Self { exhibit, scenario, outcome, samples, picture })
    }

    /// Runs it for the picture alone, up to that frame.
    ///
    /// # Errors
    /// As for [`Self::of`].
    pub fn picture_of(
        exhibit: &Exhibit,
        technique: &Technique,
        progress: &mut Progress,
    ) -> Result<Picture, HarnessError> {
        progress.next(&format!("{}: {}", exhibit.name(), technique.name));
        let frames = SHOWN_AFTER + 1;
        let effort = Effort { frames, ..exhibit.counted };
        let mut scenario = with_pictures(exhibit.subject.scenario(effort), effort);
        scenario.output.save_frames = vec![shown(effort)];
        let run = exhibit.subject.run_as(technique, effort, &scenario)?;
        let outcome = run.finish()?.expect_frames(effort.length())?;
        progress.add(work::rendering(exhibit, exhibit.counted));
        outcome.eye(0, shown(effort))
    }

    /// Errors of `test`, with this run as the reference.
    ///
    /// # Errors
    /// As for [`judge`].
    pub fn judge(&self, test: &Self) -> Result<Report, HarnessError> {
        judge(&self.exhibit.subject, &self.scenario, &self.outcome, &test.outcome)
    }

    /// Largest difference from `test` up to so many degrees from the true gaze, code values, in the frame of the picture, of both
    /// eyes.
    ///
    /// # Errors
    /// [`HarnessError::File`] where a picture is not there.
    pub fn fovea_max_error(&self, test: &Self, radius_deg: f32) -> Result<u8, HarnessError> {
        let frame = shown(self.exhibit.counted);
        let mut largest = 0;
        for eye in 0..self.scenario.views.len() {
            let [before, after] = [self.outcome.eye(eye, frame)?, test.outcome.eye(eye, frame)?];
            let view = self.view(eye);
            let inside = |x, y| view.eccentricity_deg(&before, x, y) <= radius_deg;
            largest = largest.max(max_difference(&before, &after, inside));
        }
        Ok(largest)
    }

    /// An eye's view and true gaze in the frame of the picture.
    pub fn view(&self, eye: usize) -> EyeView {
        let view = &self.scenario.views[eye];
        let gaze = self.exhibit.subject.true_gaze(shown(self.exhibit.counted), view).normalize();
        EyeView::new(view, gaze)
    }
}

/// The frame of the picture.
fn shown(effort: Effort) -> u64 {
    effort.run_up + SHOWN_AFTER
}
