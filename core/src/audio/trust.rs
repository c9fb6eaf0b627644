//! Reliability of features: by gaps in the sound, and by its age.

use super::{AudioFeatures, AudioSettings, GREATEST_KILOMEL, INTERVAL_S};
use std::collections::VecDeque;

/// Hops that count by themselves: a failure that has just begun is not hidden behind the seconds before.
const LAST_HOPS: usize = 2;

/// Delay up to which features still count in full, seconds: the usual delay of sound through the server on a busy machine.
const FULL_S: f32 = 0.1;

/// From that late on features do not count, seconds; in between they do less and less.
const NOTHING_S: f32 = 0.3;

/// Share of the last T_a that was captured as it was played, by hops of [`INTERVAL_S`].
#[derive(Clone, Debug)]
pub struct Continuity {
    /// Shares of the last hops of the window, oldest first.
    shares: VecDeque<f32>,
    window_hops: usize,
}

impl Continuity {
    /// Of a stream of which nothing was heard yet, in the window of `settings`, [`limited`](AudioSettings::limited).
    pub fn new(settings: &AudioSettings) -> Self {
        let window_hops = ((settings.limited().window_s / INTERVAL_S).round() as usize).max(1);
        Self { shares: VecDeque::with_capacity(window_hops), window_hops }
    }

    /// Adds the share of the next hop that was captured and valid, 0..=1. NaN is 0.
    pub fn push(&mut self, share: f32) {
        if self.shares.len() == self.window_hops {
            self.shares.pop_front();
        }
        self.shares.push_back(if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) });
    }

    /// The lesser of the shares of all of the window and of its last 200 ms, 0..=1. 0 before the first hop; 1 once all of
    /// a window was heard.
    pub fn confidence(&self) -> f32 {
        let share = |hops: usize| {
            let sum: f32 = self.shares.iter().rev().take(hops).sum();
            sum / hops as f32
        };
        share(self.window_hops).min(share(LAST_HOPS))
    }
}

impl AudioFeatures {
    /// Reliable part of features that were captured `age_s` ago with this confidence, 0..=1, where new ones come every
    /// `interval_s`. Times are in seconds; `None` for NaN.
    ///
    /// From 100 to 300 ms after the next ones were due they fade to the features of silence, and then the answer is `None`:
    /// the budget by sound ends in less than 500 ms after capture, and not with a jump. The budget of Eq. 17 is linear in
    /// gamma_ld and in 1/gamma_fq, and so is this.
    pub fn relied_on(&self, age_s: f32, confidence: f32, interval_s: f32) -> Option<Self> {
        let late_s = age_s - interval_s;
        let fresh = 1.0 - ((late_s - FULL_S) / (NOTHING_S - FULL_S)).clamp(0.0, 1.0);
        let trust = fresh * confidence.clamp(0.0, 1.0);
        // Also if the trust is NaN.
        if trust.is_nan() || fresh <= 0.0 {
            return None;
        }
        if self.silent || trust == 0.0 {
            return Some(Self::SILENT);
        }
        let per_kilomel = trust / self.gamma_fq_kilomel + (1.0 - trust) / GREATEST_KILOMEL;
        Some(Self { gamma_ld: self.gamma_ld * trust, gamma_fq_kilomel: 1.0 / per_kilomel, ..*self })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{LEAST_KILOMEL, Mode};
    use super::*;
    use crate::avpm::PAPER;
    use proptest::prelude::*;

    const LOUD: AudioFeatures =
        AudioFeatures { loudness_lufs: -15.0, gamma_ld: 20.0, gamma_fq_kilomel: 1.2, silent: false };

    fn alpha(features: Option<AudioFeatures>) -> f32 {
        features.map_or(0.0, |features| PAPER.alpha(features.gamma_ld, features.gamma_fq_kilomel))
    }

    #[test]
    fn a_window_that_was_heard_is_relied_on_and_a_failing_one_is_not() {
        let mut heard = Continuity::new(&AudioSettings { window_s: 1.0, ..AudioSettings::default() });
        assert_eq!(heard.confidence(), 0.0);
        for _ in 0..5 {
            heard.push(1.0);
        }
        assert!((heard.confidence() - 0.5).abs() < 1e-6);
        for _ in 0..20 {
            heard.push(1.0);
        }
        assert!((heard.confidence() - 1.0).abs() < 1e-6);
        heard.push(0.5);
        assert!((heard.confidence() - 0.75).abs() < 1e-6);
        heard.push(f32::NAN);
        assert!((heard.confidence() - 0.25).abs() < 1e-6);
        heard.push(0.0);
        assert_eq!(heard.confidence(), 0.0);
        for _ in 0..2 {
            heard.push(1.0);
        }
        assert!(
            (heard.confidence() - 0.75).abs() < 1e-2,
            "the gap stays in the window: {}",
            heard.confidence()
        );
    }

    #[test]
    fn fresh_features_count_in_full_and_old_ones_not_at_all() {
        assert_eq!(LOUD.relied_on(0.15, 1.0, 0.1), Some(LOUD));
        assert_eq!(LOUD.relied_on(0.4, 1.0, 0.1), None);
        assert_eq!(LOUD.relied_on(0.4, 1.0, 0.4), Some(LOUD), "they come less often");
        assert_eq!(AudioFeatures::SILENT.relied_on(0.0, 1.0, 0.1), Some(AudioFeatures::SILENT));
        for (age_s, confidence) in [(f32::NAN, 1.0), (0.0, f32::NAN), (f32::INFINITY, 1.0)] {
            assert_eq!(LOUD.relied_on(age_s, confidence, 0.1), None);
        }
    }

    #[test]
    fn half_the_trust_is_half_of_what_sound_pays_for() {
        let silence = PAPER.alpha(0.0, GREATEST_KILOMEL);
        let sound = alpha(Some(LOUD)) - silence;
        for (age_s, confidence) in [(0.3, 1.0), (0.0, 0.5)] {
            let half = alpha(LOUD.relied_on(age_s, confidence, 0.1)) - silence;
            assert!((half - sound / 2.0).abs() < 1e-3 * sound, "{half} of {sound}");
        }
    }

    proptest! {
        /// Later and less continuous never pays for more, and reliable features are within the model's ranges.
        #[test]
        fn less_to_rely_on_pays_for_less(
            gamma_ld in 0f32..25.0,
            gamma_fq_kilomel in LEAST_KILOMEL..GREATEST_KILOMEL,
            ages in (0f32..1.0, 0f32..1.0),
            confidences in (0f32..1.0, 0f32..1.0),
        ) {
            let features = AudioFeatures { gamma_ld, gamma_fq_kilomel, ..LOUD };
            let less = features.relied_on(ages.0.max(ages.1), confidences.0.min(confidences.1), 0.1);
            let more = features.relied_on(ages.0.min(ages.1), confidences.0.max(confidences.1), 0.1);
            prop_assert!(alpha(less) <= alpha(more) * (1.0 + 1e-5));
            for taken in [less, more].into_iter().flatten() {
                prop_assert!((0.0..=25.0).contains(&taken.gamma_ld));
                prop_assert!((LEAST_KILOMEL - 1e-4..=GREATEST_KILOMEL + 1e-4).contains(&taken.gamma_fq_kilomel));
            }
        }
    }

    #[test]
    fn the_window_is_that_of_the_settings() {
        let settings = AudioSettings { mode: Mode::Paper, window_s: 0.4, ..AudioSettings::default() };
        let mut heard = Continuity::new(&settings);
        (0..4).for_each(|_| heard.push(1.0));
        assert_eq!(heard.confidence(), 1.0);
    }
}
