//! The rates that were handed over last.

use crate::link::{EyeMapRecord, PlanRecord};
use parafovea_core::plan::EyePlan;
use std::ptr;

/// A copy of what the Vulkan half has.
#[derive(Debug, Default)]
pub struct Handed {
    eyes: [Map; 2],
    is_known: bool,
}

#[derive(Debug, Default)]
struct Map {
    extent: [u32; 2],
    texel: [u32; 2],
    tiles: [u32; 2],
    rates: Vec<u8>,
}

impl Handed {
    /// The next rates are news, whatever they are.
    pub fn forget(&mut self) {
        self.is_known = false;
    }

    /// Takes the rates of a plan. Whether they are news.
    pub fn update(&mut self, eyes: &[EyePlan; 2]) -> bool {
        if self.is_known && self.eyes.iter().zip(eyes).all(|(map, eye)| map.is_of(eye)) {
            return false;
        }
        for (map, eye) in self.eyes.iter_mut().zip(eyes) {
            map.take(eye);
        }
        self.is_known = true;
        true
    }

    /// The rates as a record.
    pub fn record(&self, serial: u64) -> PlanRecord {
        let [left, right] = &self.eyes;
        PlanRecord { serial, eyes: [left.record(), right.record()] }
    }
}

impl Map {
    fn is_of(&self, eye: &EyePlan) -> bool {
        (self.extent, self.texel, self.tiles) == (eye.extent, eye.texel, tiles(eye))
            && self.rates == eye.rates.texels()
    }

    fn take(&mut self, eye: &EyePlan) {
        (self.extent, self.texel, self.tiles) = (eye.extent, eye.texel, tiles(eye));
        self.rates.clear();
        self.rates.extend_from_slice(eye.rates.texels());
    }

    fn record(&self) -> EyeMapRecord {
        let rates = if self.rates.is_empty() { ptr::null() } else { self.rates.as_ptr() };
        EyeMapRecord { extent: self.extent, texel: self.texel, tiles: self.tiles, rates }
    }
}

fn tiles(eye: &EyePlan) -> [u32; 2] {
    [eye.rates.width(), eye.rates.height()]
}
