//! Rate images: one for each colour target of the application's, and one for each size that is shared by targets that
//! are not known.
//!
//! An image is made when something that draws to its target is created or recorded, and destroyed with the last that
//! names it: its candidate, which goes with the target, framebuffers, and command buffers. The application destroys
//! those only when the GPU is done with them, and a map's upload comes before that on the same queue.

use super::capabilities::RateCapabilities;
use super::create::Enabled;
use super::memory::{Memory, Suballocation};
use crate::backend::{MapForm, MapSize, RateMap, Upload};
use crate::gpu::GpuError;
use crate::gpu::functions::Functions;
use crate::gpu::memory::memory_type;
use crate::link::DeviceRecord;
use crate::pass_detection::{How, ImageDescription, ImageKey, Target};
use ash::vk;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

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
    /// Columns and rows of texels.
    pub texels: [u32; 2],
    /// Layers: 1, or one for each layer or view that is drawn.
    pub layers: u32,
}

impl RateImageKey {
    /// The key of a target of an image.
    pub fn of(target: Target, image: &ImageDescription, capabilities: &RateCapabilities) -> Self {
        let extent = image.extent.map(|side| side.checked_shr(target.level).unwrap_or(0).max(1));
        Self { target, texels: capabilities.texels(extent), layers: capabilities.layers(target.layers) }
    }

    /// The key that all unknown targets of one need share.
    pub fn shared(texels: [u32; 2], layers: u32) -> Self {
        // No image of the application's has such a key: those count up from 1.
        let [columns, rows] = texels.map(u64::from);
        let image = ImageKey(1 << 63 | columns << 40 | rows << 16 | u64::from(layers));
        Self { target: Target { image, level: 0, base_layer: 0, layers }, texels, layers }
    }
}

/// A rate image with its view; destroyed when it is dropped.
pub struct RateImage {
    /// Its purpose.
    pub key: RateImageKey,
    /// The view to attach: of one layer, or of all as an array.
    pub view: vk::ImageView,
    image: vk::Image,
    allocation: Suballocation,
    maker: Arc<Maker>,
    /// Whether the pass without depth that was submitted last for its target was the scene, and the one with depth.
    is_matched: [AtomicBool; 2],
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

    unsafe fn record_upload(&self, upload: Upload) {
        // SAFETY: as `RateMap::record_upload` demands, the command buffer is recording, and the buffer lives until it has finished.
        unsafe { RateImage::record_upload(self, upload.commands, upload.staging, upload.offset) }
    }
}

/// All rate images of a device.
pub struct RateImages {
    maker: Arc<Maker>,
    live: Mutex<HashMap<RateImageKey, Weak<RateImage>>>,
    /// Takes the place of images that cannot be made.
    stand_in: OnceLock<Option<Arc<RateImage>>>,
    /// Number of images that could not be made.
    failures: AtomicU32,
}

/// After so many failures no image is tried to be made any more.
const MOST_FAILURES: u32 = 4;

/// Creates rate images.
struct Maker {
    functions: Functions,
    /// Size of a texel, pixels.
    texel: [u32; 2],
    /// Width and height of the largest framebuffer, pixels (`maxFramebufferWidth`, `maxFramebufferHeight`).
    largest: [u32; 2],
    /// Types of the device's memory.
    memory_types: vk::PhysicalDeviceMemoryProperties,
    /// Families of the queues that the application has: where there are several, all may use an image at once.
    families: Vec<u32>,
    /// Whether a format list can be said at the creation of an image, which imageless framebuffers compare.
    has_format_lists: bool,
    memory: Mutex<Memory>,
    /// Whether the device is about to be destroyed, and the images with it.
    is_over: AtomicBool,
}

impl RateImages {
    /// None yet.
    ///
    /// # Errors
    ///
    /// [`GpuError::Missing`].
    ///
    /// # Safety
    ///
    /// The record is of a live device, which has the extensions and features in `enabled`.
    pub unsafe fn of_device(record: &DeviceRecord, enabled: &Enabled) -> Result<Self, GpuError> {
        // SAFETY: the record is of a live device, as `# Safety` demands.
        let (functions, memory_types, limits) = unsafe {
            let functions = Functions::load(record)?;
            let types = functions.instance.get_physical_device_memory_properties(record.physical_device);
            let limits = functions.instance.get_physical_device_properties(record.physical_device).limits;
            (functions, types, limits)
        };
        let maker = Maker {
            functions,
            texel: enabled.capabilities.texel,
            largest: [limits.max_framebuffer_width, limits.max_framebuffer_height],
            memory_types,
            families: enabled.families.clone(),
            has_format_lists: enabled.has_format_lists,
            memory: Mutex::default(),
            is_over: AtomicBool::new(false),
        };
        Ok(Self {
            maker: Arc::new(maker),
            live: Mutex::default(),
            stand_in: OnceLock::new(),
            failures: AtomicU32::new(0),
        })
    }

    /// The image that fits every framebuffer of the device, made at the first call; `None` if that fails. A
    /// render pass gets a rate attachment only with this image at hand, as its framebuffers need one.
    pub fn stand_in(&self) -> Option<&Arc<RateImage>> {
        let texels = [0, 1].map(|axis| self.maker.largest[axis].div_ceil(self.maker.texel[axis]).max(1));
        self.stand_in.get_or_init(|| self.of(RateImageKey::shared(texels, 1))).as_ref()
    }

    /// The image of that key, or else the stand-in, where that is large enough.
    pub fn fitting(&self, key: RateImageKey) -> Option<Arc<RateImage>> {
        self.of(key).or_else(|| {
            let fits =
                |image: &&Arc<RateImage>| (0..2).all(|axis| key.texels[axis] <= image.key.texels[axis]);
            self.stand_in().filter(fits).cloned()
        })
    }

    /// The image of that key, which is made if there is none yet; `None` if that fails.
    pub fn of(&self, key: RateImageKey) -> Option<Arc<RateImage>> {
        if let Some(known) = self.live().get(&key).and_then(Weak::upgrade) {
            return Some(known);
        }
        if self.failures.load(Ordering::Relaxed) >= MOST_FAILURES {
            return None;
        }
        match self.maker.create(key) {
            Ok(new) => {
                let new = Arc::new(new);
                let mut live = self.live();
                live.retain(|_, image| image.strong_count() > 0);
                // Another thread may have been faster.
                let kept = live.get(&key).and_then(Weak::upgrade);
                if kept.is_none() {
                    live.insert(key, Arc::downgrade(&new));
                }
                drop(live);
                Some(kept.unwrap_or(new))
            }
            Err(reason) => {
                self.failures.fetch_add(1, Ordering::Relaxed);
                reason.log("an image has no shading rates");
                None
            }
        }
    }

    /// Frees all memory: the device is about to be destroyed. Images that are still named are destroyed first.
    ///
    /// # Safety
    ///
    /// The device is live, and nothing of the application's is under way or recorded any more.
    pub unsafe fn end(&self) {
        let left: Vec<_> = self.live().drain().filter_map(|(_, image)| image.upgrade()).collect();
        let device = &self.maker.functions.device;
        let memory: Vec<_> = {
            let mut memory = self.maker.memory();
            self.maker.is_over.store(true, Ordering::Release);
            memory.take_all().collect()
        };
        // SAFETY: nothing is in use, as `# Safety` demands; remaining references to an image do not destroy it any more.
        unsafe {
            for image in left {
                device.destroy_image_view(image.view, None);
                device.destroy_image(image.image, None);
            }
            for memory in memory {
                device.free_memory(memory, None);
            }
        }
    }

    fn live(&self) -> MutexGuard<'_, HashMap<RateImageKey, Weak<RateImage>>> {
        self.live.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Maker {
    fn memory(&self) -> MutexGuard<'_, Memory> {
        self.memory.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn create(self: &Arc<Self>, key: RateImageKey) -> Result<RateImage, GpuError> {
        let device = &self.functions.device;
        let [width, height] = key.texels;
        let formats = [super::FORMAT];
        let mut list = vk::ImageFormatListCreateInfo::default().view_formats(&formats);
        let mut info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(super::FORMAT)
            .extent(vk::Extent3D { width, height, depth: 1 })
            .mip_levels(1)
            .array_layers(key.layers)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(USAGE)
            .initial_layout(vk::ImageLayout::UNDEFINED);
        if self.families.len() > 1 {
            info = info.sharing_mode(vk::SharingMode::CONCURRENT).queue_family_indices(&self.families);
        }
        if self.has_format_lists {
            info = info.push_next(&mut list);
        }
        // SAFETY: the device is live, and its rate attachments are of this format and usage.
        unsafe {
            let image = device.create_image(&info, None).map_err(GpuError::from_call("vkCreateImage"))?;
            let made = self.bind(image).and_then(|allocation| {
                self.view(image, key.layers).map(|view| (allocation, view)).inspect_err(|_| {
                    self.memory().give_back(allocation);
                })
            });
            let (allocation, view) = made.inspect_err(|_| device.destroy_image(image, None))?;
            let maker = Arc::clone(self);
            Ok(RateImage { key, view, image, allocation, maker, is_matched: Default::default() })
        }
    }

    fn bind(&self, image: vk::Image) -> Result<Suballocation, GpuError> {
        let device = &self.functions.device;
        // SAFETY: a new image of this live device.
        let requirements = unsafe { device.get_image_memory_requirements(image) };
        let local = vk::MemoryPropertyFlags::DEVICE_LOCAL;
        let kind = memory_type(&self.memory_types, requirements.memory_type_bits, local)
            .ok_or(GpuError::Unsupported("a device without a suitable memory type"))?;
        let allocation = self.allocation(&requirements, kind)?;
        // SAFETY: the place meets the image's requirements, and no other object has it.
        let bound = unsafe { device.bind_image_memory(image, allocation.memory, allocation.offset) };
        bound.map(|()| allocation).map_err(|result| {
            self.memory().give_back(allocation);
            GpuError::from_call("vkBindImageMemory")(result)
        })
    }

    /// A place in memory. An allocation is made ahead of the lock, as no lock of ours is held across a call down.
    fn allocation(
        &self,
        requirements: &vk::MemoryRequirements,
        kind: u32,
    ) -> Result<Suballocation, GpuError> {
        if let Some(allocation) = self.memory().take(requirements, kind) {
            return Ok(allocation);
        }
        let size = Memory::allocation_for(requirements);
        let info = vk::MemoryAllocateInfo::default().allocation_size(size).memory_type_index(kind);
        // SAFETY: the device is live and has that memory type.
        let memory = unsafe { self.functions.device.allocate_memory(&info, None) }
            .map_err(GpuError::from_call("vkAllocateMemory"))?;
        Ok(self.memory().add(memory, kind, requirements))
    }

    fn view(&self, image: vk::Image, layers: u32) -> Result<vk::ImageView, GpuError> {
        let several = layers > 1;
        let kind = if several { vk::ImageViewType::TYPE_2D_ARRAY } else { vk::ImageViewType::TYPE_2D };
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(kind)
            .format(super::FORMAT)
            .subresource_range(vk::ImageSubresourceRange {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                base_mip_level: 0,
                level_count: 1,
                base_array_layer: 0,
                layer_count: layers,
            });
        // SAFETY: a live image of this device with so many layers, with memory bound.
        unsafe { self.functions.device.create_image_view(&info, None) }
            .map_err(GpuError::from_call("vkCreateImageView"))
    }
}
