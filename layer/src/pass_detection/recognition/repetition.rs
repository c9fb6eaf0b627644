//! Frames that repeat one of the last: recognition learns nothing new from them.
//!
//! Recognition takes some microseconds a pass, and games have hundreds of passes a frame, but most games draw the same passes into the same
//! images for minutes. Their numbers of draws and vertices change all the time, and count only as far as they tell a scene from a
//! full-screen pass.

use super::provenance::DrawsClass;
use crate::pass_detection::{Draws, Event, Pass, Reads, Shown};
use rustc_hash::FxHasher;
use std::hash::{Hash, Hasher};

/// Frames that a repeated one may be like. Three swapchain images in turn, each with two history images and with a shadow map in every second
/// frame, repeat after 12; a menu that was left half a second ago is another frame.
const KEPT: usize = 24;

/// Repeated frames in a row after which most are left out: every memory of earlier frames has lapsed, the longest of them after 600
/// frames (swapchains that are not shown any more).
const SETTLED: u64 = 728;

/// Frames from one sample to the next. Prime, so that samples come to all frames of a shorter period.
const PERIOD: u64 = 61;

/// Frames of a sample: roles are compared over four frames, and evidence of feedback needs the frame before.
const SAMPLE: u64 = 4;

/// The last frames, as hashes of the facts that recognition learns from.
#[derive(Debug, Default)]
pub(super) struct Repetition {
    hashes: [u64; KEPT],
    /// Index of the oldest hash.
    oldest: usize,
    /// Repeated frames in a row.
    repeated: u64,
}

impl Repetition {
    /// Takes a frame; returns whether recognition may leave it out.
    pub(super) fn may_leave_out(&mut self, events: &[Event], shown: &Shown) -> bool {
        let hash = hash(events, shown);
        let is_repeated = self.hashes.contains(&hash);
        self.hashes[self.oldest] = hash;
        self.oldest = (self.oldest + 1) % KEPT;
        self.repeated = if is_repeated { self.repeated + 1 } else { 0 };
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

/// Adds the facts of a pass. Its viewports and most of its other facts limit backends, and tell recognition nothing.
fn hash_pass(pass: &Pass, hasher: &mut FxHasher) {
    let Pass { colors, resolves, depth, area, region: _, view_mask, facts, unmasked: _, draws } = pass;
    (colors, resolves, depth, area, view_mask).hash(hasher);
    (facts.clears_depth, facts.loads_color, draws.is_some()).hash(hasher);
    if let Some(draws) = draws {
        let Draws { read_by_quads, read_by_meshes, .. } = draws;
        DrawsClass::new(draws).within(pass).hash(hasher);
        [read_by_quads, read_by_meshes].map(sum).hash(hasher);
    }
}

/// The images that draws read, in any order: the order of draws changes with the place of the camera.
fn sum(reads: &Reads) -> (usize, bool, u64) {
    let of_image = |image| {
        let mut hasher = FxHasher::default();
        Hash::hash(image, &mut hasher);
        hasher.finish()
    };
    let sum = reads.images.iter().map(of_image).fold(0, u64::wrapping_add);
    (reads.images.len(), reads.may_read_more, sum)
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
        for period in 1..=12 {
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
        assert_eq!(same, of(|pass| pass.region[2] -= 1), "dynamic resolution");
        assert_eq!(same, of(|pass| pass.facts.is_queried = true));
        let others: [fn(&mut Pass); 9] = [
            |pass| pass.colors[0] = target(ImageKey(2)),
            |pass| pass.resolves.push(target(ImageKey(2))),
            |pass| pass.depth = Some(target(ImageKey(2))),
            |pass| pass.area[2] -= 1,
            |pass| pass.facts.loads_color = true,
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

    #[test]
    fn the_order_of_reads_does_not_count() {
        let of = |images: [u64; 2]| {
            let mut draws = meshes(50);
            images.into_iter().for_each(|image| draws.read_by_meshes.push(ImageKey(image)));
            hash(&frame(1, draws), &Shown::default())
        };
        assert_eq!(of([2, 3]), of([3, 2]));
        assert_ne!(of([2, 3]), of([2, 4]));
    }

    #[test]
    fn many_draws_that_clear_depth_are_a_scene_whatever_they_are() {
        let of = |count: u32, clears_depth: bool| {
            let mut events = frame(1, meshes(count));
            let Event::Pass(pass) = &mut events[0] else { unreachable!() };
            pass.facts.clears_depth = clears_depth;
            hash(&events, &Shown::default())
        };
        assert_eq!(of(50, true), of(1, true));
        assert_ne!(of(50, false), of(1, false));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// Swapchains that change between the eyes and a quad, for a long time each, and again: the pass is left alone from the second
        /// frame of a quad on.
        #[test]
        fn a_change_after_a_long_time_is_learned_at_once(
            times in prop::collection::vec(KEPT as u64 + 1..SETTLED + 4 * PERIOD, 1..4)
        ) {
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
            let mut quads = Vec::new();
            for frames in times {
                application.run(SETTLED + 4 * PERIOD, |application| draw(application, &[]));
                let first = application.frame + 1;
                application.run(frames, |application| draw(application, &[eyes[0].key, eyes[1].key]));
                quads.push(first + 1..application.frame + 1);
            }
            prop_assert!(application.recognition.frame < application.frame);
            for (frame, outcome) in application.outcomes("eye") {
                if quads.iter().any(|quad| quad.contains(&frame)) {
                    prop_assert!(outcome.is_err(), "frame {frame}");
                }
            }
            // The first time ends before anything was flat.
            let is_eye = |(frame, outcome): (u64, Result<_, _>)| !(5..=SETTLED).contains(&frame) || outcome.is_ok();
            prop_assert!(application.outcomes("eye").into_iter().all(is_eye));
        }
    }
}
