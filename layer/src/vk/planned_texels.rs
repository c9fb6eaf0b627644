//! The plan's rates as texels of maps, shared by maps of one shape, such as the images of a swapchain. The planning thread resolves and stages
//! them ahead of the submit, for the shapes of the last uploads.

use super::candidates::{Parts, Texels};
use super::frame::{Frame, Plan};
use super::pre_submit::{Staging, Submitter};
use crate::gpu::functions::Functions;
use crate::rate_map::{DeviceRates, RateImage, refine_fresh};
use parafovea_core::rate::ShadingRate;
use smallvec::SmallVec;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Conditions on the texels of a map, beside the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct MapShape {
    /// The rate image.
    pub image: RateImage,
    /// The parts of its area that show an eye.
    pub parts: Parts,
    /// Whether its passes skip stale tiles; else they shade them as coarsely as can be.
    pub skips_stale_tiles: bool,
    /// Whether nothing fills coarse tiles, which are 1x1 then.
    pub is_unfilled: bool,
}

/// The texels of the newest plan for each shape.
#[derive(Default)]
pub struct PlannedTexels {
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    /// The shapes of the last uploads, the newest last.
    shapes: Vec<Resolved>,
    /// Texels of earlier plans. Maps may still hold some of them; the others are written again.
    former: Vec<Texels>,
    /// All staging buffers.
    buffers: Vec<Buffer>,
    /// Number of buffers that the newest plan lacked ahead, and the most bytes of one.
    lacking: (usize, usize),
    /// Number of plans that were resolved ahead.
    plans: u64,
}

/// A staging buffer for queues of one family. No copy from it is pending unless it is held elsewhere, too.
struct Buffer {
    family: u32,
    staging: Arc<Staging>,
}

/// Texels of a shape.
struct Resolved {
    shape: MapShape,
    /// [`Plan::received`] of their plan; `None` before the first.
    plan: Option<u64>,
    texels: Texels,
    /// The texels in a buffer, if they were staged.
    staged: Option<Arc<Staging>>,
    /// The family of the queue that their copies were recorded for last.
    family: Option<u32>,
    /// Number of plans with uses, and [`State::plans`] at the last one.
    uses: u32,
    used: u64,
}

/// Shapes that are kept: two eyes, in two sizes, for two kinds of passes.
const MOST_SHAPES: usize = 8;

/// Earlier texels in memory: twice three images of both eyes.
const MOST_FORMER: usize = 12;

/// Most staging buffers: the copies of 24 pending submits, and as many ahead as a plan has.
const MOST_BUFFERS: usize = 32;

/// Buffers have multiples of so many bytes.
const STEP: usize = 64 * 1024;

/// Plans with uses after which a shape counts as one that returns: an area that changes with each frame does not.
const RETURNS: u32 = 3;

/// Plans since the last use after which a shape is no longer resolved ahead.
const RECENT: u64 = 2;

impl PlannedTexels {
    /// The texels of a shape from a plan.
    pub fn of(&self, shape: &MapShape, plan: &mut Plan, rates: &DeviceRates) -> Texels {
        // Maps of unknown pictures are written once, at 1x1. While an application loads they are many, and leave no place to the others.
        if shape.parts.is_empty() {
            return Arc::new(vec![ShadingRate::R1X1.texel(); shape.image.len()]);
        }
        let mut state = self.lock();
        let index = state.shapes.iter().position(|known| known.shape == *shape);
        let index = index.unwrap_or_else(|| state.begin(shape.clone()));
        state.resolve(index, plan, rates);
        let (plans, known) = (state.plans, &mut state.shapes[index]);
        let is_first = known.uses == 0 || known.used != plans;
        known.uses = known.uses.saturating_add(is_first.into());
        known.used = plans;
        let texels = Arc::clone(&known.texels);
        state.shapes[index..].rotate_left(1);
        texels
    }

    /// A buffer with texels of [`Self::of`], for a copy on a queue of that family; to be kept until the copy has finished. `None` if their
    /// shape was not used often, or if no buffer can be had.
    pub fn staged(&self, texels: &Texels, family: u32, own: Submitter<'_>) -> Option<Arc<Staging>> {
        let (missing, len, unwanted) = {
            let mut guard = self.lock();
            let state = &mut *guard;
            let known = state.shapes.iter_mut().rfind(|known| known.returns_with(texels))?;
            if known.family.replace(family) != Some(family) {
                known.staged = None;
            }
            if known.staged.is_none() {
                known.staged = stage(&mut state.buffers, family, texels);
            }
            let (lacking, longest) = std::mem::take(&mut state.lacking);
            let missing = lacking.max(known.staged.is_none().into());
            if missing == 0 {
                return known.staged.clone();
            }
            let len = longest.max(texels.len());
            let is_full = state.buffers.len() + missing > MOST_BUFFERS;
            let unwanted = if is_full { take_unheld(&mut state.buffers, len) } else { Vec::new() };
            (missing.min(MOST_BUFFERS - state.buffers.len().min(MOST_BUFFERS)), len, unwanted)
        };
        // No other thread waits for these calls down.
        unwanted.into_iter().for_each(|buffer| buffer.destroy(&own.functions.device));
        let new = || Staging::new(own, len.next_multiple_of(STEP)).ok();
        let made: SmallVec<[Staging; 2]> = (0..missing).map_while(|_| new()).collect();
        let mut guard = self.lock();
        let state = &mut *guard;
        state.buffers.extend(made.into_iter().map(|staging| Buffer { family, staging: Arc::new(staging) }));
        let known = state.shapes.iter_mut().rfind(|known| known.returns_with(texels))?;
        if known.staged.is_none() && known.family == Some(family) {
            known.staged = stage(&mut state.buffers, family, texels);
        }
        known.staged.clone().filter(|_| known.family == Some(family))
    }

    /// A new plan came: resolves and stages it for the shapes of the last uploads. Makes no calls of Vulkan.
    pub fn resolve_ahead(&self, frame: &Frame, rates: &DeviceRates) {
        let (mut plan, mut state) = (frame.plan(), self.lock());
        state.plans += 1;
        state.lacking = (0, 0);
        for index in 0..state.shapes.len() {
            let known = &state.shapes[index];
            if known.returns() && known.used + RECENT >= state.plans {
                state.resolve(index, &mut plan, rates);
                state.stage_ahead(index);
            }
        }
    }

    /// Forgets all shapes, and destroys the buffers that no copy is pending from: with the last session, or before the device is destroyed.
    pub fn forget(&self, functions: &Functions) {
        let unheld = {
            let mut state = self.lock();
            *state = State { buffers: std::mem::take(&mut state.buffers), ..State::default() };
            take_unheld(&mut state.buffers, usize::MAX)
        };
        unheld.into_iter().for_each(|buffer| buffer.destroy(&functions.device));
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Resolved {
    /// Whether its shape was used often enough to be expected again.
    fn returns(&self) -> bool {
        self.uses >= RETURNS
    }

    /// The same, and whether these are its texels.
    fn returns_with(&self, texels: &Texels) -> bool {
        self.returns() && Arc::ptr_eq(&self.texels, texels)
    }
}

impl State {
    /// Adds a shape, in place of the one that was used longest ago, and returns its index.
    fn begin(&mut self, shape: MapShape) -> usize {
        if self.shapes.len() >= MOST_SHAPES {
            let oldest = self.shapes.remove(0);
            self.put_back(oldest.texels);
        }
        let texels = self.writable();
        let new = Resolved { shape, plan: None, texels, staged: None, family: None, uses: 0, used: 0 };
        self.shapes.push(new);
        self.shapes.len() - 1
    }

    /// Resolves a plan for a shape, if it is another one than its texels'. Texels that do not change stay the same object.
    fn resolve(&mut self, index: usize, plan: &mut Plan, rates: &DeviceRates) {
        if self.shapes[index].plan == Some(plan.received()) {
            return;
        }
        let mut newest = self.writable();
        let known = &mut self.shapes[index];
        let is_first = known.plan.replace(plan.received()).is_none();
        let MapShape { image, parts, skips_stale_tiles, is_unfilled } = &known.shape;
        let texels = Arc::make_mut(&mut newest);
        plan.resolve(parts, image, rates, texels);
        if !skips_stale_tiles && plan.has_stale_tiles() {
            rates.coarsen_stale(texels);
        }
        if *is_unfilled {
            refine_fresh(texels);
        }
        if is_first || newest != known.texels {
            std::mem::swap(&mut newest, &mut known.texels);
            known.staged = None;
        }
        self.put_back(newest);
    }

    /// Stages the texels of a shape whose texels were staged before, if a buffer is free.
    fn stage_ahead(&mut self, index: usize) {
        let known = &mut self.shapes[index];
        let Some(family) = known.family.filter(|_| known.staged.is_none()) else { return };
        known.staged = stage(&mut self.buffers, family, &known.texels);
        if known.staged.is_none() {
            let (lacking, longest) = self.lacking;
            self.lacking = (lacking + 1, longest.max(known.texels.len()));
        }
    }

    /// Texels that no map holds.
    fn writable(&mut self) -> Texels {
        let free = self.former.iter_mut().position(|texels| Arc::get_mut(texels).is_some());
        free.map_or_else(Texels::default, |index| self.former.swap_remove(index))
    }

    fn put_back(&mut self, texels: Texels) {
        if self.former.len() >= MOST_FORMER {
            self.former.remove(0);
        }
        self.former.push(texels);
    }
}

/// Writes texels to a buffer of a family that is held nowhere else; `None` if no such buffer is large enough.
fn stage(buffers: &mut [Buffer], family: u32, texels: &Texels) -> Option<Arc<Staging>> {
    buffers.iter_mut().filter(|buffer| buffer.family == family).find_map(|Buffer { staging, .. }| {
        let bytes = Arc::get_mut(staging)?.bytes().get_mut(..texels.len())?;
        bytes.copy_from_slice(texels);
        Some(Arc::clone(staging))
    })
}

/// Takes out the buffers with less than `len` bytes that are held nowhere else.
fn take_unheld(buffers: &mut Vec<Buffer>, len: usize) -> Vec<Staging> {
    let is_unheld =
        |buffer: &mut Buffer| buffer.staging.len() < len && Arc::get_mut(&mut buffer.staging).is_some();
    buffers.extract_if(.., is_unheld).filter_map(|buffer| Arc::into_inner(buffer.staging)).collect()
}

#[cfg(test)]
mod tests;
