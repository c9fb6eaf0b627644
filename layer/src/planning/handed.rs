//! The maps that were handed over last.

use crate::link::{EyeMapRecord, PlanRecord};
use parafovea_core::gate::Techniques;
use parafovea_core::plan::EyePlan;
use parafovea_core::reuse::STALE;
use std::ptr;

/// A copy of what the Vulkan half has.
#[derive(Debug, Default)]
pub struct Handed {
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
}

impl Handed {
    /// The next maps are news, whatever they are.
    pub fn forget(&mut self) {
        self.is_known = false;
    }

    /// Takes the maps of a plan, with what they shall have of it. Whether they are news.
    pub fn update(&mut self, eyes: &[EyePlan; 2], techniques: Techniques<bool>) -> bool {
        let kept = (if techniques.rates { !STALE } else { 0 }) | (if techniques.reuse { STALE } else { 0 });
        let mut is_news = !std::mem::replace(&mut self.is_known, true);
        for (map, eye) in self.eyes.iter_mut().zip(eyes) {
            self.newest.clear();
            eye.write_map(&mut self.newest);
            self.newest.iter_mut().for_each(|tile| *tile &= kept);
            is_news |= map.take(eye, &mut self.newest);
        }
        is_news
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
        let is_news = (self.extent, self.texel, self.tiles) != shape || self.bytes != *bytes;
        (self.extent, self.texel, self.tiles) = shape;
        std::mem::swap(&mut self.bytes, bytes);
        is_news
    }

    fn record(&self) -> EyeMapRecord {
        let rates = if self.bytes.is_empty() { ptr::null() } else { self.bytes.as_ptr() };
        EyeMapRecord { extent: self.extent, texel: self.texel, tiles: self.tiles, rates }
    }
}

fn tiles(eye: &EyePlan) -> [u32; 2] {
    [eye.rates.width(), eye.rates.height()]
}
