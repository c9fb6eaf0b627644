//! The passes of the last frames in their order: the use of a new image is seen from others of its signature.

use super::{SequenceKey, merge, sequence_key};
use crate::pass_detection::{Event, ImageDescription, ImageKey, Match, Pass, Target, Unmatched};
use ash::vk;
use rustc_hash::FxHashMap;
use std::fmt;

/// Frames that are kept: the verdict on a pass may be known one frame later, and places in the order count once two frames agree.
const KEPT: usize = 3;

/// The passes of the last frames, the newest frame first. Frames without passes do not count.
#[derive(Debug, Default)]
pub(super) struct PassHistory {
    frames: [Vec<PassRecord>; KEPT],
    /// Number of passes of each sequence in the newest frame.
    counts: FxHashMap<SequenceKey, usize>,
}

/// One pass and its verdict.
#[derive(Debug)]
struct PassRecord {
    shape: PassSignature,
    pass: Pass,
    /// Number of passes of its frame that drew its first image before.
    ordinal: usize,
    /// Whether its first image was made for this frame, or the last.
    is_young: bool,
    outcome: Outcome,
}

type Outcome = Result<Match, Unmatched>;

/// Properties that passes of one kind share from frame to frame, if nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PassSignature {
    format: vk::Format,
    extent: [u32; 2],
    samples: u32,
    layers: u32,
    base_layer: u32,
    view_mask: u32,
    colors: usize,
    has_depth: bool,
    /// Whether it is an image of an XR swapchain.
    is_shown: bool,
}

impl PassSignature {
    /// The shape of a pass, by its first target: depth where there is no colour.
    pub(super) fn new(
        pass: &Pass,
        description: impl Fn(ImageKey) -> Option<ImageDescription>,
    ) -> Option<Self> {
        let first = first_target(pass)?;
        let image = description(first.image)?;
        Some(Self {
            format: image.format,
            extent: image.extent,
            samples: image.samples,
            layers: first.layers,
            base_layer: first.base_layer,
            view_mask: pass.view_mask,
            colors: pass.colors.len(),
            has_depth: pass.depth.is_some(),
            is_shown: image.swapchain.is_some(),
        })
    }

    /// Whether `self` is `other` at another size: dynamic resolution.
    fn is_resized(&self, other: &Self) -> bool {
        let scale = [0, 1].map(|axis: usize| self.extent[axis] as f32 / other.extent[axis] as f32);
        let short = other.extent[0].min(other.extent[1]) as f32;
        // Half of a size, with either of them rounded to a multiple of 8.
        let is_half_at_least = |one: u32, other: u32| 2 * u64::from(one) + 16 >= u64::from(other);
        *self == Self { extent: self.extent, ..*other }
            && (0..2).all(|axis| is_half_at_least(self.extent[axis], other.extent[axis]))
            && (0..2).all(|axis| is_half_at_least(other.extent[axis], self.extent[axis]))
            && (scale[0] / scale[1] - 1.0).abs() * short <= 16.0
    }
}

impl fmt::Display for PassSignature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.extent;
        write!(f, "{width}x{height} {:?}", self.format)?;
        if self.colors > 1 {
            write!(f, " and {} more", self.colors - 1)?;
        }
        if self.layers > 1 {
            write!(f, ", {} layers", self.layers)?;
        }
        if self.base_layer > 0 {
            write!(f, ", layer {}", self.base_layer)?;
        }
        if self.samples > 1 {
            write!(f, ", {} samples", self.samples)?;
        }
        Ok(())
    }
}

/// The first colour target, or depth.
fn first_target(pass: &Pass) -> Option<&Target> {
    pass.colors.first().or(pass.depth.as_ref())
}

impl PassHistory {
    /// Takes the passes of a frame.
    pub(super) fn take(
        &mut self,
        events: &[Event],
        description: impl Fn(ImageKey) -> Option<ImageDescription> + Copy,
        is_young: impl Fn(ImageKey) -> bool,
    ) {
        let passes = events.iter().filter_map(|event| match event {
            Event::Pass(pass) => Some(pass),
            Event::Transfer(_) => None,
        });
        if passes.clone().next().is_none() {
            return;
        }
        self.frames.rotate_right(1);
        self.frames[0].clear();
        self.counts.clear();
        for pass in passes {
            if let Some(shape) = PassSignature::new(pass, description) {
                let image = pass.colors.first().map(|target| target.image);
                let count = self.counts.entry(sequence_key(pass)).or_default();
                let ordinal = std::mem::replace(count, *count + 1);
                let is_young = image.is_some_and(&is_young);
                let outcome = Err(Unmatched::New);
                self.frames[0].push(PassRecord { shape, pass: pass.clone(), ordinal, is_young, outcome });
            }
        }
    }

    /// Judges all passes with the knowledge of now.
    pub(super) fn judge(&mut self, judge: impl Fn(&Pass, usize) -> Outcome) {
        for role in self.frames.iter_mut().flatten() {
            role.outcome = judge(&role.pass, role.ordinal);
        }
    }

    /// The verdict on a pass of this signature in the last frames, after the passes of `earlier`; `None` where there was none.
    pub(super) fn like(
        &self,
        shape: &PassSignature,
        earlier: &[Event],
        description: impl Fn(ImageKey) -> Option<ImageDescription> + Copy,
    ) -> Option<Outcome> {
        let before = || {
            let is_same = |event: &&Event| matches!(event, Event::Pass(pass) if PassSignature::new(pass, description) == Some(*shape));
            earlier.iter().filter(is_same).count()
        };
        self.agreed(|other| other == shape, before)
            // Of another size it may be anything else just as well, unless all were the scene.
            .or_else(|| self.agreed(|other| shape.is_resized(other), before).filter(Result::is_ok))
    }

    /// The verdict on the passes of some signature, in the newest frame that leaves no doubt.
    fn agreed(
        &self,
        is_like: impl Fn(&PassSignature) -> bool,
        before: impl Fn() -> usize,
    ) -> Option<Outcome> {
        let outcomes = |frame: usize| {
            let roles = self.frames.get(frame).map_or(&[][..], Vec::as_slice);
            // Passes to lasting images are not evidence for a new image: that may belong to a mirror that did not exist before.
            let counts = |role: &&PassRecord| role.is_young || role.shape.is_shown;
            roles.iter().filter(|role| is_like(&role.shape)).filter(counts).map(|role| &role.outcome)
        };
        let mut doubtful = None;
        for frame in 0..KEPT - 1 {
            let Some(first) = outcomes(frame).next() else { continue };
            let alike = outcomes(frame).all(|outcome| outcome == first);
            let stable = outcomes(frame).eq(outcomes(frame + 1));
            if alike && (first.is_ok() || stable) {
                return Some(first.clone());
            }
            // A pass whose image was shown in a quad loses its match at once, regardless of its earlier verdict.
            if !stable && outcomes(frame).any(|outcome| *outcome == Err(Unmatched::Flat)) {
                return Some(Err(if alike { Unmatched::Flat } else { Unmatched::Ambiguous }));
            }
            if stable && let Some(outcome) = outcomes(frame).nth(before()) {
                return Some(outcome.clone());
            }
            if let Some(all) = union(outcomes(frame)) {
                return Some(Ok(all));
            }
            doubtful = Some(Err(if alike { first.clone().err()? } else { Unmatched::Ambiguous }));
        }
        doubtful
    }

    /// The match of the pass with this depth attachment, in the newest frame with one that was the scene.
    pub(super) fn scene_with_depth(&self, depth: Target) -> Option<&Match> {
        let is_like = |role: &&PassRecord| role.pass.depth == Some(depth);
        self.frames.iter().flatten().filter(is_like).find_map(|role| role.outcome.as_ref().ok())
    }

    /// The newest frame's passes.
    pub(super) fn last(&self) -> impl Iterator<Item = (&PassSignature, &Outcome)> {
        self.frames[0].iter().map(|role| (&role.shape, &role.outcome))
    }
}

/// All matches as one, where all are matches.
fn union<'a>(mut outcomes: impl Iterator<Item = &'a Outcome>) -> Option<Match> {
    let mut all = outcomes.next()?.clone().ok()?;
    for outcome in outcomes {
        let Match { parts, how } = outcome.as_ref().ok()?;
        merge(&mut all.parts, parts);
        all.how = all.how.max(*how);
    }
    Some(all)
}
