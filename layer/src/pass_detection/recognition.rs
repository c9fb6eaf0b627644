//! Recognition: from events and submissions of earlier frames, the passes that are the scene, and their eyes.
//!
//! Findings are kept by image and by XR swapchain, not by frame, because the passes of a frame may be submitted before or after another
//! frame's xrEndFrame. Images that are created in every frame are known by their shape and their place among the passes of that shape.

mod candidate;
mod computed;
mod feedback;
mod listing;
mod memory;
mod pass_history;
mod placement;
mod profile;
mod projected;
mod provenance;
mod repetition;
mod roles;
mod trace;

use super::{Event, How, ImageDescription, ImageKey, Match, Part, Pass, Shown, SwapchainKey, Unmatched};
use crate::status::Topic;
pub use candidate::holds_colours;
use computed::ComputedPictures;
pub use feedback::Feedback;
use feedback::FeedbackEvidence;
use listing::Listing;
use memory::Memory;
use parafovea_manifest::options::PassRules;
use pass_history::{PassHistory, PassSignature};
use projected::Swapchains;
use provenance::{Known, Provenance, Role};
use repetition::Repetition;
use smallvec::SmallVec;
use std::fmt;

/// Recognises the passes of one device.
#[derive(Debug, Default)]
pub struct Recognition {
    /// Number of the last frame, from 1.
    frame: u64,
    memory: Memory,
    swapchains: Swapchains,
    pass_history: PassHistory,
    listing: Listing,
    provenance: Provenance,
    /// Number of the last frame in which cameras were found that the picture comes from.
    found_at: Option<u64>,
    /// Number of cameras that the last unknown reader may have read, and the first frame with this number.
    candidates: (usize, u64),
    feedback: FeedbackEvidence,
    /// Number of the last frame in which the picture was drawn without passes before it.
    drawn_directly_at: Option<u64>,
    computed: ComputedPictures,
    rules: PassRules,
    repetition: Repetition,
}

/// By this frame recognition has settled; before it nothing is listed.
const SETTLED: u64 = 5;

/// Number of frames after which an image that was drawn directly or shown flat no longer counts as such.
const HOLD: u64 = 120;

/// Number of consecutive frames with an equal count of cameras for an unknown reader, after which a single camera counts as the scene: a mirror
/// may be drawn in every second or third frame.
const STEADY: u64 = 3;

impl Recognition {
    /// Learns from a frame: its submitted events, and its submission. With several sessions on a device, each xrEndFrame is a frame of its
    /// own. Most repeated frames ([`Repetition`]) are left out, and do not count; returns whether it learned.
    ///
    /// `describe` knows the images that occur in `events`, including images destroyed since.
    pub fn frame(
        &mut self,
        events: &[Event],
        describe: impl Fn(ImageKey) -> Option<ImageDescription>,
        shown: &Shown,
    ) -> bool {
        if self.repetition.may_leave_out(events, shown) {
            self.miss();
            return false;
        }
        self.frame += 1;
        self.memory.meet(self.frame, events, shown, describe);
        self.swapchains.show(self.frame, shown, &mut self.memory);
        trace::transfers(self.frame, events, &self.swapchains, &mut self.memory);
        self.computed.take(events, shown, (&self.swapchains, &self.memory));
        self.find_candidates(events, shown);
        if !shown.views.is_empty() {
            self.memory.count_misses(self.frame);
        }
        let mut cast = std::mem::take(&mut self.pass_history);
        let is_young = |image| self.memory.is_young(self.frame, image);
        cast.take(events, |image| self.memory.description(image), is_young);
        cast.judge(|pass, ordinal| self.by_image(pass, || ordinal, |image| self.memory.description(image)));
        self.pass_history = cast;
        self.memory.forget(self.frame);
        self.swapchains.forget(self.frame);
        true
    }

    /// A swapchain is gone. A later one may have its handle.
    pub fn forget_swapchain(&mut self, swapchain: SwapchainKey) {
        self.swapchains.forget_one(swapchain);
        self.memory.forget_swapchain(swapchain);
        self.feedback.forget_swapchain(swapchain);
    }

    /// Frames have ended that it does not learn from.
    pub fn miss(&mut self) {
        self.feedback.miss();
    }

    /// The verdict on `pass`, which is about to be submitted after `earlier`, the passes and transfers since the last [`Self::frame`].
    ///
    /// # Errors
    ///
    /// Reason why it is not the scene.
    pub fn of(
        &self,
        pass: &Pass,
        earlier: &[Event],
        describe: impl Fn(ImageKey) -> Option<ImageDescription>,
    ) -> Result<Match, Unmatched> {
        let description = |image| self.memory.description(image).or_else(|| describe(image));
        let judged = match self.by_image(pass, || ordinal(pass, earlier), description) {
            Err(unsettled) if self.is_young(pass, unsettled) => {
                let shape = PassSignature::new(pass, description).ok_or(Unmatched::UnknownImage)?;
                self.pass_history.like(&shape, earlier, description).unwrap_or(Err(unsettled))
            }
            judged => judged,
        };
        self.by_rules(pass, earlier, description, judged)
    }

    /// Takes the profile's rules, which hold from now on.
    pub fn set_rules(&mut self, rules: PassRules) {
        self.rules = rules;
        self.repetition = Repetition::default();
    }

    /// The scene pass of a depth pre-pass: both draw depth into one image, by the evidence of the last frames. `None` for other passes.
    pub fn depth_of(&self, pass: &Pass) -> Option<&Match> {
        let depth = pass.depth.filter(|_| pass.colors.is_empty())?;
        self.pass_history.scene_with_depth(depth)
    }

    /// Use of earlier frames' images in an eye buffer, by the evidence of the last frames.
    pub fn feedback(&self) -> Feedback {
        self.feedback.newest(self.frame)
    }

    /// Logs new verdicts of the listing of passes: a line for each kind of pass with a first or another verdict.
    pub fn log_new_verdicts(&mut self, log: impl FnMut(Topic, &dyn fmt::Display)) {
        if self.frame >= SETTLED {
            self.listing.log_new_verdicts(self.pass_history.last(), log);
        }
    }

    /// The verdict by the images of a pass. `ordinal`: number of earlier passes of the frame to its first image, with depth if this pass has depth,
    /// else without.
    fn by_image(
        &self,
        pass: &Pass,
        ordinal: impl FnOnce() -> usize,
        description: impl Fn(ImageKey) -> Option<ImageDescription>,
    ) -> Result<Match, Unmatched> {
        let first = pass.colors.first().ok_or(Unmatched::NoColour)?;
        let described = description(first.image).ok_or(Unmatched::UnknownImage)?;
        let role = self.memory.role(self.frame, &described, pass.depth.is_some(), ordinal);
        let mut parts = Parts::new();
        let mut how = None;
        let mut reason = None;
        for target in pass.colors.iter().chain(&pass.resolves) {
            let described = description(target.image).ok_or(Unmatched::UnknownImage)?;
            if described.is_cube {
                return Err(Unmatched::Cube);
            }
            if target.level != 0 {
                return Err(Unmatched::Level(target.level));
            }
            let shown = self.swapchains.shown_of(Some(described));
            let found = match shown {
                Some(swapchain) => self.swapchains.parts(self.frame, swapchain, target, pass.area),
                // It may be shown at the end of the frame.
                None if described.swapchain.is_some() && self.memory.is_young(self.frame, target.image) => {
                    Err(Unmatched::NotShown)
                }
                None => self.memory.parts(self.frame, target, pass.area),
            };
            match found {
                Err(Unmatched::Flat) => return Err(Unmatched::Flat),
                Err(Unmatched::New) => {}
                Err(other) => reason = reason.or(Some(other)),
                Ok(found) => {
                    let by = if shown.is_some() { How::Swapchain } else { How::Transferred };
                    how = Some(how.map_or(by, |how: How| how.min(by)));
                    merge(&mut parts, &found);
                }
            }
        }
        match (how, reason) {
            (Some(_), Some(Unmatched::Unsteady)) => Err(Unmatched::Unsteady),
            (Some(_), _) if role == Role::FullScreen => Err(Unmatched::FullScreen),
            (Some(How::Transferred), _) if role == Role::Texture => Err(Unmatched::Texture),
            (Some(_), _) if parts.len() > MOST_PARTS => Err(Unmatched::Ambiguous),
            (Some(how), _) => Ok(Match { parts, how }),
            (None, Some(reason)) => Err(reason),
            (None, None) => self.by_looks(pass, role, description),
        }
    }

    /// The verdict by size and format, and by the role of the content in earlier frames.
    fn by_looks(
        &self,
        pass: &Pass,
        role: Role,
        description: impl Fn(ImageKey) -> Option<ImageDescription>,
    ) -> Result<Match, Unmatched> {
        // The role of an eye that is too small to be one by its looks is proven.
        let least = if role == Role::Eye { candidate::LEAST_PROVEN } else { candidate::LEAST };
        let parts = candidate::looks(pass, description, &self.swapchains, least)?;
        match role {
            Role::Eye if pass.colors.iter().any(|target| self.memory.precedes(target.image)) => {
                return Ok(Match { parts, how: How::Shape });
            }
            Role::FullScreen => return Err(Unmatched::FullScreen),
            Role::Texture => return Err(Unmatched::Texture),
            Role::Ambiguous => return Err(Unmatched::Ambiguous),
            Role::Eye | Role::Unknown => {}
        }
        let directly = self.drawn_directly_at.is_some_and(|at| self.frame < at + HOLD);
        Err(match pass.colors.iter().all(|target| self.memory.is_known(target.image)) {
            false => Unmatched::New,
            true if directly => Unmatched::DrawnDirectly,
            true => Unmatched::After,
        })
    }

    /// Works out where the picture comes from, and remembers it by image.
    fn find_candidates(&mut self, events: &[Event], shown: &Shown) {
        let known = Known {
            frame: self.frame,
            memory: &self.memory,
            swapchains: &self.swapchains,
            are_pictures_computed: self.computed.are_found(),
        };
        let mut told = self.provenance.learn(events, &known, false);
        // Long without a camera before the reader: it reads passes from before the last xrEndFrame, submitted on a thread of their own.
        let was_found = self.found_at.is_some_and(|at| self.frame < at + HOLD);
        if told.unknown_reader.is_some() && !told.is_found && !was_found {
            told = self.provenance.learn(events, &known, true);
        } else if told.is_found {
            self.found_at = Some(self.frame);
        }
        if told.candidates > 0 && told.candidates != self.candidates.0 {
            self.candidates = (told.candidates, self.frame);
        }
        let is_unsure = told.unknown_reader.is_some() && self.frame < self.candidates.1 + STEADY;
        let known = (&mut self.memory, &self.swapchains);
        self.feedback.learn(self.frame, events, (&self.provenance, told), known, shown);
        if told.is_direct {
            self.drawn_directly_at = Some(self.frame);
        }
        for (index, event) in events.iter().enumerate() {
            let Event::Pass(pass) = event else { continue };
            let Some(first) = pass.colors.first() else { continue };
            let role = match self.provenance.role(index) {
                Role::Eye if is_unsure => Role::Unknown,
                role => role,
            };
            if told.is_found || told.is_direct {
                self.memory.add_role(self.frame, first.image, pass.depth.is_some(), role);
            }
            if role == Role::Eye {
                for target in &pass.colors {
                    self.memory.set_precedes(self.frame, target.image);
                }
            }
        }
    }

    /// Whether an image of the pass is too new to be judged by its own properties rather than by images of the same shape.
    fn is_young(&self, pass: &Pass, reason: Unmatched) -> bool {
        let by_looks = matches!(
            reason,
            Unmatched::New
                | Unmatched::After
                | Unmatched::DrawnDirectly
                | Unmatched::Viewport
                | Unmatched::Small
                | Unmatched::Large
                | Unmatched::Aspect
                | Unmatched::Layers(_)
                | Unmatched::Format(_)
        );
        by_looks && pass.colors.iter().any(|target| self.memory.is_young(self.frame, target.image))
    }

    fn by_rules(
        &self,
        pass: &Pass,
        earlier: &[Event],
        description: impl Fn(ImageKey) -> Option<ImageDescription> + Copy,
        judged: Result<Match, Unmatched>,
    ) -> Result<Match, Unmatched> {
        // A pass that can never draw the scene does not match because of a rule either.
        let never = matches!(
            judged,
            Err(Unmatched::NoColour
                | Unmatched::Cube
                | Unmatched::Level(_)
                | Unmatched::Flat
                | Unmatched::UnknownImage)
        );
        if never {
            return judged;
        }
        match profile::judge(&self.rules, pass, earlier, description) {
            None => judged,
            Some(ruled) => ruled.map(|parts| Match { parts, how: How::Profile }),
        }
    }
}

/// Number of passes before `pass` that draw its first image, with depth if it has depth, else without.
fn ordinal(pass: &Pass, earlier: &[Event]) -> usize {
    let key = sequence_key(pass);
    let is_before = |event: &&Event| matches!(event, Event::Pass(other) if sequence_key(other) == key);
    earlier.iter().filter(is_before).count()
}

/// The first image of a pass, and whether it has depth: the order of passes with the same key distinguishes them.
type SequenceKey = (Option<ImageKey>, bool);

fn sequence_key(pass: &Pass) -> SequenceKey {
    (pass.colors.first().map(|target| target.image), pass.depth.is_some())
}

type Parts = SmallVec<[Part; 4]>;

/// More parts than the eyes of one picture have: no longer one thing.
const MOST_PARTS: usize = 8;

/// Adds the parts of `more` that `parts` lacks.
fn merge(parts: &mut Parts, more: &[Part]) {
    for part in more {
        if !parts.contains(part) {
            parts.push(*part);
        }
    }
}

#[cfg(test)]
mod tests;
