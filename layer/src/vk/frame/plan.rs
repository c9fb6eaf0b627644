//! The newest plan.

use crate::link::{EyeMapRecord, PlanRecord};
use crate::pass_detection::Part;
use crate::rate_map::{DeviceRates, EyeMap, RateImage, Scratch, rate_map_table, resolve};
use glam::Quat;
use parafovea_core::kernels::decide::DecideParams;
use parafovea_core::kernels::resolve::RateMapTable;
use parafovea_core::reuse::StaleTiles;

/// The newest plan; before the first, number 0 with all at 1x1.
#[derive(Debug, Default)]
pub struct Plan {
    /// Number of the plan that was received last.
    received: u64,
    serial: u64,
    eyes: [EyeMap; 2],
    decisions: [Option<Decision>; 2],
    scratch: Scratch,
}

/// The parameters of the GPU's decision on the rates of an eye's tiles.
#[derive(Clone, Copy, Debug)]
pub struct Decision {
    /// As long as no contrast is known.
    pub fixed: DecideParams,
    /// By contrast, where that counts.
    pub judged: Option<DecideParams>,
    /// Orientation of the view in a space that rests in the world.
    pub orientation: Quat,
    /// Allowed coarsening of tiles since their last decision, in 64ths of an octave.
    coarsening: u32,
}

impl Decision {
    /// The parameters: `judged`, if contrast counts, as `measured` makes it, else the other; with all coarsening that came together.
    pub fn params(&self, measured: impl FnOnce(DecideParams) -> Option<DecideParams>) -> DecideParams {
        let params = self.judged.and_then(measured).unwrap_or(self.fixed);
        DecideParams { coarsening: self.coarsening, ..params }
    }
}

impl Plan {
    /// Counts up with every plan, and with every decision on rates.
    pub fn serial(&self) -> u64 {
        self.serial
    }

    /// Number of the plan that was received last.
    pub fn received(&self) -> u64 {
        self.received
    }

    /// The parameters of the decision on the rates of an eye; `None` if its rates are the plan's.
    pub fn decision(&self, eye: usize) -> Option<&Decision> {
        self.decisions[eye].as_ref()
    }

    /// Notes that the GPU decides the rates of both eyes again.
    pub fn decided(&mut self) {
        self.serial += 1;
        self.decisions.iter_mut().flatten().for_each(|decision| decision.coarsening = 0);
    }

    /// Takes a newer plan, with the maps of both eyes; one that is not newer changes nothing.
    pub fn take(&mut self, record: &PlanRecord, rates: [&[u8]; 2]) {
        if record.serial <= self.received {
            return;
        }
        self.received = record.serial;
        self.serial += 1;
        for ((map, eye), rates) in self.eyes.iter_mut().zip(&record.eyes).zip(rates) {
            map.set(eye.extent, eye.texel, eye.tiles, rates);
        }
        for (decision, eye) in self.decisions.iter_mut().zip(&record.eyes) {
            let unused = decision.as_ref().map_or(0, |decision| decision.coarsening);
            *decision = Decision::of(eye, unused);
        }
    }

    /// Table of the tiles that each texel of `image` meets, for a pass that draws `parts`. `None` if `image` is empty, or if an eye of
    /// `parts` has no tiles or too many.
    pub fn table(&self, parts: &[Part], image: &RateImage) -> Option<RateMapTable> {
        rate_map_table(self.eyes.each_ref(), parts, image)
    }

    /// Size of the picture that the plan of an eye is made for and of its tiles, pixels, and columns and rows of tiles.
    pub fn shape(&self, eye: usize) -> [[u32; 2]; 3] {
        let map = &self.eyes[eye];
        [map.extent(), map.texel(), map.tiles()]
    }

    /// The tiles of the left and of the right eye that are stale.
    pub fn stale(&self) -> [&StaleTiles; 2] {
        self.eyes.each_ref().map(EyeMap::stale)
    }

    /// Whether any tile is stale.
    pub fn has_stale_tiles(&self) -> bool {
        self.stale().iter().any(|stale| !stale.is_empty())
    }

    /// Whether any tile that is not stale is coarser than 1x1, or may be by a decision of the GPU.
    pub fn coarsens(&self) -> bool {
        self.decisions.iter().any(Option::is_some) || self.eyes.iter().any(EyeMap::coarsens)
    }

    /// Resolves the plan over the picture of a pass; `texels` becomes the content of `image`.
    pub fn resolve(&mut self, parts: &[Part], image: &RateImage, rates: &DeviceRates, texels: &mut Vec<u8>) {
        texels.resize(image.len(), 0);
        let [left, right] = &self.eyes;
        match parts {
            [] => texels.fill(0),
            parts => resolve([left, right], parts, image, rates, &mut self.scratch, texels),
        }
    }
}

impl Decision {
    /// That of a record, after plans with `unused` coarsening, by which no decision was made.
    fn of(record: &EyeMapRecord, unused: u32) -> Option<Self> {
        let [x, y, z, w] = record.orientation;
        let decision = Self {
            fixed: record.fixed,
            judged: (record.is_judged == 1).then_some(record.judged),
            orientation: Quat::from_xyzw(x, y, z, w),
            coarsening: total_coarsening(unused, record.fixed.coarsening),
        };
        // A record for a different tile grid is ignored.
        (record.is_decided == 1 && record.fixed.tiles == record.tiles).then_some(decision)
    }
}

/// Coarsening without limit, as during a saccade, when no change is seen.
const UNLIMITED: u32 = 255;

/// The allowed coarsening of plan after plan, in 64ths of an octave. One without limit is for its own frame alone, and a plan that forbids
/// coarsening forbids that of earlier plans, too.
fn total_coarsening(unused: u32, newest: u32) -> u32 {
    match (unused, newest) {
        (_, 0) => 0,
        (_, UNLIMITED..) => UNLIMITED,
        (UNLIMITED.., newest) => newest,
        (unused, newest) => (unused + newest).min(UNLIMITED - 1),
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::pass_detection::{Eyes, Orientation};
    use parafovea_core::rate::ShadingRate;

    /// A plan of two tiles for each eye, without rates.
    pub fn plan_of_two_tiles(serial: u64) -> PlanRecord {
        let eye = EyeMapRecord {
            extent: [32, 16],
            texel: [16, 16],
            tiles: [2, 1],
            rates: std::ptr::null(),
            is_decided: 0,
            is_judged: 0,
            fixed: bytemuck::Zeroable::zeroed(),
            judged: bytemuck::Zeroable::zeroed(),
            orientation: [0.0, 0.0, 0.0, 1.0],
        };
        PlanRecord { serial, eyes: [eye; 2] }
    }

    #[test]
    fn only_newer_plans_are_resolved() {
        let rates = DeviceRates::new([ShadingRate::R2X2, ShadingRate::R4X4].into_iter());
        let image = RateImage { area: [0, 0, 32, 16], texel: [16, 16], tiles: [2, 1], layers: 1 };
        let part =
            |eyes| Part { eyes, layer: 0, rect: [0.0, 0.0, 1.0, 1.0], orientation: Orientation::Upright };
        let [r2, r4] = [ShadingRate::R2X2.texel(), ShadingRate::R4X4.texel()];
        let mut plan = Plan::default();
        let mut texels = vec![9; 7];
        let mut resolved = |plan: &mut Plan, parts: &[Part]| {
            plan.resolve(parts, &image, &rates, &mut texels);
            texels.clone()
        };
        assert_eq!(resolved(&mut plan, &[part(Eyes::Left)]), [0, 0], "before the first");
        plan.take(&plan_of_two_tiles(2), [&[r2, r4], &[r4, r4]]);
        for serial in [1, 2] {
            plan.take(&plan_of_two_tiles(serial), [&[0, 0], &[0, 0]]);
        }
        assert_eq!(resolved(&mut plan, &[part(Eyes::Left)]), [r2, r4]);
        assert_eq!(resolved(&mut plan, &[part(Eyes::Right)]), [r4, r4]);
        assert_eq!(resolved(&mut plan, &[]), [0, 0]);
        plan.take(&plan_of_two_tiles(3), [&[r4], &[r4, r4]]);
        assert_eq!(resolved(&mut plan, &[part(Eyes::Left)]), [0, 0], "a plan that makes no sense is 1x1");
    }

    /// A frame may have no pass of the scene, and so no decision.
    #[test]
    fn coarsening_of_a_saccade_is_not_kept_for_later() {
        let total = |steps: &[u32]| steps.iter().fold(0, |unused, step| total_coarsening(unused, *step));
        assert_eq!(total(&[3, 3]), 6);
        assert_eq!(total(&[3, 255]), 255);
        assert_eq!(total(&[255, 3]), 3);
        assert_eq!(total(&[255, 3, 3]), 6);
        assert_eq!(total(&[3, 255, 0]), 0);
        assert_eq!(total(&[200, 200]), 254, "not without limit");
    }
}
