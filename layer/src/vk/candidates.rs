//! Targets of passes that may be the scene: colour targets, each with a map of rates.
//!
//! Every texel is 1x1 until the pass is recognised, and resolved from the newest plan after that.

mod content;

pub use content::{Content, Need, Parts};

use super::frame::MapContent;
use super::objects::Objects;
use super::perception::ResolvedMap;
use super::table::Table;
use crate::backend::mask::TargetMask;
use crate::backend::{Backend, MapSize, RateMap};
use crate::pass_detection::{ImageKey, Pass, Target};
use std::any::Any;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The candidates of a device.
#[derive(Default)]
pub struct Candidates {
    live: Table<Target, Arc<Candidate>>,
}

/// A colour target that may be the scene.
pub struct Candidate {
    /// The first colour target of its passes.
    pub target: Target,
    /// Its map on the GPU.
    pub map: Box<dyn RateMap>,
    content: Mutex<Content>,
    resolved: Mutex<Option<ResolvedMap>>,
}

impl Candidate {
    fn new(target: Target, map: Box<dyn RateMap>) -> Arc<Self> {
        let content = if map.has_content() { Content::initialised() } else { Content::default() };
        Arc::new(Self { target, map, content: Mutex::new(content), resolved: Mutex::default() })
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
        if let Some(known) = self.live.get(target) {
            return Some(known);
        }
        let image = objects.image_of(target.image)?;
        let map = backend.map(pass, &image)?;
        Some(self.live.get_or_insert(target, Candidate::new(target, map)))
    }

    /// The candidate of a target whose map is at hand.
    pub fn with_map<M: RateMap + 'static>(&self, target: Target, map: M) -> Arc<Candidate> {
        if let Some(known) = self.live.get(target) {
            return known;
        }
        self.live.get_or_insert(target, Candidate::new(target, Box::new(map)))
    }

    /// The candidate of a target, if passes drew to it before.
    pub fn known(&self, target: Target) -> Option<Arc<Candidate>> {
        self.live.get(target)
    }

    /// Forgets candidates of an image that is about to be destroyed: the GPU is done with passes that draw to it.
    pub fn forget(&self, image: ImageKey) {
        drop(self.live.remove_where(|target, _| target.image == image));
    }

    /// Forgets all, before the device is destroyed.
    pub fn clear(&self) {
        drop(self.live.remove_where(|_, _| true));
    }
}
