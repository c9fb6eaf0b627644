//! The newest plan.

use crate::link::PlanRecord;
use crate::scene::Part;
use crate::scene::lay::{DeviceRates, EyeMap, RateImage, Scratch, lay};
use parafovea_core::reuse::StaleTiles;

/// The newest plan; before the first, number 0 with all at 1x1.
#[derive(Debug, Default)]
pub struct Plan {
    serial: u64,
    eyes: [EyeMap; 2],
    scratch: Scratch,
}

impl Plan {
    /// Counts up with every plan.
    pub fn serial(&self) -> u64 {
        self.serial
    }

    /// Takes a newer plan, with the maps of both eyes; one that is not newer changes nothing.
    pub fn take(&mut self, record: &PlanRecord, rates: [&[u8]; 2]) {
        if record.serial <= self.serial {
            return;
        }
        self.serial = record.serial;
        for ((map, eye), rates) in self.eyes.iter_mut().zip(&record.eyes).zip(rates) {
            map.set(eye.extent, eye.texel, eye.tiles, rates);
        }
    }

    /// The tiles of the left and of the right eye that are stale.
    pub fn stale(&self) -> [&StaleTiles; 2] {
        self.eyes.each_ref().map(EyeMap::stale)
    }

    /// Whether any tile that is not stale is coarser than 1x1.
    pub fn coarsens(&self) -> bool {
        self.eyes.iter().any(EyeMap::coarsens)
    }

    /// Lays the plan over what a pass draws; `texels` becomes the content of `image`.
    pub fn lay(&mut self, parts: &[Part], image: &RateImage, rates: &DeviceRates, texels: &mut Vec<u8>) {
        texels.clear();
        texels.resize(image.len(), 0);
        let [left, right] = &self.eyes;
        if !parts.is_empty() {
            lay([left, right], parts, image, rates, &mut self.scratch, texels);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::EyeMapRecord;
    use crate::scene::{Eyes, Orientation};
    use parafovea_core::rate::ShadingRate;

    fn record(serial: u64) -> PlanRecord {
        let eye = EyeMapRecord { extent: [32, 16], texel: [16, 16], tiles: [2, 1], rates: std::ptr::null() };
        PlanRecord { serial, eyes: [eye; 2] }
    }

    #[test]
    fn only_newer_plans_are_laid() {
        let rates = DeviceRates::new([ShadingRate::R2X2, ShadingRate::R4X4].into_iter());
        let image = RateImage { area: [0, 0, 32, 16], texel: [16, 16], tiles: [2, 1], layers: 1 };
        let part =
            |eyes| Part { eyes, layer: 0, rect: [0.0, 0.0, 1.0, 1.0], orientation: Orientation::Upright };
        let [r2, r4] = [ShadingRate::R2X2.texel(), ShadingRate::R4X4.texel()];
        let mut plan = Plan::default();
        let mut texels = vec![9; 7];
        let mut laid = |plan: &mut Plan, parts: &[Part]| {
            plan.lay(parts, &image, &rates, &mut texels);
            texels.clone()
        };
        assert_eq!(laid(&mut plan, &[part(Eyes::Left)]), [0, 0], "before the first");
        plan.take(&record(2), [&[r2, r4], &[r4, r4]]);
        for serial in [1, 2] {
            plan.take(&record(serial), [&[0, 0], &[0, 0]]);
        }
        assert_eq!(laid(&mut plan, &[part(Eyes::Left)]), [r2, r4]);
        assert_eq!(laid(&mut plan, &[part(Eyes::Right)]), [r4, r4]);
        assert_eq!(laid(&mut plan, &[]), [0, 0]);
        plan.take(&record(3), [&[r4], &[r4, r4]]);
        assert_eq!(laid(&mut plan, &[part(Eyes::Left)]), [0, 0], "a plan that makes no sense is 1x1");
    }
}
