//! From frames to a report.

use crate::errors::bands::Bands;
use crate::errors::clip::{Clip, Eye, Frame, Picture, Viewing};
use crate::errors::field::Field;
use crate::errors::metrics::{
    Metric,
    chroma::Opponent,
    contrast::{self, Mechanism},
    flicker, flip, interocular, squared,
};
use crate::errors::pool::{Pool, TileSums};
use crate::errors::report::{EyeSummary, Report, rows};
use crate::errors::temporal::Responses;
use parafovea_core::image::Plane;
use std::rc::Rc;

/// Reason why a clip cannot be judged.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum JudgeError {
    /// White, contrast or refresh rate.
    #[error("white and refresh rate must be above 0 and finite, the contrast above 1: {0:?}")]
    Viewing(Viewing),
    /// Clips of different length.
    #[error("the reference has {reference} frames, the test {test}")]
    Length {
        /// Frames of the reference.
        reference: usize,
        /// Frames of the test.
        test: usize,
    },
    /// Frames that were not shown one refresh after the other.
    #[error("frame {frame} is not one refresh after the one before it")]
    Time {
        /// Index of the frame.
        frame: usize,
    },
    /// An eye that is not in all frames of both clips.
    #[error("frame {frame}: eye {eye} is in some frames and not in others")]
    Absent {
        /// Index of the frame.
        frame: usize,
        /// 0 left, 1 right.
        eye: usize,
    },
    /// A view without extent, or a gaze without a direction.
    #[error("frame {frame}, eye {eye}: the field of view is empty, or the gaze is not a direction")]
    View {
        /// Index of the frame.
        frame: usize,
        /// 0 left, 1 right.
        eye: usize,
    },
    /// Pictures that do not show the same part of the view, or time.
    #[error("frame {frame}, eye {eye}: reference and test differ in size, field of view, gaze or time")]
    Mismatch {
        /// Index of the frame.
        frame: usize,
        /// 0 left, 1 right.
        eye: usize,
    },
}

/// Judges a clip against its reference.
///
/// # Errors
/// As [`Judge::push`]; [`JudgeError::Length`].
pub fn judge(reference: &Clip, test: &Clip, viewing: &Viewing) -> Result<Report, JudgeError> {
    let (left, right) = (reference.frames.len(), test.frames.len());
    if left != right {
        return Err(JudgeError::Length { reference: left, test: right });
    }
    let mut judge = Judge::new(*viewing)?;
    for (reference, test) in reference.frames.iter().zip(&test.frames) {
        judge.push(reference, test)?;
    }
    Ok(judge.finish())
}

/// Judges frame by frame, so that a clip's images need not be in memory together. It keeps 4 bytes a pixel for each
/// frame and eye.
pub struct Judge {
    viewing: Viewing,
    opponent: Opponent,
    bands: Bands,
    times: Vec<f64>,
    eyes: [Option<EyeRecord>; 2],
    pools: [Pool; Metric::ALL.len()],
}

/// State of one eye.
struct EyeRecord {
    summary: EyeSummary,
    /// By frame.
    fields: Vec<Rc<Field>>,
    /// Test less reference by frame, cd/m^2.
    changes: Vec<Plane>,
    /// Adaptation luminance by frame and cell, cd/m^2.
    adaptation: Vec<Vec<f32>>,
}

impl Judge {
    /// For a display.
    ///
    /// # Errors
    /// [`JudgeError::Viewing`].
    pub fn new(viewing: Viewing) -> Result<Self, JudgeError> {
        let Viewing { white_cd_m2, contrast, refresh_hz } = viewing;
        let sound = white_cd_m2 > 0.0 && contrast > 1.0 && refresh_hz > 0.0;
        if !sound || !(white_cd_m2 * contrast * refresh_hz).is_finite() {
            return Err(JudgeError::Viewing(viewing));
        }
        Ok(Self {
            viewing,
            opponent: Opponent::new(),
            bands: Bands::default(),
            times: Vec::new(),
            eyes: [None, None],
            pools: Default::default(),
        })
    }

    /// Takes the next frame. Field of view and gaze are the same in both.
    ///
    /// # Errors
    /// [`JudgeError::Time`], [`JudgeError::Absent`], [`JudgeError::Mismatch`], [`JudgeError::View`]; the judge is then of no more use.
    pub fn push(&mut self, reference: &Frame, test: &Frame) -> Result<(), JudgeError> {
        let frame = self.times.len();
        self.check_time(reference.time_s)?;
        for eye in 0..2 {
            let (reference_eye, test_eye) = (&reference.eyes[eye], &test.eyes[eye]);
            let expected = if frame == 0 { reference_eye.is_some() } else { self.eyes[eye].is_some() };
            if [reference_eye.is_some(), test_eye.is_some()] != [expected; 2] {
                return Err(JudgeError::Absent { frame, eye });
            }
            let (Some(a), Some(b)) = (reference_eye, test_eye) else { continue };
            let same_view = a.picture.extent() == b.picture.extent() && a.fov == b.fov && a.gaze == b.gaze;
            let first = self.eyes[eye].as_ref().is_none_or(|eye| eye.summary.extent == a.picture.extent());
            if !same_view || !first || reference.time_s != test.time_s {
                return Err(JudgeError::Mismatch { frame, eye });
            }
            let field = self.field(eye, a);
            if !field.is_a_view() {
                return Err(JudgeError::View { frame, eye });
            }
            self.push_eye((eye, frame), field, a, b);
        }
        if let ([Some(a), Some(b)], [Some(c), Some(d)]) = (&reference.eyes, &test.eyes) {
            self.push_both(frame, [a, b], [c, d]);
        }
        self.times.push(reference.time_s);
        Ok(())
    }

    fn check_time(&self, time_s: f64) -> Result<(), JudgeError> {
        let period = 1.0 / f64::from(self.viewing.refresh_hz);
        let frame = self.times.len();
        let even = self.times.last().is_none_or(|last| ((time_s - last) / period - 1.0).abs() < 0.02);
        if time_s.is_finite() && even { Ok(()) } else { Err(JudgeError::Time { frame }) }
    }

    /// Geometry of an eye's next frame, which often is that of the last one.
    fn field(&self, eye: usize, reference: &Eye) -> Rc<Field> {
        let last = self.eyes[eye].as_ref().and_then(|eye| eye.fields.last());
        match last {
            Some(field) if field.fits(reference) => Rc::clone(field),
            _ => Rc::new(Field::new(reference)),
        }
    }

    fn push_eye(&mut self, at: (usize, usize), field: Rc<Field>, reference: &Eye, test: &Eye) {
        let (eye, frame) = at;
        let luminance = reference.picture.luminance(&self.viewing);
        let mut change = test.picture.luminance(&self.viewing);
        let means = [mean(&luminance), mean(&change)];
        change.texels_mut().iter_mut().zip(luminance.texels()).for_each(|(after, before)| *after -= before);
        let adaptation = contrast::adaptation(&luminance, &field, &mut self.bands);

        let (before, after) = (&reference.picture, &test.picture);
        let changed = before != after;
        self.pool(Metric::Squared, &field, at, changed.then(|| squared::map(before, after)));
        let flip = || flip::map(before, after, field.central_pixels_per_degree());
        self.pool(Metric::Flip, &field, at, changed.then(flip));
        let mut colours = changed.then(|| self.opponent.changes(before, after, &self.viewing));
        for (colour, (metric, mechanism)) in
            [(Metric::RedGreen, Mechanism::RedGreen), (Metric::YellowViolet, Mechanism::YellowViolet)]
                .into_iter()
                .enumerate()
        {
            let change = colours.as_mut().map(|colours| &colours[colour]);
            let map = change.map(|change| {
                let weights = mechanism.weights(&field, &adaptation);
                contrast::map(change, &field, &weights, &mut self.bands)
            });
            self.pool(metric, &field, at, map);
        }

        let record = self.eyes[eye].get_or_insert_with(|| EyeRecord {
            summary: EyeSummary::new(&field),
            fields: Vec::new(),
            changes: Vec::new(),
            adaptation: Vec::new(),
        });
        record.summary.add_means(frame, means);
        record.fields.push(field);
        record.changes.push(change);
        record.adaptation.push(adaptation);
    }

    /// Adds a map, or zeros where there is none.
    fn pool(&mut self, metric: Metric, field: &Field, (eye, frame): (usize, usize), map: Option<Plane>) {
        let mut sums = TileSums::default();
        match map {
            Some(map) => sums.add_map(field, &map),
            None => sums.add_zeros(field),
        }
        self.pools[metric as usize].close(&sums, field, (eye, Some(frame)), |mean| mean);
    }

    fn push_both(&mut self, frame: usize, references: [&Eye; 2], tests: [&Eye; 2]) {
        let [Some(left), Some(right)] = &self.eyes else { return };
        let fields = [Rc::clone(&left.fields[frame]), Rc::clone(&right.fields[frame])];
        let both = [&*fields[0], &*fields[1]];
        let displacements = [0, 1].map(|eye| {
            let [before, after] = [references, tests].map(|eyes| eyes[eye].picture.luminance(&self.viewing));
            interocular::displacements(&before, &after, both[eye])
        });
        let disparity = interocular::disparity([&displacements[0], &displacements[1]], both);
        let age = interocular::age(tests, both);
        for (metric, values) in [(Metric::InterocularAge, age), (Metric::InterocularDisparity, disparity)] {
            let mut sums = TileSums::default();
            sums.add_tiles(both[0], values.into_iter());
            self.pools[metric as usize].close(&sums, both[0], (0, Some(frame)), |mean| mean);
        }
    }

    /// Results.
    pub fn finish(mut self) -> Report {
        let frames = self.times.len();
        let eyes = std::mem::take(&mut self.eyes);
        let present = || eyes.iter().enumerate().filter_map(|(eye, record)| Some((eye, record.as_ref()?)));
        let luminances = present().map(|(_, record)| record.summary.reference_cd_m2);
        let luminance = luminances.sum::<f64>() / present().count().max(1) as f64;
        let responses = Responses::new(self.viewing.refresh_hz, luminance as f32);
        for (eye, record) in present() {
            self.seen_over_time(eye, record, &responses);
            self.flicker(eye, record);
        }
        let rows =
            Metric::ALL.iter().zip(&self.pools).flat_map(|(&metric, pool)| rows(metric, pool)).collect();
        let eyes = eyes.map(|record| record.map(|record| record.summary));
        let frame_means = self.pools.iter().map(Pool::frame_means).collect();
        let frame_detected = self.pools.iter().map(Pool::detected_in_frames).collect();
        Report { viewing: self.viewing, frames, eyes, rows, frame_means, frame_detected }
    }

    /// Sustained and transient change.
    fn seen_over_time(&mut self, eye: usize, record: &EyeRecord, responses: &Responses) {
        let frames = record.changes.len();
        let [width, height] = record.summary.extent;
        let mut filtered = Plane::filled(width, height, 0.0);
        for frame in 0..frames {
            let field = &record.fields[frame];
            for (metric, mechanism, kernel) in [
                (Metric::Sustained, Mechanism::Sustained, &responses.sustained),
                (Metric::Transient, Mechanism::Transient(responses.peak_hz), &responses.transient),
            ] {
                let at = |frame: usize| record.changes[frame].texels();
                kernel.filter(frames, frame, filtered.texels_mut(), at);
                let changed = filtered.texels().iter().any(|&change| change != 0.0);
                let map = changed.then(|| {
                    let weights = mechanism.weights(field, &record.adaptation[frame]);
                    contrast::map(&filtered, field, &weights, &mut self.bands)
                });
                self.pool(metric, field, (eye, frame), map);
            }
        }
    }

    fn flicker(&mut self, eye: usize, record: &EyeRecord) {
        let (fields, changes) = (&record.fields[..], &record.changes[..]);
        let mut adaptation = vec![0.0; fields[0].cells.len()];
        for frame in &record.adaptation {
            let share = 1.0 / record.adaptation.len() as f32;
            adaptation.iter_mut().zip(frame).for_each(|(mean, luminance)| *mean += share * luminance);
        }
        let series = flicker::Series { changes, fields, adaptation_cd_m2: &adaptation };
        let Some(sums) = flicker::power(&series, self.viewing.refresh_hz) else { return };
        for (metric, sums) in [Metric::Flicker, Metric::AreaFlicker].into_iter().zip(&sums) {
            self.pools[metric as usize].close(sums, &fields[0], (eye, None), f64::sqrt);
        }
    }
}

/// Visibility of a lasting change at each pixel, JND, by [`Metric::Sustained`] of two stills.
///
/// # Errors
/// [`JudgeError::Viewing`], [`JudgeError::View`] or [`JudgeError::Mismatch`].
pub fn seen_of_stills(reference: &Eye, test: &Picture, viewing: &Viewing) -> Result<Plane, JudgeError> {
    Judge::new(*viewing)?;
    let field = Field::new(reference);
    if !field.is_a_view() {
        return Err(JudgeError::View { frame: 0, eye: 0 });
    }
    if test.extent() != reference.picture.extent() {
        return Err(JudgeError::Mismatch { frame: 0, eye: 0 });
    }
    let mut bands = Bands::default();
    let luminance = reference.picture.luminance(viewing);
    let mut change = test.luminance(viewing);
    change.texels_mut().iter_mut().zip(luminance.texels()).for_each(|(after, before)| *after -= before);
    let adaptation = contrast::adaptation(&luminance, &field, &mut bands);
    let weights = Mechanism::Sustained.weights(&field, &adaptation);
    Ok(contrast::map(&change, &field, &weights, &mut bands))
}

fn mean(plane: &Plane) -> f64 {
    plane.texels().iter().map(|&value| f64::from(value)).sum::<f64>() / plane.texels().len() as f64
}
