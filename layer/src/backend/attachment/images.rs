//! All rate images of a device: one for each colour target of the application's, and one for each size that is shared by targets that
//! are not known.

use super::create::Enabled;
use super::image::{RateImage, RateImageKey, USAGE};
use super::memory::{Memory, Suballocation};
use crate::gpu::functions::Functions;
use crate::gpu::memory::memory_type;
use crate::gpu::{GpuError, serial};
use crate::link::DeviceRecord;
use ash::vk;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

/// All rate images of a device.
pub struct RateImages {
    maker: Arc<Maker>,
    live: Mutex<HashMap<RateImageKey, Weak<RateImage>>>,
    /// Takes the place of images that cannot be made.
    stand_in: OnceLock<Option<Arc<RateImage>>>,
    /// Number of images that could not be made.
    failures: AtomicU32,
}

/// Number of failures after which no more images are created.
const MOST_FAILURES: u32 = 4;

/// Creates rate images.
pub(super) struct Maker {
    pub(super) functions: Functions,
    /// Size of a texel, pixels.
    pub(super) texel: [u32; 2],
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
    pub(super) is_over: AtomicBool,
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

    /// The image of that key, or else the stand-in, if it is large enough.
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
    pub(super) fn memory(&self) -> MutexGuard<'_, Memory> {
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
        let (image, (allocation, view)) = unsafe {
            let image = device.create_image(&info, None).map_err(GpuError::from_call("vkCreateImage"))?;
            let made = self.bind(image).and_then(|allocation| {
                self.view(image, key.layers).map(|view| (allocation, view)).inspect_err(|_| {
                    self.memory().give_back(allocation);
                })
            });
            (image, made.inspect_err(|_| device.destroy_image(image, None))?)
        };
        let (maker, is_matched) = (Arc::clone(self), Default::default());
        Ok(RateImage { key, view, image, allocation, maker, is_matched, serial: serial() })
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
