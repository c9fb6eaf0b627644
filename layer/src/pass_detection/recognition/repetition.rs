//! Frames that repeat one of the last: recognition learns nothing new from them.
//!
//! Recognition takes some microseconds a pass, and games have hundreds of passes a frame, but most games draw the same passes into the same
//! images for minutes. Their numbers of draws and vertices change all the time, and count only as far as they tell a scene from a
//! full-screen pass.

use super::HOLD;
use super::provenance::DrawsClass;
use crate::pass_detection::{Event, Pass, Shown};
use rustc_hash::FxHasher;
use std::hash::{Hash, Hasher};

/// Different frames that are kept: three swapchain images in turn with each of two history images, and a shadow map in every second frame.
const KEPT: usize = 12;

/// Repeated frames in a row after which most are left out: all findings of an earlier time have lapsed, and counts of frames are complete.
const SETTLED: u64 = HOLD + 8;

/// Frames from one sample to the next. Prime, so that samples come to all frames of a shorter period.
const PERIOD: u64 = 61;

/// Frames of a sample: recognition compares up to [`super::roles`]' four frames, and evidence of feedback needs the frame before.
const SAMPLE: u64 = 4;

/// The last frames, as hashes of the facts that recognition learns from.
#[derive(Debug, Default)]
pub(super) struct Repetition {
    hashes: [u64; KEPT],
    /// Index of the hash that the next other frame replaces.
    oldest: usize,
    /// Repeated frames in a row.
    repeated: u64,
}

impl Repetition {
    /// Takes a frame; returns whether recognition may leave it out.
    pub(super) fn may_leave_out(&mut self, events: &[Event], shown: &Shown) -> bool {
        let hash = hash(events, shown);
        if !self.hashes.contains(&hash) {
            self.hashes[self.oldest] = hash;
            self.oldest = (self.oldest + 1) % KEPT;
            self.repeated = 0;
            return false;
        }
        self.repeated += 1;
        self.repeated > SETTLED && self.repeated % PERIOD >= SAMPLE
    }
}

/// The hash of a frame's facts.
fn hash(events: &[Event], shown: &Shown) -> u64 {
    let mut hasher = FxHasher::default();
    events.len().hash(&mut hasher);
    for event in events {
        match event {
            Event::Pass(pass) => hash_pass(pass, &mut hasher),
            Event::Transfer(transfer) => transfer.hash(&mut hasher),
        }
    }
    shown.hash(&mut hasher);
    hasher.finish()
}

fn hash_pass(pass: &Pass, hasher: &mut FxHasher) {
    let Pass { colors, resolves, depth, area, region, view_mask, facts, unmasked: _, draws } = pass;
    (colors, resolves, depth, area, region, view_mask, facts).hash(hasher);
    let draws = draws.as_ref();
    draws.map(|draws| (DrawsClass::new(draws), &draws.read_by_quads, &draws.read_by_meshes)).hash(hasher);
}

#[cfg(test)]
mod tests {
    use super::super::tests::application::{Application, EYE, LDR, target, whole};
    use super::*;
    use crate::pass_detection::{Draws, ImageKey, SwapchainKey};
    use proptest::prelude::*;

    fn frame(image: u64, draws: Draws) -> Vec<Event> {
        vec![Event::Pass(Pass { draws: Some(draws), ..whole(EYE, &[ImageKey(image)]) })]
    }

    fn meshes(count: u32) -> Draws {
        Draws { meshes: count, vertices: 100 * count, ..Draws::default() }
    }

    /// Three images in turn, and numbers of draws that change in every frame.
    #[test]
    fn frames_that_repeat_are_sampled() {
        let (mut repetition, shown) = (Repetition::default(), Shown::default());
        let mut is_left_out = |number: u64, images: u64| {
            let events = frame(number % images, meshes(50 + number as u32 % 100));
            repetition.may_leave_out(&events, &shown)
        };
        assert!((0..SETTLED).all(|number| !is_left_out(number, 3)));
        let learned = (0..100 * PERIOD).filter(|number| !is_left_out(*number, 3)).count();
        assert!(learned.abs_diff(100 * SAMPLE as usize) <= SAMPLE as usize, "{learned}");
        assert!(!is_left_out(3, 4), "another image");
        assert!((0..SETTLED).all(|number| !is_left_out(number, 3)), "and learning begins again");
    }

    #[test]
    fn samples_come_to_every_frame_of_a_period() {
        for period in 1..=KEPT as u64 {
            let (mut repetition, shown) = (Repetition::default(), Shown::default());
            let mut learned = vec![0; period as usize];
            for number in 0..SETTLED + 2 * period * PERIOD {
                let is_learned = !repetition.may_leave_out(&frame(number % period, meshes(50)), &shown);
                learned[(number % period) as usize] =
                    if is_learned { number } else { learned[(number % period) as usize] };
            }
            assert!(learned.iter().all(|last| *last > SETTLED + period), "period {period}: {learned:?}");
        }
    }

    #[test]
    fn each_fact_counts() {
        let pass = || Pass { draws: Some(meshes(50)), ..whole(EYE, &[ImageKey(1)]) };
        let of = |change: fn(&mut Pass)| {
            let mut pass = pass();
            change(&mut pass);
            hash(&[Event::Pass(pass)], &Shown::default())
        };
        let same = of(|_| {});
        assert_eq!(same, of(|pass| pass.draws = Some(meshes(51))));
        let others: [fn(&mut Pass); 9] = [
            |pass| pass.colors[0] = target(ImageKey(2)),
            |pass| pass.resolves.push(target(ImageKey(2))),
            |pass| pass.depth = Some(target(ImageKey(2))),
            |pass| pass.area[2] -= 1,
            |pass| pass.region[2] -= 1,
            |pass| pass.view_mask = 3,
            |pass| pass.facts.clears_depth = true,
            |pass| pass.draws = Some(meshes(1)),
            |pass| pass.draws = None,
        ];
        for (number, other) in others.into_iter().enumerate() {
            assert_ne!(same, of(other), "{number}");
        }
        let shown = Shown { flat: [SwapchainKey(1)].into_iter().collect(), ..Shown::default() };
        assert_ne!(same, hash(&[Event::Pass(pass())], &shown));
        assert_ne!(same, hash(&[Event::Pass(pass()), Event::Pass(pass())], &Shown::default()));
    }

    proptest! {
        /// A swapchain that was shown to the eyes for long, and then flat, is left alone from the next frame on.
        #[test]
        fn a_change_after_a_long_time_is_learned_at_once(frames in 1..4 * PERIOD) {
            let mut application = Application::default();
            let eyes = application.eyes();
            let draw = |application: &mut Application, flat: &[SwapchainKey]| {
                for chain in &eyes {
                    let mut pass = whole(chain.extent, &[application.current(chain)]);
                    let depth = application.kept(1_000_000, EYE, LDR);
                    pass.depth = Some(target(depth));
                    pass.facts.clears_depth = true;
                    application.pass("eye", pass);
                }
                let shown = Shown { flat: flat.iter().copied().collect(), ..application.both(&eyes) };
                application.show(&shown);
            };
            application.run(SETTLED + frames, |application| draw(application, &[]));
            let learned = application.recognition.frame;
            prop_assert!(learned < SETTLED + 4 * SAMPLE + 8 + PERIOD.min(frames), "{learned}");
            application.run(2, |application| draw(application, &[eyes[0].key, eyes[1].key]));
            for (frame, outcome) in application.outcomes("eye") {
                let is_eye = (SETTLED..application.frame).contains(&frame);
                prop_assert!(is_eye == outcome.is_ok() || frame < SETTLED, "frame {frame}: {outcome:?}");
            }
        }
    }
}
