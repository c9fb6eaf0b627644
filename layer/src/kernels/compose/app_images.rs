//! The images that the application renders to instead of the runtime's.

use super::SwapchainShape;
use crate::gpu::barrier::APP_CREATED;
use crate::gpu::{Gpu, GpuError, ImageDescription, Owned, OwnedImage, TextureSets, Uses, color_view, serial};
use ash::vk;
use std::sync::atomic::{AtomicI32, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Our usage of the application's images, besides its own: `compose` reads and draws them, `fill` copies them.
pub const APP_USAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::from_raw(
    vk::ImageUsageFlags::SAMPLED.as_raw()
        | vk::ImageUsageFlags::TRANSFER_SRC.as_raw()
        | vk::ImageUsageFlags::TRANSFER_DST.as_raw()
        | vk::ImageUsageFlags::COLOR_ATTACHMENT.as_raw(),
);

/// Images of ours that the application renders to.
pub struct AppImages {
    // First: waits before the rest is destroyed. The others in the order in which each may be destroyed.
    uses: Uses,
    textures: TextureSets,
    views: Mutex<Vec<Owned<vk::ImageView>>>,
    images: Mutex<Vec<OwnedImage>>,
    /// Of all images that were made.
    handles: Vec<vk::Image>,
    /// Number of images, which are the first ones.
    count: AtomicUsize,
    /// The layouts in which the application left them.
    layouts: Vec<AtomicI32>,
    /// The submit that used each of them last; 0: none.
    last_uses: Vec<AtomicU64>,
    shape: SwapchainShape,
    /// Memory of one of them.
    bytes: u64,
    serial: u64,
    gpu: Arc<Gpu>,
}

/// Memory of an image that was just made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageMemory {
    /// Its size, bytes.
    pub bytes: u64,
    /// Remaining memory of that heap for this process, bytes; `None` if the device does not report it.
    pub remaining: Option<u64>,
}

impl AppImages {
    /// Creates `count` images, with the application's usage and ours; for views of other formats if it asked for that, as an imageless
    /// framebuffer names flags and formats of the images. Submits nothing: a swapchain is created while the queue is the application's
    /// alone.
    ///
    /// One queue family at a time owns them, as it owns the runtime's images: an application that renders on a queue of another family than
    /// the session's gives them back before it releases them (XR_KHR_vulkan_enable2, "Swapchain Image State").
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] when the device has no such images; a failed call.
    pub fn new(gpu: &Arc<Gpu>, shape: &SwapchainShape, count: u32) -> Result<Self, GpuError> {
        Self::with_count(gpu, shape, |_| count)
    }

    /// As [`Self::new`], with the number of images that `count` returns for the memory of one of them, at least one.
    ///
    /// # Errors
    /// As there.
    pub fn with_count(
        gpu: &Arc<Gpu>,
        shape: &SwapchainShape,
        count: impl FnOnce(ImageMemory) -> u32,
    ) -> Result<Self, GpuError> {
        let view_formats = shape.listed_view_formats();
        let description = ImageDescription {
            format: shape.format,
            samples: vk::SampleCountFlags::TYPE_1,
            extent: shape.extent,
            array_layers: shape.array_layers,
            usage: shape.usage | APP_USAGE,
            mutable: shape.mutable,
            view_formats: &view_formats,
        };
        let uses = Uses::new(gpu);
        let first = OwnedImage::new(gpu, &description)?;
        let (bytes, heap) = first.memory();
        let count = count(ImageMemory { bytes, remaining: gpu.remaining_memory(heap) });
        let others = (1..count).map(|_| OwnedImage::new(gpu, &description));
        let images = std::iter::once(Ok(first)).chain(others).collect::<Result<Vec<_>, GpuError>>()?;
        let handles: Vec<vk::Image> = images.iter().map(OwnedImage::handle).collect();
        let views = handles
            .iter()
            .flat_map(|&image| (0..shape.array_layers).map(move |layer| (image, layer)))
            .map(|(image, layer)| color_view(gpu, image, shape.format, layer))
            .collect::<Result<Vec<_>, GpuError>>()?;
        let textures = TextureSets::new(gpu, &views)?;
        Ok(Self {
            uses,
            textures,
            views: Mutex::new(views),
            images: Mutex::new(images),
            count: AtomicUsize::new(handles.len()),
            layouts: handles
                .iter()
                .map(|_| AtomicI32::new(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL.as_raw()))
                .collect(),
            last_uses: handles.iter().map(|_| AtomicU64::new(0)).collect(),
            handles,
            shape: shape.clone(),
            bytes,
            serial: serial(),
            gpu: Arc::clone(gpu),
        })
    }

    /// Brings the images from number `first` on to COLOR_ATTACHMENT_OPTIMAL, with a submit. Their content is lost: the application has not
    /// had them yet.
    ///
    /// # Errors
    /// [`GpuError::Timeout`] when earlier submits hang; a failed call. Then nothing was submitted.
    pub fn make_ready(&self, first: u32) -> Result<(), GpuError> {
        let Some(new) = self.images().get(first as usize..).filter(|new| !new.is_empty()) else {
            return Ok(());
        };
        let submit = self.gpu.submit(|recorder| {
            for &image in new {
                recorder.barrier(&APP_CREATED, image, self.shape.array_layers);
            }
            Ok(())
        })?;
        (first..self.images().len() as u32).for_each(|image| self.mark(image, submit));
        Ok(())
    }

    /// Destroys the images from number `count` on, which neither the application nor any work of ours has used.
    pub fn shrink(&self, count: u32) {
        self.count.fetch_min(count as usize, Ordering::Relaxed);
        let views = count.saturating_mul(self.shape.array_layers) as usize;
        self.views.lock().unwrap_or_else(PoisonError::into_inner).truncate(views);
        self.images.lock().unwrap_or_else(PoisonError::into_inner).truncate(count as usize);
    }

    /// Notes that the submit of this number uses an image.
    pub(in crate::kernels) fn mark(&self, image: u32, submit: u64) {
        self.uses.mark(submit);
        if let Some(last) = self.last_uses.get(image as usize) {
            last.fetch_max(submit, Ordering::Relaxed);
        }
    }

    /// Whether the GPU is done with all work of ours on an image. Waits for nothing.
    pub fn is_free(&self, image: u32) -> bool {
        let last = self.last_uses.get(image as usize).map_or(0, |last| last.load(Ordering::Relaxed));
        !self.gpu.is_under_way(last)
    }

    /// Memory of one of the images, bytes.
    pub fn image_bytes(&self) -> u64 {
        self.bytes
    }

    /// The images, in order.
    pub fn images(&self) -> &[vk::Image] {
        &self.handles[..self.count.load(Ordering::Relaxed)]
    }

    /// The application left an image in this layout, and expects it so.
    pub fn left_in(&self, image: u32, layout: vk::ImageLayout) {
        if let Some(known) = self.layouts.get(image as usize) {
            known.store(layout.as_raw(), Ordering::Relaxed);
        }
    }

    /// The layout of an image outside of our work.
    pub(in crate::kernels) fn layout(&self, image: usize) -> vk::ImageLayout {
        let known = self.layouts.get(image).map(|known| known.load(Ordering::Relaxed));
        known.map_or(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL, vk::ImageLayout::from_raw)
    }

    pub(in crate::kernels) fn shape(&self) -> &SwapchainShape {
        &self.shape
    }

    /// No other images have it.
    pub(in crate::kernels) fn serial(&self) -> u64 {
        self.serial
    }

    /// The descriptor set that reads a layer of an image.
    pub(in crate::kernels) fn texture(&self, image: u32, layer: u32) -> Option<vk::DescriptorSet> {
        self.textures.get((image * self.shape.array_layers + layer) as usize)
    }
}
