//! Copies of the depth of the last pictures, made before the application returns it to the runtime.

use super::ImageMemory;
use crate::gpu::barrier::{
    DEPTH_COPIED_TO_WRITTEN, DEPTH_WRITTEN_TO_COPIED, KEPT_DEPTH_COPIED_TO_READ, KEPT_DEPTH_READ_TO_COPIED,
};
use crate::gpu::{
    Gpu, GpuError, ImageDescription, Owned, OwnedImage, Purpose, RecordingKey, TextureSets, Uses, depth_view,
    serial,
};
use ash::vk;
use parafovea_core::kernels::compose::DepthRect;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Usage of the runtime's images, so that their depth can be copied.
pub const DEPTH_USAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::TRANSFER_SRC;

/// Properties of depth images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DepthShape {
    /// Their format.
    pub format: vk::Format,
    /// Size, pixels.
    pub extent: vk::Extent2D,
    /// Array layers.
    pub array_layers: u32,
}

/// The runtime's images of a swapchain with depth, and the copies.
pub struct DepthSource {
    // First: waits before the runtime's images go.
    uses: Uses,
    images: Vec<vk::Image>,
    kept: Arc<KeptDepth>,
    serial: u64,
}

/// Copies of the depth of the last pictures, in turn.
pub struct KeptDepth {
    // First: waits before the rest is destroyed. The others in the order in which each may be destroyed.
    uses: Uses,
    textures: TextureSets,
    _views: Vec<Owned<vk::ImageView>>,
    _images: Vec<OwnedImage>,
    handles: Vec<vk::Image>,
    aspects: vk::ImageAspectFlags,
    shape: DepthShape,
    /// Memory of one of them.
    bytes: u64,
    /// Number of copies made.
    copies: AtomicU64,
    serial: u64,
    gpu: Arc<Gpu>,
}

impl fmt::Debug for KeptDepth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("KeptDepth").field("shape", &self.shape).finish_non_exhaustive()
    }
}

/// The depth of a picture.
#[derive(Clone, Copy, Debug)]
pub struct PictureDepth<'a> {
    /// The copies of which it is one.
    pub kept: &'a KeptDepth,
    /// Number of that copy, counted from 1.
    pub copy: u64,
    /// The array layer.
    pub array_layer: u32,
    /// The rectangle.
    pub rect: DepthRect,
}

impl DepthSource {
    /// With room for `count` copies, at least 1, of `images` of that shape, which live until the result is dropped.
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] where depth of that format cannot be read, or the format has none; a failed call.
    pub fn new(
        gpu: &Arc<Gpu>,
        shape: &DepthShape,
        images: Vec<vk::Image>,
        count: u32,
    ) -> Result<Self, GpuError> {
        Self::within(gpu, shape, images, count, |_| true)
    }

    /// The same if `fits` returns so for the memory of one copy.
    ///
    /// # Errors
    /// As there; [`GpuError::Unsupported`] if it does not fit.
    pub fn within(
        gpu: &Arc<Gpu>,
        shape: &DepthShape,
        images: Vec<vk::Image>,
        count: u32,
        fits: impl FnOnce(ImageMemory) -> bool,
    ) -> Result<Self, GpuError> {
        let kept = Arc::new(KeptDepth::new(gpu, shape, count, fits)?);
        Ok(Self { uses: Uses::new(gpu), images, kept, serial: serial() })
    }

    /// Copies the depth of an image that the application has written, left in `layout`, and releases next. It is in that layout again after
    /// the copy. Returns the number of the copy, from 1.
    ///
    /// # Errors
    /// [`GpuError::Invalid`] for an index out of range, [`GpuError::Timeout`] when earlier submits hang; a failed call.
    pub fn copy(&self, index: u32, layout: vk::ImageLayout) -> Result<u64, GpuError> {
        let KeptDepth { handles, aspects, shape, copies, gpu, uses, .. } = &*self.kept;
        let from =
            *self.images.get(index as usize).ok_or(GpuError::Invalid("an image index out of range"))?;
        let copy = copies.load(Ordering::Relaxed) + 1;
        let to = handles[self.kept.slot(copy)];
        let layers = shape.array_layers;
        // Stored first: during the copy, no reader relies on the depth that it overwrites.
        copies.store(copy, Ordering::Relaxed);
        let slot = self.kept.slot(copy) as u64;
        let key = RecordingKey::from_slice(&[self.serial, index.into(), slot, layout.as_raw() as u64]);
        let left = aspects_in(layout, *aspects);
        let submit = gpu.next_submit(Purpose::Depth)?.submit(Some(&key), |recorder| {
            recorder.barrier_of(&DEPTH_WRITTEN_TO_COPIED.depth_left_in(layout), from, left, layers);
            recorder.barrier_of(&KEPT_DEPTH_READ_TO_COPIED, to, *aspects, layers);
            recorder.copy_aspect(vk::ImageAspectFlags::DEPTH, [from, to], shape.extent, layers);
            recorder.barrier_of(&DEPTH_COPIED_TO_WRITTEN.depth_left_in(layout), from, left, layers);
            recorder.barrier_of(&KEPT_DEPTH_COPIED_TO_READ, to, *aspects, layers);
            Ok(())
        })?;
        uses.mark(submit);
        self.uses.mark(submit);
        Ok(copy)
    }

    /// The copies.
    pub fn kept(&self) -> &Arc<KeptDepth> {
        &self.kept
    }
}

impl KeptDepth {
    fn new(
        gpu: &Arc<Gpu>,
        shape: &DepthShape,
        count: u32,
        fits: impl FnOnce(ImageMemory) -> bool,
    ) -> Result<Self, GpuError> {
        let DepthShape { format, extent, array_layers } = *shape;
        let aspects = aspects(format).ok_or(GpuError::Unsupported("a format without depth"))?;
        let description = ImageDescription {
            format,
            samples: vk::SampleCountFlags::TYPE_1,
            extent,
            array_layers,
            usage: vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST,
            mutable: false,
            view_formats: &[],
        };
        let uses = Uses::new(gpu);
        let first = OwnedImage::new(gpu, &description)?;
        let (bytes, heap) = first.memory();
        if !fits(ImageMemory { bytes, remaining: gpu.remaining_memory(heap) }) {
            return Err(GpuError::Unsupported("depth of this size"));
        }
        let others = (1..count).map(|_| OwnedImage::new(gpu, &description));
        let images = std::iter::once(Ok(first)).chain(others).collect::<Result<Vec<_>, GpuError>>()?;
        let handles: Vec<vk::Image> = images.iter().map(OwnedImage::handle).collect();
        let views = handles
            .iter()
            .flat_map(|&image| (0..array_layers).map(move |layer| (image, layer)))
            .map(|(image, layer)| depth_view(gpu, image, format, layer))
            .collect::<Result<Vec<_>, GpuError>>()?;
        let textures = TextureSets::new(gpu, &views)?;
        Ok(Self {
            uses,
            textures,
            _views: views,
            _images: images,
            handles,
            aspects,
            shape: *shape,
            bytes,
            copies: AtomicU64::new(0),
            serial: serial(),
            gpu: Arc::clone(gpu),
        })
    }

    /// Whether a copy is still there.
    pub fn has_copy(&self, copy: u64) -> bool {
        let copies = self.copies.load(Ordering::Relaxed);
        (1..=copies).contains(&copy) && copies < copy + self.handles.len() as u64
    }

    /// Memory of all copies, bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes * self.handles.len() as u64
    }

    /// Properties of the images.
    pub fn shape(&self) -> &DepthShape {
        &self.shape
    }

    fn slot(&self, copy: u64) -> usize {
        (copy % self.handles.len() as u64) as usize
    }
}

impl PictureDepth<'_> {
    /// Refuses an image that does not exist.
    pub(super) fn check(&self) -> Result<(), GpuError> {
        let DepthShape { extent, array_layers, .. } = self.kept.shape;
        let DepthRect { offset, extent: size } = self.rect;
        let fits = |axis: usize, limit: u32| {
            size[axis] > 0 && offset[axis].checked_add(size[axis]).is_some_and(|end| end <= limit)
        };
        let is_inside = fits(0, extent.width) && fits(1, extent.height) && self.array_layer < array_layers;
        match is_inside && self.kept.has_copy(self.copy) {
            true => Ok(()),
            false => Err(GpuError::Invalid("missing depth")),
        }
    }

    /// The descriptor set that reads it.
    pub(in crate::kernels) fn texture(&self) -> Option<vk::DescriptorSet> {
        let layers = self.kept.shape.array_layers as usize;
        self.kept.textures.get(self.kept.slot(self.copy) * layers + self.array_layer as usize)
    }

    /// The part of a key that stands for [`Self::texture`].
    pub(in crate::kernels) fn key(&self) -> [u64; 2] {
        [self.kept.serial, (self.kept.slot(self.copy) as u64) << 32 | u64::from(self.array_layer)]
    }

    /// Notes that a submit of that number reads it.
    pub(super) fn mark(&self, submit: u64) {
        self.kept.uses.mark(submit);
    }
}

/// Aspects of `aspects` in `layout`, which may be of depth alone.
fn aspects_in(layout: vk::ImageLayout, aspects: vk::ImageAspectFlags) -> vk::ImageAspectFlags {
    match layout {
        vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL | vk::ImageLayout::DEPTH_READ_ONLY_OPTIMAL => {
            vk::ImageAspectFlags::DEPTH
        }
        _ => aspects,
    }
}

/// The aspects of a format with depth.
fn aspects(format: vk::Format) -> Option<vk::ImageAspectFlags> {
    let (depth, stencil) = (vk::ImageAspectFlags::DEPTH, vk::ImageAspectFlags::STENCIL);
    match format {
        vk::Format::D16_UNORM | vk::Format::X8_D24_UNORM_PACK32 | vk::Format::D32_SFLOAT => Some(depth),
        vk::Format::D16_UNORM_S8_UINT | vk::Format::D24_UNORM_S8_UINT | vk::Format::D32_SFLOAT_S8_UINT => {
            Some(depth | stencil)
        }
        _ => None,
    }
}
