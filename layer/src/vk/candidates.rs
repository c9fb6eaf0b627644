//! Targets of passes that may be the scene: colour targets, each with a map of rates.
//!
//! Every texel is 1x1 until the pass is recognised, and resolved from the newest plan after that.

mod content;

pub use content::{Content, Need, Parts, Texels};

use super::frame::MapContent;
use super::objects::Objects;
use super::perception::ResolvedMap;
use super::table::Table;
use crate::backend::attachment::image::RateImage;
use crate::backend::mask::TargetMask;
use crate::backend::{Backend, MapSize, RateMap};
use crate::pass_detection::{ImageKey, Pass, Target};
use std::any::Any;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The candidates of a device.
#[derive(Default)]
pub struct Candidates {
    live: Table<(Target, Depth), Arc<Candidate>>,
}

/// The passes of a target that share a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Depth {
    /// Passes with depth, and passes without: a mask in depth is filled ahead of passes without.
    Any,
    /// Either passes with depth or passes without: both kinds have a rate image of their own.
    Is(bool),
}

/// A colour target that may be the scene.
pub struct Candidate {
    /// The first colour target of its passes.
    pub target: Target,
    depth: Depth,
    /// Its map on the GPU.
    pub map: Box<dyn RateMap>,
    /// Whether passes read its map; a rate image may wait for its target to be recognised.
    is_read: AtomicBool,
    content: Mutex<Content>,
    resolved: Mutex<Option<ResolvedMap>>,
}

impl Candidate {
    fn new((target, depth): (Target, Depth), map: Box<dyn RateMap>) -> Arc<Self> {
        let content = if map.has_content() { Content::initialised() } else { Content::default() };
        let is_read = AtomicBool::new(depth == Depth::Any);
        let content = Mutex::new(content);
        Arc::new(Self { target, depth, map, is_read, content, resolved: Mutex::default() })
    }

    /// Work to do on its map before a submit, which is from plan number `plan`: a map that no pass reads needs no content.
    pub fn need(&self, plan: u64) -> Need {
        match self.content().need(plan) {
            Need::Initialise if !self.is_read.load(Ordering::Relaxed) => Need::None,
            need => need,
        }
    }

    /// Whether a pass obeys its map.
    pub fn is_of(&self, pass: &Pass) -> bool {
        let has_depth = match self.depth {
            Depth::Any => pass.depth.is_some(),
            Depth::Is(has_depth) => has_depth,
        };
        pass.colors.first() == Some(&self.target) && pass.depth.is_some() == has_depth
    }

    /// Its map as a mask; `None` on devices with rate attachments.
    pub fn mask(&self) -> Option<&TargetMask> {
        let map: &dyn Any = self.map.as_ref();
        map.downcast_ref()
    }

    /// The content of its map, present and wanted.
    pub fn content(&self) -> MutexGuard<'_, Content> {
        self.content.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes the objects that resolve its map on the GPU, so that no lock is held meanwhile; [`Self::keep_resolved`] puts them back.
    pub fn take_resolved(&self) -> Option<ResolvedMap> {
        self.resolved.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Keeps the objects that resolve its map.
    pub fn keep_resolved(&self, resolved: Option<ResolvedMap>) {
        *self.resolved.lock().unwrap_or_else(PoisonError::into_inner) = resolved;
    }
}

impl MapContent for Candidate {
    fn read(&self, act: &mut dyn FnMut(MapSize, &[u8])) {
        act(self.map.size(), self.content().texels());
    }
}

impl Candidates {
    /// The candidate that a pass draws to, if it draws colour and can be made coarser.
    pub fn of(&self, backend: &dyn Backend, objects: &Objects, pass: &Pass) -> Option<Arc<Candidate>> {
        let target = *pass.colors.first()?;
        if let Some(known) = self.known(target) {
            return Some(known);
        }
        let image = objects.image_of(target.image)?;
        let map = backend.map(pass, &image)?;
        let key = (target, Depth::Any);
        Some(self.live.get_or_insert(key, Candidate::new(key, map)))
    }

    /// The candidate of a rate image of a pass, to which it `is_attached`, or will be once its target is recognised.
    pub fn with_rate_image(&self, image: Arc<RateImage>, is_attached: bool) -> Arc<Candidate> {
        let key = (image.key.target, Depth::Is(image.key.has_depth));
        let new = || self.live.get_or_insert(key, Candidate::new(key, Box::new(image)));
        let candidate = self.live.get(key).unwrap_or_else(new);
        if is_attached {
            candidate.is_read.store(true, Ordering::Relaxed);
        }
        candidate
    }

    /// The candidate of a target whose map is at hand.
    #[cfg(test)]
    pub fn with_map<M: RateMap + 'static>(&self, target: Target, map: M) -> Arc<Candidate> {
        let key = (target, Depth::Any);
        self.live.get_or_insert(key, Candidate::new(key, Box::new(map)))
    }

    /// The candidate of a target with a mask, if passes drew to it before.
    pub fn known(&self, target: Target) -> Option<Arc<Candidate>> {
        self.live.get((target, Depth::Any))
    }

    /// Forgets candidates of an image that is about to be destroyed: the GPU is done with passes that draw to it.
    pub fn forget(&self, image: ImageKey) {
        drop(self.live.remove_where(|(target, _), _| target.image == image));
    }

    /// Drops the fills of an image that is about to be destroyed, in the masks of other images.
    pub fn forget_fills(&self, image: ImageKey) {
        let live = self.live.all();
        live.iter().filter_map(|candidate| candidate.mask()).for_each(|mask| mask.forget_image(image));
    }

    /// Forgets all, before the device is destroyed.
    pub fn clear(&self) {
        drop(self.live.remove_where(|_, _| true));
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::backend::Upload;

    /// A map without content.
    pub struct NoMap;

    impl RateMap for NoMap {
        fn size(&self) -> MapSize {
            MapSize { texel: [16, 16], tiles: [1, 1], layers: 1 }
        }

        unsafe fn record_upload(&self, _: Upload) {}
    }

    /// On RDNA2 the rate image of a pass that is not recognised is not attached: an upload would be a submit for nothing.
    #[test]
    fn a_map_without_readers_needs_no_content() {
        let target = Target { image: ImageKey(1), level: 0, base_layer: 0, layers: 1 };
        let waiting = Candidate::new((target, Depth::Is(true)), Box::new(NoMap));
        assert_eq!(waiting.need(1), Need::None);
        waiting.is_read.store(true, Ordering::Relaxed);
        assert_eq!(waiting.need(1), Need::Initialise);
        assert_eq!(Candidate::new((target, Depth::Any), Box::new(NoMap)).need(1), Need::Initialise);
    }
}
