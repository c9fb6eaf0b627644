//! What makes passes coarser on a device: a backend, and what it keeps for each candidate.

use super::armed::Armed;
use super::objects::Image;
use crate::link::OfferRecord;
use crate::scene::Pass;
use ash::vk;

/// What makes passes coarser on a device.
pub trait Backend: Send + Sync {
    /// What it can do; the plan is made for it.
    fn offer(&self) -> OfferRecord;

    /// The map of the passes that draw to the same colour target as `pass`, whose image is `image`; nothing where they
    /// cannot be made coarser. Made once for a target, when the first command buffer draws to it.
    fn map(&self, armed: &Armed, pass: &Pass, image: &Image) -> Option<Box<dyn RateMap>>;
}

/// The map of rates of a candidate, on the GPU. Its memory and images are destroyed when it is dropped, which happens when
/// the GPU is done with them, and before the device is destroyed.
pub trait RateMap: Send + Sync {
    /// How many texels it has.
    fn size(&self) -> MapSize;

    /// How many bytes [`Self::stage`] writes.
    fn staging_len(&self) -> usize {
        self.size().len()
    }

    /// Writes what is copied to the GPU, from the texels of all layers, row by row (`ShadingRate::texel`).
    fn stage(&self, texels: &[u8], staging: &mut [u8]) {
        staging.copy_from_slice(texels);
    }

    /// Records that the map gets what [`Self::stage`] wrote at `offset` of `staging`, a multiple of 16, with the
    /// barriers against earlier and later passes on this queue. The first upload finds what the map was created as.
    ///
    /// # Safety
    ///
    /// `commands` is being recorded, outside of a render pass, for a queue that draws; the buffer is live until it ran.
    unsafe fn record_upload(&self, commands: vk::CommandBuffer, staging: vk::Buffer, offset: vk::DeviceSize);
}

/// Texels of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MapSize {
    /// Size of a texel, pixels.
    pub texel: [u32; 2],
    /// Columns and rows of texels.
    pub tiles: [u32; 2],
    /// Array layers: 1 serves all layers of the target.
    pub layers: u32,
}

impl MapSize {
    /// Number of texels of all layers.
    pub fn len(&self) -> usize {
        self.tiles[0] as usize * self.tiles[1] as usize * self.layers as usize
    }
}
