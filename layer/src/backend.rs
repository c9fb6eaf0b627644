//! Backends, which make passes coarser on a device, and their maps of candidates.

pub(crate) mod attachment;
pub mod mask;

use crate::kernels::mask::MaskOutput;
use crate::link::CapabilitiesRecord;
use crate::pass_detection::{How, Part, Pass};
use crate::rate_map::RateImage;
use crate::vk::objects::Image;
use ash::vk;
use std::any::Any;
use std::sync::Arc;

/// A means of a device to make passes coarser.
pub trait Backend: Send + Sync {
    /// Its capabilities; the plan is made for them.
    fn capabilities(&self) -> CapabilitiesRecord;

    /// The map of the passes that draw to the same colour target as `pass`, whose image is `image`; `None` if they cannot be made coarser.
    /// Made once for a target, when the first command buffer draws to it.
    fn map(&self, pass: &Pass, image: &Image) -> Option<Box<dyn RateMap>>;
}

/// The map of rates of a candidate, on the GPU. Its memory and images are destroyed when it is dropped, which happens when
/// the GPU is done with them, and before the device is destroyed.
pub trait RateMap: Any + Send + Sync {
    /// Number and size of its texels.
    fn size(&self) -> MapSize;

    /// Number of bytes that [`Self::stage`] writes; 0 if nothing can read them yet.
    fn staging_len(&self) -> usize {
        self.size().texel_count()
    }

    /// Whether it has content, 1x1 all over, from its creation on; else it has to be uploaded before it is used.
    fn has_content(&self) -> bool {
        false
    }

    /// A pass that draws to its target, with depth or without, is submitted in a frame of this number; it is the scene for this reason, or is
    /// not.
    fn submitted(&self, _scene: Option<How>, _has_depth: bool, _frame: u64) {}

    /// Whether its passes skip stale tiles; else they shade them as coarsely as can be.
    fn skips_stale_tiles(&self) -> bool {
        false
    }

    /// The form of texels that were resolved on the GPU; `None` where they have to be staged.
    fn form(&self) -> Option<MapForm> {
        None
    }

    /// A number that no other object has, if the commands of [`Self::record_upload`] depend on nothing but the map and the source.
    fn serial(&self) -> Option<u64> {
        None
    }

    /// Writes the staged bytes of the map, from the texels of all layers, row by row (`ShadingRate::texel`, and `STALE` only where
    /// [`Self::skips_stale_tiles`] holds), which were resolved into `image` for the pictures of `parts`.
    fn stage(&self, _parts: &[Part], _image: &RateImage, texels: &[u8], staging: &mut [u8]) {
        staging.copy_from_slice(texels);
    }

    /// Records the copy of the bytes of [`Self::stage`] to the map, with the barriers against earlier and later passes on this queue. The
    /// first upload finds the map as it was created.
    ///
    /// # Safety
    ///
    /// The command buffer is being recorded, outside of a render pass, for a queue that draws; the buffer and the map live
    /// until it ran.
    unsafe fn record_upload(&self, upload: Upload);
}

/// The form in which a map takes texels that were resolved on the GPU.
pub enum MapForm {
    /// [`RateMap::record_upload`] takes them as they are.
    Texels,
    /// The kernel `mask` makes this of them.
    Mask(Arc<dyn MaskOutput>),
}

/// Source of a map's upload.
#[derive(Debug, Clone, Copy)]
pub struct Upload {
    /// The command buffer that is recorded.
    pub commands: vk::CommandBuffer,
    /// The buffer that [`RateMap::stage`] wrote to.
    pub staging: vk::Buffer,
    /// Offset in the buffer, bytes; a multiple of 16.
    pub offset: vk::DeviceSize,
    /// Number of bytes that it wrote.
    pub len: usize,
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
    pub fn texel_count(&self) -> usize {
        self.tiles[0] as usize * self.tiles[1] as usize * self.layers as usize
    }
}
