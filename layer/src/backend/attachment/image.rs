//! A rate image: of one colour target of the application's, or of a size that targets share that are not known.
//!
//! An image is made when something that draws to its target is created or recorded, and destroyed with the last that
//! names it: its candidate, which goes with the target, framebuffers, and command buffers. The application destroys
//! those only when the GPU is done with them, and a map's upload comes before that on the same queue.

use super::capabilities::RateCapabilities;
use super::images::Maker;
use super::memory::Suballocation;
use crate::backend::{MapForm, MapSize, RateMap, Upload};
use crate::pass_detection::{How, ImageDescription, ImageKey, Target};
use ash::vk;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The usage of rate images.
pub const USAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::from_raw(
    vk::ImageUsageFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR.as_raw()
        | vk::ImageUsageFlags::TRANSFER_DST.as_raw(),
);

/// The purpose of a rate image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct RateImageKey {
    /// The target of its passes.
    pub target: Target,
    /// Whether its passes have depth. Passes without, such as a bloom that is drawn onto the scene, are often not the scene, and must not turn the
    /// map of those with depth 1x1.
    pub has_depth: bool,
    /// Columns and rows of texels.
    pub texels: [u32; 2],
    /// Layers: 1, or one for each layer or view that is drawn.
    pub layers: u32,
}

impl RateImageKey {
    /// The key of a target of an image, for passes with depth or without. Faces of cubes and smaller levels, which are never recognised as the
    /// scene, share an image by their size.
    pub fn of(
        (target, image, has_depth): (Target, &ImageDescription, bool),
        capabilities: &RateCapabilities,
    ) -> Self {
        let extent = image.extent.map(|side| side.checked_shr(target.level).unwrap_or(0).max(1));
        let (texels, layers) = (capabilities.texels(extent), capabilities.layers(target.layers));
        if image.is_cube || target.level != 0 {
            return Self::shared(texels, layers);
        }
        Self { target, has_depth, texels, layers }
    }

    /// The key that all unknown targets of one need share.
    pub fn shared(texels: [u32; 2], layers: u32) -> Self {
        // No image of the application's has such a key: those count up from 1.
        let [columns, rows] = texels.map(u64::from);
        let image = ImageKey(1 << 63 | columns << 40 | rows << 16 | u64::from(layers));
        let target = Target { image, level: 0, base_layer: 0, layers };
        Self { target, has_depth: true, texels, layers }
    }
}

/// A rate image with its view; destroyed when it is dropped.
pub struct RateImage {
    /// Its purpose.
    pub key: RateImageKey,
    /// The view to attach: of one layer, or of all as an array.
    pub view: vk::ImageView,
    pub(super) image: vk::Image,
    pub(super) allocation: Suballocation,
    pub(super) maker: Arc<Maker>,
    /// Whether the pass without depth that was submitted last for its target was the scene, and the one with depth.
    pub(super) is_matched: [AtomicBool; 2],
    /// A number that no other object has.
    pub(super) serial: u64,
}

/// The stage and the access of passes that read rates.
const READ: (vk::PipelineStageFlags, vk::AccessFlags) = (
    vk::PipelineStageFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR,
    vk::AccessFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_READ_KHR,
);

impl RateImage {
    /// Whether the pass, with depth or without, that was submitted last for its target was recognised as the scene.
    pub fn is_matched(&self, has_depth: bool) -> bool {
        self.is_matched[usize::from(has_depth)].load(Ordering::Relaxed)
    }

    /// Records that it becomes the map at `offset` of a buffer, a texel a byte, row by row, layer by layer, and readable
    /// as a rate attachment. Passes on this queue that read it before are waited for.
    ///
    /// # Safety
    ///
    /// The command buffer is recording, outside of passes, for a queue that draws; `offset` is a multiple of 4, and a
    /// map begins there in the buffer, which the device sees.
    pub unsafe fn record_upload(&self, buffer: vk::CommandBuffer, from: vk::Buffer, offset: vk::DeviceSize) {
        let device = &self.maker.functions.device;
        let [width, height] = self.key.texels;
        let region = vk::BufferImageCopy {
            buffer_offset: offset,
            image_subresource: vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                mip_level: 0,
                base_array_layer: 0,
                layer_count: self.key.layers,
            },
            image_extent: vk::Extent3D { width, height, depth: 1 },
            ..Default::default()
        };
        let layout = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        // SAFETY: the command buffer is recording, and image and buffer live until it has finished, as `# Safety` demands.
        unsafe {
            self.record_writable(device, buffer);
            device.cmd_copy_buffer_to_image(buffer, from, self.image, layout, &[region]);
            self.record_readable(device, buffer);
        }
    }

    /// After its readers its content can be replaced.
    ///
    /// # Safety
    ///
    /// The command buffer is recording, outside of passes, for a queue that draws, and the image lives until it has finished.
    unsafe fn record_writable(&self, device: &ash::Device, buffer: vk::CommandBuffer) {
        let barrier = vk::ImageMemoryBarrier::default()
            .image(self.image)
            .subresource_range(self.range())
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .old_layout(vk::ImageLayout::UNDEFINED)
            .new_layout(vk::ImageLayout::TRANSFER_DST_OPTIMAL);
        // A map that was uploaded and never read is written again too.
        let before = READ.0 | vk::PipelineStageFlags::TRANSFER;
        // SAFETY: the command buffer is recording, and the image lives until it has finished, as `# Safety` demands.
        unsafe { record_barrier(device, buffer, before, vk::PipelineStageFlags::TRANSFER, barrier) }
    }

    /// After the copy to it its content can be read.
    ///
    /// # Safety
    ///
    /// The command buffer is recording, outside of passes, for a queue that draws, and the image lives until it has finished.
    unsafe fn record_readable(&self, device: &ash::Device, buffer: vk::CommandBuffer) {
        let barrier = vk::ImageMemoryBarrier::default()
            .image(self.image)
            .subresource_range(self.range())
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(READ.1)
            .old_layout(vk::ImageLayout::TRANSFER_DST_OPTIMAL)
            .new_layout(vk::ImageLayout::FRAGMENT_SHADING_RATE_ATTACHMENT_OPTIMAL_KHR);
        // SAFETY: the command buffer is recording, and the image lives until it has finished, as `# Safety` demands.
        unsafe { record_barrier(device, buffer, vk::PipelineStageFlags::TRANSFER, READ.0, barrier) }
    }

    fn range(&self) -> vk::ImageSubresourceRange {
        vk::ImageSubresourceRange {
            aspect_mask: vk::ImageAspectFlags::COLOR,
            base_mip_level: 0,
            level_count: 1,
            base_array_layer: 0,
            layer_count: self.key.layers,
        }
    }
}

/// Records the barrier of an image between two stages.
///
/// # Safety
///
/// As for [`RateImage::record_upload`].
unsafe fn record_barrier(
    device: &ash::Device,
    buffer: vk::CommandBuffer,
    before: vk::PipelineStageFlags,
    after: vk::PipelineStageFlags,
    barrier: vk::ImageMemoryBarrier<'_>,
) {
    let none = vk::DependencyFlags::empty();
    // SAFETY: the command buffer is recording, and the image lives until it has finished, as `# Safety` demands.
    unsafe { device.cmd_pipeline_barrier(buffer, before, after, none, &[], &[], &[barrier]) }
}

impl Drop for RateImage {
    fn drop(&mut self) {
        if self.maker.is_over.load(Ordering::Acquire) {
            return;
        }
        let device = &self.maker.functions.device;
        // SAFETY: the device is live, and nothing that names the image is left.
        unsafe {
            device.destroy_image_view(self.view, None);
            device.destroy_image(self.image, None);
        }
        self.maker.memory().give_back(self.allocation);
    }
}

impl RateMap for Arc<RateImage> {
    fn size(&self) -> MapSize {
        MapSize { texel: self.maker.texel, tiles: self.key.texels, layers: self.key.layers }
    }

    fn submitted(&self, scene: Option<How>, has_depth: bool, _frame: u64) {
        self.is_matched[usize::from(has_depth)].store(scene.is_some(), Ordering::Relaxed);
    }

    fn form(&self) -> Option<MapForm> {
        Some(MapForm::Texels)
    }

    fn serial(&self) -> Option<u64> {
        Some(self.serial)
    }

    unsafe fn record_upload(&self, upload: Upload) {
        // SAFETY: as `RateMap::record_upload` demands, the command buffer is recording, and the buffer lives until it has finished.
        unsafe { RateImage::record_upload(self, upload.commands, upload.staging, upload.offset) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::attachment::capabilities::tests::offered;

    #[test]
    fn faces_and_levels_share_an_image_by_their_size() {
        let capabilities = offered([16, 16]);
        let key = |image: u64, level: u32, base_layer: u32, is_cube: bool| {
            let description = ImageDescription {
                key: ImageKey(image),
                extent: [512, 512],
                layers: 6,
                format: vk::Format::R8G8B8A8_UNORM,
                samples: 1,
                is_cube,
                swapchain: None,
            };
            let target = Target { image: ImageKey(image), level, base_layer, layers: 1 };
            RateImageKey::of((target, &description, true), &capabilities)
        };
        assert_ne!(key(1, 0, 0, false), key(1, 0, 1, false), "pictures of both eyes in layers");
        assert_ne!(key(1, 0, 0, false), key(2, 0, 0, false));
        assert_eq!(key(1, 0, 0, true), key(2, 0, 5, true));
        assert_eq!(key(1, 1, 0, false), key(2, 1, 3, true));
        assert_eq!(key(1, 1, 0, false).texels, capabilities.texels([256, 256]));
        assert_ne!(key(1, 1, 0, false), key(1, 2, 0, false));
    }
}
