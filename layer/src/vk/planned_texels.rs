//! The plan's rates as texels of maps. Maps of one shape share them: those of the images of a swapchain, for one. The thread that plans
//! resolves and stages them ahead of the submit that uploads them, for the shapes of the last uploads.

use super::candidates::{Parts, Texels};
use super::frame::{Frame, Plan};
use super::pre_submit::{Staging, Submitter};
use crate::gpu::GpuError;
use crate::gpu::functions::Functions;
use crate::rate_map::{DeviceRates, RateImage, refine_fresh};
use parafovea_core::rate::ShadingRate;
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
    /// All staging buffers; no copy from one is pending unless it is held elsewhere, too.
    buffers: Vec<Arc<Staging>>,
    /// Number of buffers that the thread that plans lacked: it makes no calls of Vulkan.
    lacking: usize,
    /// Number of plans that were resolved ahead.
    plans: u64,
}

/// Texels of a shape.
struct Resolved {
    shape: MapShape,
    /// [`Plan::received`] of their plan; `None` before the first.
    plan: Option<u64>,
    texels: Texels,
    /// The texels in a buffer, if they were staged.
    staged: Option<Arc<Staging>>,
    /// Whether they are staged once they are resolved.
    is_staged: bool,
    /// Number of uses, and [`State::plans`] at the last one.
    uses: u32,
    used: u64,
}

/// Shapes that are kept: two eyes, in two sizes, for two kinds of passes.
const MOST_SHAPES: usize = 8;

/// Earlier texels that are kept: those of three images of both eyes, and as many again.
const MOST_FORMER: usize = 12;

/// Staging buffers that are made ahead of their use at most; a submit makes more where it needs them.
const MOST_BUFFERS: usize = 32;

/// Uses after which a shape counts as one that returns: an area that changes with each frame does not.
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
        known.uses = known.uses.saturating_add(1);
        known.used = plans;
        let texels = Arc::clone(&known.texels);
        state.shapes[index..].rotate_left(1);
        texels
    }

    /// A buffer with texels of [`Self::of`], to be kept until no copy from it is pending; `None` if their shape was not used often.
    ///
    /// # Errors
    ///
    /// The device has no memory left.
    pub fn staged(&self, texels: &Texels, own: Submitter<'_>) -> Result<Option<Arc<Staging>>, GpuError> {
        let mut guard = self.lock();
        let state = &mut *guard;
        let returns = |known: &&mut Resolved| known.returns() && Arc::ptr_eq(&known.texels, texels);
        let Some(known) = state.shapes.iter_mut().rfind(returns) else { return Ok(None) };
        known.is_staged = true;
        if known.staged.is_none() {
            known.staged = stage(&mut state.buffers, texels);
        }
        let lacking =
            std::mem::take(&mut state.lacking).min(MOST_BUFFERS.saturating_sub(state.buffers.len()));
        for _ in 0..lacking.max(usize::from(known.staged.is_none())) {
            discard(&mut state.buffers, own.functions, |buffer| buffer.len() < texels.len());
            state.buffers.push(Arc::new(Staging::new(own, texels.len())?));
        }
        if known.staged.is_none() {
            known.staged = stage(&mut state.buffers, texels);
        }
        Ok(known.staged.clone())
    }

    /// A new plan came: resolves and stages it for the shapes of the last uploads. Makes no calls of Vulkan.
    pub fn resolve_ahead(&self, frame: &Frame, rates: &DeviceRates) {
        let (mut plan, mut state) = (frame.plan(), self.lock());
        state.plans += 1;
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
        let mut state = self.lock();
        *state = State { buffers: std::mem::take(&mut state.buffers), ..State::default() };
        discard(&mut state.buffers, functions, |_| true);
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
}

impl State {
    /// Adds a shape, in place of the one that was used longest ago, and returns its index.
    fn begin(&mut self, shape: MapShape) -> usize {
        if self.shapes.len() >= MOST_SHAPES {
            let oldest = self.shapes.remove(0);
            self.put_back(oldest.texels);
        }
        let texels = self.writable();
        let new = Resolved { shape, plan: None, texels, staged: None, is_staged: false, uses: 0, used: 0 };
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
        if known.is_staged && known.staged.is_none() {
            known.staged = stage(&mut self.buffers, &known.texels);
            self.lacking += usize::from(known.staged.is_none());
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

/// Writes texels to a buffer that is held nowhere else; `None` if no such buffer is large enough.
fn stage(buffers: &mut [Arc<Staging>], texels: &Texels) -> Option<Arc<Staging>> {
    buffers.iter_mut().find_map(|buffer| {
        let bytes = Arc::get_mut(buffer)?.bytes().get_mut(..texels.len())?;
        bytes.copy_from_slice(texels);
        Some(Arc::clone(buffer))
    })
}

/// Destroys buffers that are held nowhere else, if they are not wanted.
fn discard(buffers: &mut Vec<Arc<Staging>>, functions: &Functions, is_unwanted: impl Fn(&Staging) -> bool) {
    for index in (0..buffers.len()).rev() {
        if is_unwanted(&buffers[index]) && Arc::get_mut(&mut buffers[index]).is_some() {
            // Held nowhere else, so that it is the inner value.
            if let Some(buffer) = Arc::into_inner(buffers.swap_remove(index)) {
                buffer.destroy(&functions.device);
            }
        }
    }
}

#[cfg(test)]
mod tests;
