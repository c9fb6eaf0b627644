//! The maps that were handed over last.

use crate::link::{EyeMapRecord, PlanRecord};
use glam::Quat;
use parafovea_core::gate::Techniques;
use parafovea_core::kernels::decide::DecideParams;
use parafovea_core::plan::EyePlan;
use parafovea_core::reuse::{STALE, StaleTiles};
use std::ptr;

/// Frames after which each tile whose contrast counts was seen at full rate once.
const LOOK_EVERY: u32 = 360;

/// Coarseness that a tile can have, 64ths of an octave.
const COARSEST: u32 = 128;

/// A copy of the Vulkan half's plan.
#[derive(Debug, Default)]
pub struct UploadedPlan {
    eyes: [Map; 2],
    /// The map of an eye that is looked at.
    newest: Vec<u8>,
    is_known: bool,
}

#[derive(Debug, Default)]
struct Map {
    extent: [u32; 2],
    texel: [u32; 2],
    tiles: [u32; 2],
    bytes: Vec<u8>,
    decision: Option<Decision>,
    /// Amount by which tiles may still become coarser after the last change, 64ths of an octave.
    unsettled: u32,
}

/// The parameters of the GPU's decision on the rates of the tiles.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Decision {
    fixed: DecideParams,
    judged: Option<DecideParams>,
    orientation: Quat,
}

impl UploadedPlan {
    /// The next maps count as new, even if they are the same.
    pub fn forget(&mut self) {
        self.is_known = false;
    }

    /// Takes the maps of the plan of frame number `frame`, with the enabled techniques and, if the GPU decides rates, with the orientation of
    /// the views in the world. Returns whether they changed.
    pub fn update(
        &mut self,
        eyes: &[EyePlan; 2],
        techniques: Techniques<bool>,
        orientations: Option<[Quat; 2]>,
        frame: u64,
    ) -> bool {
        let kept = (if techniques.rates { !STALE } else { 0 }) | (if techniques.reuse { STALE } else { 0 });
        let mut is_changed = !std::mem::replace(&mut self.is_known, true);
        for (index, (map, eye)) in self.eyes.iter_mut().zip(eyes).enumerate() {
            let decision = orientations.map(|orientations| Decision::of(eye, orientations[index], frame));
            is_changed |= map.decide(decision);
            self.newest.clear();
            eye.write_map(&mut self.newest);
            self.newest.iter_mut().for_each(|tile| *tile &= kept);
            is_changed |= map.take(eye, &mut self.newest);
        }
        is_changed
    }

    /// The stale tiles of an eye.
    pub fn stale(&self, eye: usize, tiles: &mut StaleTiles) {
        let Map { extent, texel, bytes, .. } = &self.eyes[eye];
        tiles.set(*extent, *texel, bytes);
    }

    /// The maps as a record.
    pub fn record(&self, serial: u64) -> PlanRecord {
        let [left, right] = &self.eyes;
        PlanRecord { serial, eyes: [left.record(), right.record()] }
    }
}

impl Map {
    /// Takes an eye's map in place of its own, which goes to `bytes`. Whether it is another one.
    fn take(&mut self, eye: &EyePlan, bytes: &mut Vec<u8>) -> bool {
        let shape = (eye.extent, eye.texel, tiles(eye));
        let is_changed = (self.extent, self.texel, self.tiles) != shape || self.bytes != *bytes;
        (self.extent, self.texel, self.tiles) = shape;
        std::mem::swap(&mut self.bytes, bytes);
        is_changed
    }

    /// Takes the parameters of the decision on rates. Whether that can lead to other rates: where it is another, or tiles still become
    /// coarser after it was another last.
    fn decide(&mut self, decision: Option<Decision>) -> bool {
        let of = |decision: Option<Decision>| {
            decision.map(|decision| Decision {
                fixed: DecideParams { coarsening: 0, elapsed_ms: 0, ..decision.fixed },
                ..decision
            })
        };
        let step = decision.map_or(0, |decision| decision.fixed.coarsening);
        let is_other = of(self.decision) != of(decision);
        let was_unsettled = self.unsettled > 0;
        self.unsettled = if is_other { COARSEST } else { self.unsettled }.saturating_sub(step);
        self.decision = decision;
        is_other || (was_unsettled && step > 0)
    }

    fn record(&self) -> EyeMapRecord {
        let rates = if self.bytes.is_empty() { ptr::null() } else { self.bytes.as_ptr() };
        let decision = self.decision.as_ref();
        let judged = decision.and_then(|decision| decision.judged);
        EyeMapRecord {
            extent: self.extent,
            texel: self.texel,
            tiles: self.tiles,
            rates,
            is_decided: decision.is_some().into(),
            is_judged: judged.is_some().into(),
            fixed: decision.map_or_else(bytemuck::Zeroable::zeroed, |decision| decision.fixed),
            judged: judged.unwrap_or_else(bytemuck::Zeroable::zeroed),
            orientation: decision.map_or(Quat::IDENTITY, |decision| decision.orientation).into(),
        }
    }
}

impl Decision {
    fn of(eye: &EyePlan, orientation: Quat, frame: u64) -> Self {
        let judged = eye.by_contrast.map(|judged| judged.with_full_rate_period(LOOK_EVERY, frame));
        Self { fixed: eye.decision, judged, orientation }
    }
}

fn tiles(eye: &EyePlan) -> [u32; 2] {
    [eye.rates.width(), eye.rates.height()]
}
