//! Temporal feedback: eye buffers that passes of a later frame read, as temporal filters read their history.
//!
//! Re-use completes the displayed image, and never the images before it: a stale tile, left out or at the coarsest rate, stays so in a history, and
//! returns from there in every later frame.

use super::HOLD;
use super::memory::Memory;
use super::projected::Swapchains;
use super::provenance::{Findings, Provenance, Role};
use crate::pass_detection::{Event, ImageKey, Pass, Shown, SwapchainKey, Transfer};
use smallvec::SmallVec;
use std::fmt;

/// Use of earlier frames' images in the displayed image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Feedback {
    /// It is made of this frame's passes.
    #[default]
    None,
    /// It was drawn, or made of a scene that was drawn, before the last xrEndFrame: its stale tiles are not known with its picture.
    Ahead,
    /// A pass before it may read anything.
    Unknown,
    /// A pass before it reads a picture of an earlier frame.
    Read,
}

impl Feedback {
    /// Its number in [`crate::link::FrameReportRecord::feedback`].
    pub fn number(self) -> u32 {
        match self {
            Self::None => 0,
            Self::Unknown => 1,
            Self::Read => 2,
            Self::Ahead => 3,
        }
    }

    /// That of a number; [`Self::Unknown`] for one that nothing has.
    pub fn from_number(number: u32) -> Self {
        match number {
            0 => Self::None,
            2 => Self::Read,
            3 => Self::Ahead,
            _ => Self::Unknown,
        }
    }

    /// Whether parts of the scene may be left out until their turn comes.
    pub fn allows_reuse(self) -> bool {
        self == Self::None
    }
}

impl fmt::Display for Feedback {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "re-use: no pass reads images of earlier frames",
            Self::Ahead => "re-use: off, because the scene is drawn before the frame that shows it",
            Self::Unknown => "re-use: off, because a pass after the scene may read images of earlier frames",
            Self::Read => {
                "re-use: off, because a pass reads images of earlier frames, as temporal filters do"
            }
        })
    }
}

/// The use of pictures of earlier frames, by all frames so far.
#[derive(Debug, Default)]
pub(super) struct FeedbackEvidence {
    ahead_at: Option<u64>,
    unknown_at: Option<u64>,
    read_at: Option<u64>,
    /// Swapchains of eyes in the last frame, and their shown images; empty if that frame is not known.
    last_shown: SmallVec<[(SwapchainKey, ImageKey); 4]>,
}

impl FeedbackEvidence {
    /// The finding of the last frames.
    pub(super) fn newest(&self, frame: u64) -> Feedback {
        let is_held = |at: Option<u64>| at.is_some_and(|at| frame < at + HOLD);
        match () {
            () if is_held(self.read_at) => Feedback::Read,
            () if is_held(self.unknown_at) => Feedback::Unknown,
            () if is_held(self.ahead_at) => Feedback::Ahead,
            () => Feedback::None,
        }
    }

    /// Frames have passed that nothing is known of.
    pub(super) fn miss(&mut self) {
        self.last_shown.clear();
    }

    /// Forgets the last image of a swapchain that is gone.
    pub(super) fn forget_swapchain(&mut self, swapchain: SwapchainKey) {
        self.last_shown.retain(|(known, _)| *known != swapchain);
    }

    /// Takes a frame, whose passes have their roles, and its submission.
    pub(super) fn learn(
        &mut self,
        frame: u64,
        events: &[Event],
        (provenance, told): (&Provenance, Findings),
        (memory, swapchains): (&mut Memory, &Swapchains),
        shown: &Shown,
    ) {
        let least = swapchains.least_picture();
        let reads_unknown = told.unknown_reader.is_some_and(|reader| !copies_drawn(events, reader, memory));
        if reads_unknown || told.is_too_long {
            self.unknown_at = Some(frame);
        }
        let mut reads = told.has_feedback;
        let mut is_drawn_ahead = false;
        for (index, event) in events.iter().enumerate() {
            match event {
                Event::Pass(pass) => {
                    let role = provenance.role(index);
                    let is_on_the_way = matches!(role, Role::Eye | Role::FullScreen);
                    let picture_of = |image: ImageKey| {
                        let extent = memory.description(image).map_or([0; 2], |image| image.extent);
                        memory.eye_picture(image).filter(|_| is_picture(extent, least))
                    };
                    let is_earlier =
                        |image| picture_of(image).is_some_and(|kept| kept.is_earlier(frame, index));
                    let is_ahead = |image| picture_of(image).is_some_and(|kept| kept.is_ahead(frame, index));
                    // An input attachment that the pass writes is this frame's.
                    let is_own = |image: ImageKey| pass.colors.iter().any(|target| target.image == image);
                    reads |=
                        is_on_the_way && images_read(pass).any(|image| !is_own(image) && is_earlier(image));
                    is_drawn_ahead |= is_on_the_way && images_read(pass).any(is_ahead);
                    let picture = is_on_the_way.then_some(EyePicture {
                        frame,
                        index,
                        is_passed_on: role == Role::FullScreen,
                    });
                    for target in pass.colors.iter().chain(&pass.resolves) {
                        memory.set_eye_picture(target.image, picture);
                    }
                }
                Event::Transfer(transfer) => {
                    // An earlier picture has other stale tiles than this frame's passes.
                    let is_earlier =
                        || memory.eye_picture(transfer.from.image).is_some_and(|kept| kept.frame < frame);
                    is_drawn_ahead |= shows_picture(transfer, memory, swapchains) && is_earlier();
                    let from = memory.eye_picture(transfer.from.image).filter(|from| from.frame == frame);
                    let picture = from.map(|_| EyePicture { frame, index, is_passed_on: true });
                    memory.set_eye_picture(transfer.to.image, picture);
                }
            }
        }
        is_drawn_ahead |= self.shows_earlier(frame, memory, shown);
        if reads {
            self.read_at = Some(frame);
        }
        if is_drawn_ahead {
            self.ahead_at = Some(frame);
        }
    }

    /// Takes the images that a frame shows. Returns whether one of them is new, and was drawn in an earlier frame.
    fn shows_earlier(&mut self, frame: u64, memory: &Memory, shown: &Shown) -> bool {
        let of_eyes = || {
            let views = shown.views.iter().filter(|view| view.eye.is_some());
            views.filter_map(|view| Some((view.swapchain, view.image?)))
        };
        let is_new = |(swapchain, image): &(SwapchainKey, ImageKey)| {
            let mut last = self.last_shown.iter();
            last.any(|(known, before)| known == swapchain && before != image)
        };
        let is_earlier =
            |(_, image): (_, ImageKey)| memory.eye_picture(image).is_some_and(|kept| kept.frame < frame);
        let shows_earlier = of_eyes().filter(is_new).any(is_earlier);
        self.last_shown.clear();
        self.last_shown.extend(of_eyes());
        shows_earlier
    }
}

/// Whether a transfer makes an eye buffer in a swapchain, and not a small part of one.
fn shows_picture(transfer: &Transfer, memory: &Memory, swapchains: &Swapchains) -> bool {
    let swapchain = memory.description(transfer.to.image).and_then(|to| to.swapchain);
    let extent = [transfer.to_rect[2].unsigned_abs(), transfer.to_rect[3].unsigned_abs()];
    swapchain.is_some_and(|key| swapchains.shows_eyes(key, &transfer.to))
        && is_picture(extent, swapchains.least_picture())
}

/// Least side of an image that keeps a picture, in sides of the picture that is shown: exposure and the like are smaller, and forget.
const LEAST_SIDE: f32 = 0.25;

/// Whether an image, or a render area, of this size may hold a picture of the size `least`.
pub(super) fn is_picture(extent: [u32; 2], least: [f32; 2]) -> bool {
    (0..2).all(|axis| extent[axis] as f32 >= LEAST_SIDE * least[axis])
}

/// The last time that an image became an eye buffer, or a stage of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct EyePicture {
    /// Number of the frame.
    frame: u64,
    /// Index of the event in that frame.
    index: usize,
    /// Whether by a copy or a full-screen pass, and not by a pass that shades.
    is_passed_on: bool,
}

impl EyePicture {
    /// Whether it is an earlier picture to event number `reader` of a frame. The scene of [`Self::is_ahead`] is none.
    fn is_earlier(&self, frame: u64, reader: usize) -> bool {
        self.frame < frame && !self.is_ahead(frame, reader)
    }

    /// Whether it is a scene that a thread of its own submits before the last xrEndFrame: it was drawn after the same reader of the frame
    /// before.
    fn is_ahead(&self, frame: u64, reader: usize) -> bool {
        self.frame + 1 == frame && !self.is_passed_on && self.index > reader
    }
}

/// Whether an event copies content that earlier transfers of the frame copied from an image drawn by a pass, as far as is known.
fn copies_drawn(events: &[Event], index: usize, memory: &Memory) -> bool {
    let Some(Event::Transfer(last)) = events.get(index) else { return false };
    let mut image = last.from.image;
    for event in events[..index].iter().rev() {
        match event {
            Event::Transfer(earlier) if earlier.to.image == image => image = earlier.from.image,
            Event::Transfer(_) | Event::Pass(_) => {}
        }
    }
    memory.is_drawn(image)
}

/// Attachments that draws of a pass may read, as far as these are known.
pub(super) fn images_read(pass: &Pass) -> impl Iterator<Item = ImageKey> + '_ {
    let draws = pass.draws.iter();
    draws.flat_map(|draws| draws.read_by_quads.images.iter().chain(&draws.read_by_meshes.images)).copied()
}
