//! The quality of the gaze, for `parafovea gaze`: numbers about the signal, from which no direction follows.

use crate::inputs::gaze::Look;
use crate::status::SignalQuality;
use glam::Vec3;
use parafovea_core::gaze::{GazePhase, is_unchanged};

/// Period over which rate, validity and noise are measured, nanoseconds.
const WINDOW_NS: i64 = 2_000_000_000;

/// Longest time without eyes that counts as a blink, nanoseconds, and the shortest: a blink takes 100 to 400 ms (BioNumbers; Volkmann
/// et al. 1980), the longest about 500, and less than 50 is a sample that was lost.
const BLINK_NS: std::ops::RangeInclusive<i64> = 50_000_000..=500_000_000;

/// Measures it from frame to frame. Allocates nothing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Signal {
    quality: SignalQuality,
    window: Window,
    /// The newest sample and its time, if known.
    newest: Option<(Vec3, Option<i64>)>,
    /// Since when the eyes are not seen, where they were seen before.
    unseen_since_ns: Option<i64>,
    was_in_saccade: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct Window {
    begun_ns: Option<i64>,
    frames: u32,
    valid: u32,
    samples: u32,
    steps: u32,
    squares_deg2: f64,
}

impl Signal {
    /// The quality so far.
    pub(super) fn quality(&self) -> SignalQuality {
        self.quality
    }

    /// Takes the answer of the source for a frame that is shown at `time_ns`, and the phase of the gaze by that.
    pub(super) fn note(&mut self, look: &Look, phase: GazePhase, time_ns: i64) {
        let begun_ns = *self.window.begun_ns.get_or_insert(time_ns);
        let passed_ns = time_ns.saturating_sub(begun_ns);
        if !(0..WINDOW_NS).contains(&passed_ns) {
            self.close_window(passed_ns);
            self.window.begun_ns = Some(time_ns);
        }
        self.window.frames += 1;
        match *look {
            Look::At { direction, sampled_ns, .. } => {
                self.window.valid += 1;
                self.seen(direction, (sampled_ns > 0).then_some(sampled_ns), phase);
                if let Some(since_ns) = self.unseen_since_ns.take() {
                    let is_blink = BLINK_NS.contains(&time_ns.saturating_sub(since_ns));
                    self.quality.blinks += u32::from(is_blink);
                }
            }
            Look::Unseen | Look::NoTracker => {
                if self.newest.take().is_some() {
                    self.unseen_since_ns = Some(time_ns);
                }
            }
        }
        let is_in_saccade = phase == GazePhase::Saccade;
        self.quality.saccades += u32::from(is_in_saccade && !self.was_in_saccade);
        self.was_in_saccade = is_in_saccade;
    }

    fn seen(&mut self, direction: Vec3, sampled_ns: Option<i64>, phase: GazePhase) {
        // The same sample, in another frame.
        let is_same = self.newest.is_some_and(|(before, before_ns)| match sampled_ns {
            Some(_) => before_ns == sampled_ns,
            None => is_unchanged(before, direction),
        });
        if is_same {
            return;
        }
        self.window.samples += 1;
        let before = self.newest.replace((direction, sampled_ns));
        if let (Some((before, _)), GazePhase::Fixation) = (before, phase) {
            let angle = f64::from(before.angle_between(direction).to_degrees());
            if angle.is_finite() {
                self.window.steps += 1;
                self.window.squares_deg2 += angle * angle;
            }
        }
    }

    /// The window lasted so long.
    fn close_window(&mut self, passed_ns: i64) {
        let window = std::mem::take(&mut self.window);
        // After a pause it is not a measurement.
        if !(WINDOW_NS..2 * WINDOW_NS).contains(&passed_ns) {
            return;
        }
        self.quality.rate_hz = Some((f64::from(window.samples) * 1e9 / passed_ns as f64) as f32);
        self.quality.valid = Some(window.valid as f32 / window.frames.max(1) as f32);
        let noise_deg = (window.squares_deg2 / f64::from(window.steps)).sqrt() as f32;
        self.quality.noise_deg = (window.steps > 0).then_some(noise_deg);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::gaze::direction;

    const FRAME_NS: i64 = 11_111_111;

    /// So many frames with the answers of `look`, in a phase; the display time goes on from `frame`.
    fn run(signal: &mut Signal, frames: std::ops::Range<i64>, phase: GazePhase, look: impl Fn(i64) -> Look) {
        frames.for_each(|frame| signal.note(&look(frame), phase, frame * FRAME_NS));
    }

    fn at(left: f32, sampled_ns: i64) -> Look {
        Look::At { direction: direction([left, 0.0]), sampled_ns, uncertainty_ns: 0 }
    }

    #[test]
    fn rate_noise_and_validity_are_those_of_the_signal() {
        let mut signal = Signal::default();
        // 45 Hz: a sample for two frames, to and fro by 0.2 degrees. Every tenth frame has none.
        run(&mut signal, 1..400, GazePhase::Fixation, |frame| match frame % 10 {
            9 => Look::Unseen,
            _ => at(if frame / 2 % 2 == 0 { 5.0 } else { 5.2 }, frame / 2 * 2 * FRAME_NS),
        });
        let quality = signal.quality();
        assert!((quality.rate_hz.unwrap() - 45.0).abs() < 5.0, "{quality:?}");
        assert!((quality.valid.unwrap() - 0.9).abs() < 0.02, "{quality:?}");
        assert!((quality.noise_deg.unwrap() - 0.2).abs() < 0.01, "{quality:?}");
        assert_eq!((quality.blinks, quality.saccades), (0, 0), "a lost sample is no blink");
    }

    #[test]
    fn samples_of_unknown_time_are_told_apart_by_their_directions() {
        let mut signal = Signal::default();
        // 30 Hz: a sample for three frames, to and fro by 0.2 degrees, with the rounding of poses.
        run(&mut signal, 1..400, GazePhase::Fixation, |frame| {
            at(if frame / 3 % 2 == 0 { 5.0 } else { 5.2 } + 1e-5 * (frame % 3) as f32, 0)
        });
        let quality = signal.quality();
        assert!((quality.rate_hz.unwrap() - 30.0).abs() < 1.0, "{quality:?}");
        assert!((quality.noise_deg.unwrap() - 0.2).abs() < 0.01, "{quality:?}");
    }

    #[test]
    fn blinks_and_saccades_are_counted_once() {
        let mut signal = Signal::default();
        let seen = |frame| at(1.0, frame * FRAME_NS);
        run(&mut signal, 0..10, GazePhase::Fixation, seen);
        run(&mut signal, 10..13, GazePhase::Saccade, seen);
        run(&mut signal, 13..20, GazePhase::PostSaccade, seen);
        run(&mut signal, 20..40, GazePhase::Blink, |_| Look::Unseen);
        run(&mut signal, 40..50, GazePhase::Saccade, seen);
        run(&mut signal, 50..150, GazePhase::Lost, |_| Look::NoTracker);
        run(&mut signal, 150..160, GazePhase::Fixation, seen);
        assert_eq!((signal.quality().blinks, signal.quality().saccades), (1, 2), "a second is no blink");
    }

    #[test]
    fn movement_is_no_noise_and_a_pause_no_measurement() {
        let mut signal = Signal::default();
        run(&mut signal, 1..400, GazePhase::Pursuit, |frame| at(frame as f32 * 0.1, frame * FRAME_NS));
        assert_eq!(signal.quality().noise_deg, None);
        let before = signal.quality();
        signal.note(&Look::Unseen, GazePhase::Blink, 10_000 * FRAME_NS);
        assert_eq!((signal.quality().rate_hz, signal.quality().valid), (before.rate_hz, before.valid));
    }
}
