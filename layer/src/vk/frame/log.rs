//! The application's events since the last frame ended, and recognition, which learns from them.

use super::MapContent;
use super::passes_file::Notes;
use super::rest::Rest;
use crate::pass_detection::{
    Event, EyePasses, Feedback, Match, Pass, Recognition, Shown, SwapchainKey, Unmatched,
};
use crate::vk::objects::Objects;
use parafovea_core::reuse::StaleTiles;
use parafovea_manifest::options::PassRules;
use std::sync::Arc;

/// An application that does more than this in a frame, or shows no frames, is not followed further. Recognition looks at all earlier events, so
/// the limit bounds its time: 4096 passes take some 10 ms in all, and engines have a few hundred in a frame.
const MOST_EVENTS: usize = 4096;

/// From this number of events on, transfers are left out: verdicts on later passes depend on earlier frames and on the order of passes alone.
const MOST_TRANSFERS: usize = 3072;

/// Frames by which applications record ahead of the one that they submit.
const AHEAD: u64 = 2;

/// One frame's events, in the order of their submits.
#[derive(Default)]
pub struct Log {
    frame: u64,
    events: Vec<Event>,
    /// For tests: the verdicts on `events`.
    notes: Notes,
    recognition: Recognition,
    rest: Rest,
    /// Whether passes were submitted in the current frame whose commands were not tracked.
    is_incomplete: bool,
    /// Whether a frame had too many events, and the log has a line on it.
    was_full: bool,
    /// Passes that got the plan's rates, in the current frame and in the last.
    with_rates: [u32; 2],
    /// Passes that were recognised as an eye buffer, in the current frame.
    eye_passes: EyePasses,
    /// [`EyePasses::number`] of the last frame.
    last_eye_passes: u32,
    /// [`EyePasses::pixels`] of the last frame.
    last_eye_pixels: u32,
    /// Stale tiles of each eye buffer that passes did not render, in the current frame and in the last.
    stale_tiles: [[StaleTiles; 2]; 2],
}

impl Log {
    /// Takes the profile's rules on passes.
    pub fn set_rules(&mut self, rules: PassRules) {
        self.recognition.set_rules(rules);
    }

    /// Takes whether the gates rest from the current frame on.
    pub fn set_resting(&mut self, rests: bool) {
        self.rest.set(rests, self.frame);
    }

    /// Whether the passes of the current frame are noted.
    pub fn follows(&self) -> bool {
        self.rest.follows(self.frame) || self.notes.is_wanted()
    }

    /// Whether commands that are recorded now may go untracked: none of the frames in which they may be submitted is followed.
    pub fn rests(&self) -> bool {
        !self.notes.is_wanted() && (0..=AHEAD).all(|ahead| !self.rest.follows(self.frame + ahead))
    }

    /// Frames from the current one on in which [`Self::rests`] holds.
    pub fn untracked_frames(&self) -> u32 {
        if self.notes.is_wanted() {
            0
        } else {
            self.rest.untracked_frames(self.frame).saturating_sub(AHEAD) as u32
        }
    }

    /// Skips frames whose passes were not followed.
    pub fn skip(&mut self, frames: u32) {
        self.frame += u64::from(frames);
        self.recognition.miss();
    }

    /// Commands are submitted for the first time that were not tracked.
    pub fn miss(&mut self) {
        self.is_incomplete = true;
    }

    /// Number of the current frame.
    pub fn frame(&self) -> u64 {
        self.frame
    }

    /// A pass that is submitted has the plan's rates.
    pub fn has_rates(&mut self) {
        self.with_rates[0] = self.with_rates[0].saturating_add(1);
    }

    /// Number of passes with the plan's rates in the last frame.
    pub fn with_rates(&self) -> u32 {
        self.with_rates[1]
    }

    /// A pass that is submitted is recognised as an eye buffer.
    pub fn has_eye_pass(&mut self, objects: &Objects, pass: &Pass) {
        if let Some(first) = pass.colors.first().and_then(|target| objects.describe(target.image)) {
            self.eye_passes.add(pass, &first);
        }
    }

    /// [`EyePasses::number`] of the passes that were recognised as an eye buffer in the last frame.
    pub fn eye_passes(&self) -> u32 {
        self.last_eye_passes
    }

    /// [`EyePasses::pixels`] of the same passes.
    pub fn eye_pixels(&self) -> u32 {
        self.last_eye_pixels
    }

    /// Use of earlier frames' images in an eye buffer, by the evidence of the last frames.
    pub fn feedback(&self) -> Feedback {
        self.recognition.feedback()
    }

    /// Adds the stale tiles that submitted passes do not render.
    pub fn add_stale(&mut self, stale: &[StaleTiles; 2]) {
        for (tiles, stale) in self.stale_tiles[0].iter_mut().zip(stale) {
            tiles.unite(stale);
        }
    }

    /// Stale tiles of an eye buffer in the last frame, which passes did not render.
    pub fn stale(&self, eye: usize) -> Option<&StaleTiles> {
        self.stale_tiles[1].get(eye)
    }

    /// Takes a submitted event. Returns the verdict on a pass that draws to a candidate; on any pass if tests ask for that. `None` for any event
    /// once there are too many. Nothing is learned from a frame with too many passes or transfers, because the rest may change any finding: a
    /// mirror may follow, or the copy that shows a picture.
    pub fn push<C: MapContent>(
        &mut self,
        objects: &Objects,
        event: &Event,
        candidate: Option<&Arc<C>>,
    ) -> Option<Result<Match, Unmatched>> {
        let most = if matches!(event, Event::Pass(_)) { MOST_EVENTS } else { MOST_TRANSFERS };
        if self.events.len() >= most {
            self.is_incomplete = true;
            if !std::mem::replace(&mut self.was_full, true) {
                tracing::warn!(
                    "more than {most} render passes and copies in one frame: recognition does not learn from such frames"
                );
            }
            return None;
        }
        let is_told = self.notes.is_wanted();
        let verdict = match event {
            Event::Pass(pass) if candidate.is_some() || is_told => Some(self.recognise(objects, pass)),
            _ => None,
        };
        self.events.push(event.clone());
        if is_told {
            self.notes.push(verdict.as_ref(), candidate);
        }
        verdict
    }

    /// The verdict on a pass that is about to be submitted.
    fn recognise(&self, objects: &Objects, pass: &Pass) -> Result<Match, Unmatched> {
        self.recognition.of(pass, &self.events, |key| objects.describe(key))
    }

    /// A swapchain is gone.
    pub fn forget_swapchain(&mut self, swapchain: SwapchainKey) {
        self.recognition.forget_swapchain(swapchain);
    }

    /// Whether recognition learns from the current frame.
    pub fn learns(&self) -> bool {
        !self.is_incomplete && (self.rest.learns(self.frame) || self.notes.is_wanted())
    }

    /// Learns from the frame, and begins the next one.
    pub fn end_frame(&mut self, objects: &Objects, shown: &Shown) {
        self.notes.end_frame(objects, self.frame, &self.events);
        if self.recognition.frame(&self.events, |key| objects.describe(key), shown) {
            self.recognition.log_new_verdicts(|topic, line| crate::status::decided(topic, line));
        }
        self.begin_next(objects);
    }

    /// Begins the next frame without learning from the last one.
    pub fn begin_next(&mut self, objects: &Objects) {
        // Eye passes of a frame that was not followed are assumed to be the same as in the last sample. An incomplete frame with all of
        // them has pixels of its own.
        let eye_passes = self.eye_passes.number();
        if self.learns() || eye_passes == self.last_eye_passes {
            (self.last_eye_passes, self.last_eye_pixels) = (eye_passes, self.eye_passes.pixels());
        }
        if !self.learns() {
            self.recognition.miss();
        }
        self.is_incomplete = false;
        self.events.clear();
        objects.forget_departed();
        self.frame += 1;
        self.with_rates = [0, self.with_rates[0]];
        self.eye_passes.clear();
        self.stale_tiles.swap(0, 1);
        self.stale_tiles[0].iter_mut().for_each(StaleTiles::clear);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pass_detection::{ImageDescription, ImageKey, PassFacts, Target, Transfer, TransferKind};
    use ash::vk;
    use smallvec::smallvec;

    /// Draws an eye pass in each frame that is followed, and returns the sets that the frames of a minute end with.
    fn eye_passes_of_a_minute(log: &mut Log) -> Vec<u32> {
        let (first, pass) = (image(), pass());
        let objects = Objects::default();
        let frame = |_| {
            if log.follows() {
                log.eye_passes.add(&pass, &first);
            }
            log.begin_next(&objects);
            assert_eq!(log.eye_pixels(), 64 * 64);
            log.eye_passes()
        };
        (0..5400).map(frame).collect()
    }

    fn image() -> ImageDescription {
        ImageDescription {
            key: ImageKey(1),
            extent: [64, 64],
            layers: 1,
            format: vk::Format::R8G8B8A8_SRGB,
            samples: 1,
            is_cube: false,
            swapchain: None,
        }
    }

    fn pass() -> Pass {
        Pass {
            colors: smallvec![Target { image: ImageKey(1), level: 0, base_layer: 0, layers: 1 }],
            resolves: smallvec![],
            depth: None,
            area: [0, 0, 64, 64],
            region: [0, 0, 64, 64],
            view_mask: 0,
            facts: PassFacts::default(),
            unmasked: None,
            draws: None,
        }
    }

    /// An application that draws to a window while its session shows no frames.
    #[test]
    fn frames_that_never_end_are_followed_for_a_while() {
        struct Unread;
        impl MapContent for Unread {
            fn read(&self, _: &mut dyn FnMut(crate::backend::MapSize, &[u8])) {}
        }
        let (mut log, objects, event) = (Log::default(), Objects::default(), Event::Pass(pass()));
        let candidate = Arc::new(Unread);
        for _ in 0..MOST_EVENTS {
            assert!(log.push(&objects, &event, Some(&candidate)).is_some());
        }
        assert!(log.learns());
        assert!(log.push(&objects, &event, Some(&candidate)).is_none() && !log.learns());
        log.begin_next(&objects);
        assert!(log.push(&objects, &event, Some(&candidate)).is_some() && log.learns());
    }

    /// An application that streams textures keeps the rates of its scene, but the frame is no evidence.
    #[test]
    fn passes_after_too_many_copies_are_still_recognised() {
        struct Unread;
        impl MapContent for Unread {
            fn read(&self, _: &mut dyn FnMut(crate::backend::MapSize, &[u8])) {}
        }
        let (mut log, objects) = (Log::default(), Objects::default());
        let target = |image| Target { image: ImageKey(image), level: 0, base_layer: 0, layers: 1 };
        let rect = [0, 0, 64, 64];
        let transfer = Event::Transfer(Transfer {
            kind: TransferKind::Copy,
            from: target(2),
            from_rect: rect,
            to: target(3),
            to_rect: rect,
        });
        let candidate = Arc::new(Unread);
        for _ in 0..MOST_TRANSFERS {
            assert!(log.push(&objects, &transfer, None::<&Arc<Unread>>).is_none());
        }
        assert!(log.learns());
        for _ in 0..3 * MOST_EVENTS {
            log.push(&objects, &transfer, None::<&Arc<Unread>>);
        }
        assert!(!log.learns());
        for _ in MOST_TRANSFERS..MOST_EVENTS {
            assert!(log.push(&objects, &Event::Pass(pass()), Some(&candidate)).is_some());
        }
        assert!(log.push(&objects, &Event::Pass(pass()), Some(&candidate)).is_none());
        log.begin_next(&objects);
        assert!(log.learns());
    }

    #[test]
    fn a_resting_device_has_the_eye_passes_of_its_last_sample() {
        let mut log = Log::default();
        let sets = eye_passes_of_a_minute(&mut log);
        assert!(sets[0] != 0 && sets.iter().all(|set| *set == sets[0]));
        log.set_resting(true);
        assert_eq!(eye_passes_of_a_minute(&mut log), sets);
        let followed = (0..2700).filter(|_| {
            log.begin_next(&Objects::default());
            log.follows()
        });
        assert_eq!(followed.count(), 120, "of half a minute at 90 Hz");
    }
    /// An application with too many events in every frame, and dynamic resolution.
    #[test]
    fn incomplete_frames_with_all_eye_passes_have_their_own_pixels() {
        let (mut log, objects) = (Log::default(), Objects::default());
        let image = image();
        let shadow = ImageDescription { format: vk::Format::R16_UNORM, ..image };
        let mut frame = |sizes: &[(&ImageDescription, u32)], is_complete: bool| {
            if !is_complete {
                log.miss();
            }
            for (image, size) in sizes {
                log.eye_passes.add(&Pass { region: [0, 0, *size, *size], ..pass() }, image);
            }
            log.begin_next(&objects);
            (log.eye_passes() != 0, log.eye_pixels())
        };
        assert_eq!(frame(&[(&image, 64), (&shadow, 8)], true), (true, 64 * 64));
        assert_eq!(frame(&[(&image, 48), (&shadow, 8)], false), (true, 48 * 48));
        assert_eq!(frame(&[(&shadow, 8)], false), (true, 48 * 48), "a part of them");
        assert_eq!(frame(&[], false), (true, 48 * 48));
        assert_eq!(frame(&[(&shadow, 8)], true), (true, 8 * 8));
    }

    #[test]
    fn commands_go_untracked_only_well_ahead_of_samples() {
        let objects = Objects::default();
        let mut log = Log::default();
        let minute = |log: &mut Log| {
            let count = |_| {
                let counted = (log.rests(), log.follows());
                assert_eq!(log.untracked_frames() > 0, log.rests());
                log.begin_next(&objects);
                counted
            };
            (0..5400).map(count).collect::<Vec<_>>()
        };
        assert!(minute(&mut log).iter().all(|frame| *frame == (false, true)));
        log.set_resting(true);
        let frames = minute(&mut log);
        assert_eq!(frames.iter().filter(|(rests, _)| *rests).count(), 20 * (270 - 12 - AHEAD as usize));
        for (frame, (rests, _)) in frames.iter().enumerate() {
            let submitted = frames.iter().skip(frame).take(1 + AHEAD as usize);
            assert!(!rests || submitted.into_iter().all(|(_, follows)| !follows), "frame {frame}");
        }
    }

    #[test]
    fn recognition_does_not_learn_from_a_frame_with_untracked_commands() {
        let objects = Objects::default();
        let mut log = Log::default();
        log.miss();
        assert!(log.follows() && !log.learns());
        log.begin_next(&objects);
        assert!(log.learns());
    }
}
