//! Images of ours, with their memory, and views.

use super::memory::OwnedMemory;
use super::{Gpu, GpuError, ImagePart, Owned};
use ash::vk;
use std::sync::Arc;

/// Properties of an image with one mip level.
pub(crate) struct ImageDescription<'a> {
    pub(crate) format: vk::Format,
    pub(crate) samples: vk::SampleCountFlags,
    pub(crate) extent: vk::Extent2D,
    pub(crate) array_layers: u32,
    pub(crate) usage: vk::ImageUsageFlags,
    /// Whether it gets views of other formats.
    pub(crate) mutable: bool,
    /// All formats that it gets views of, where that is known.
    pub(crate) view_formats: &'a [vk::Format],
}

impl ImageDescription<'_> {
    fn flags(&self) -> vk::ImageCreateFlags {
        if self.mutable { vk::ImageCreateFlags::MUTABLE_FORMAT } else { vk::ImageCreateFlags::empty() }
    }
}

/// An image of ours with memory of its own.
pub(crate) struct OwnedImage {
    // Dropped before the memory that it is bound to.
    image: Owned<vk::Image>,
    memory: OwnedMemory,
}

impl OwnedImage {
    /// Creates the image; its content and layout are undefined.
    pub(crate) fn new(gpu: &Arc<Gpu>, description: &ImageDescription) -> Result<Self, GpuError> {
        check_limits(gpu, description)?;
        let mut list = vk::ImageFormatListCreateInfo::default().view_formats(description.view_formats);
        let mut info = vk::ImageCreateInfo::default()
            .flags(description.flags())
            .image_type(vk::ImageType::TYPE_2D)
            .format(description.format)
            .extent(description.extent.into())
            .mip_levels(1)
            .array_layers(description.array_layers)
            .samples(description.samples)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(description.usage)
            .sharing_mode(vk::SharingMode::EXCLUSIVE)
            .initial_layout(vk::ImageLayout::UNDEFINED);
        // With a list, drivers keep compression; it is part of Vulkan 1.2.
        if !description.view_formats.is_empty() && gpu.api_version >= vk::API_VERSION_1_2 {
            info = info.push_next(&mut list);
        }
        // SAFETY: the device is live, and it takes such an image, as was checked.
        let image = unsafe {
            let handle =
                gpu.device.create_image(&info, None).map_err(GpuError::from_call("vkCreateImage"))?;
            Owned::new(gpu, handle, |device, handle| device.destroy_image(handle, None))
        };
        // SAFETY: the image is a live one of this device.
        let requirements = unsafe { gpu.device.get_image_memory_requirements(image.handle()) };
        let memory = gpu.allocate(&requirements, vk::MemoryPropertyFlags::DEVICE_LOCAL)?;
        // SAFETY: both are new, and the memory meets the image's requirements.
        unsafe { gpu.device.bind_image_memory(image.handle(), memory.handle(), 0) }
            .map_err(GpuError::from_call("vkBindImageMemory"))?;
        Ok(Self { image, memory })
    }

    /// The handle, valid as long as `self`.
    pub(crate) fn handle(&self) -> vk::Image {
        self.image.handle()
    }

    /// Size of its memory, bytes, and the index of the heap.
    pub(crate) fn memory(&self) -> (u64, u32) {
        (self.memory.bytes(), self.memory.heap())
    }
}

/// Asks the device whether it takes such an image: creating one that it does not is undefined behaviour.
fn check_limits(gpu: &Gpu, description: &ImageDescription) -> Result<(), GpuError> {
    // SAFETY: the physical device is one of this live instance.
    let limits = unsafe {
        gpu.instance.get_physical_device_image_format_properties(
            gpu.physical_device,
            description.format,
            vk::ImageType::TYPE_2D,
            vk::ImageTiling::OPTIMAL,
            description.usage,
            description.flags(),
        )
    };
    let limits = match limits {
        Err(vk::Result::ERROR_FORMAT_NOT_SUPPORTED) => {
            return Err(GpuError::Unsupported("this format with this usage"));
        }
        other => other.map_err(GpuError::from_call("vkGetPhysicalDeviceImageFormatProperties"))?,
    };
    let vk::Extent2D { width, height } = description.extent;
    let fits = (1..=limits.max_extent.width).contains(&width)
        && (1..=limits.max_extent.height).contains(&height)
        && (1..=limits.max_array_layers).contains(&description.array_layers)
        && limits.sample_counts.contains(description.samples);
    if fits { Ok(()) } else { Err(GpuError::Unsupported("an image of this size")) }
}

/// A view of one layer of a colour image in the given format.
pub(crate) fn color_view(
    gpu: &Arc<Gpu>,
    image: vk::Image,
    format: vk::Format,
    layer: u32,
) -> Result<Owned<vk::ImageView>, GpuError> {
    layer_view(gpu, image, format, vk::ImageAspectFlags::COLOR, layer, None)
}

/// The same, to be drawn to alone: the image may have usage that its format does not support.
pub(crate) fn attachment_view(
    gpu: &Arc<Gpu>,
    image: vk::Image,
    format: vk::Format,
    layer: u32,
) -> Result<Owned<vk::ImageView>, GpuError> {
    let usage = Some(vk::ImageUsageFlags::COLOR_ATTACHMENT);
    layer_view(gpu, image, format, vk::ImageAspectFlags::COLOR, layer, usage)
}

/// The same, to be sampled alone: the image may have usage that its format does not support.
pub(crate) fn sampled_view(
    gpu: &Arc<Gpu>,
    image: vk::Image,
    format: vk::Format,
    layer: u32,
) -> Result<Owned<vk::ImageView>, GpuError> {
    let usage = Some(vk::ImageUsageFlags::SAMPLED);
    layer_view(gpu, image, format, vk::ImageAspectFlags::COLOR, layer, usage)
}

/// A view of the depth of one layer of an image of a format with depth.
pub(crate) fn depth_view(
    gpu: &Arc<Gpu>,
    image: vk::Image,
    format: vk::Format,
    layer: u32,
) -> Result<Owned<vk::ImageView>, GpuError> {
    layer_view(gpu, image, format, vk::ImageAspectFlags::DEPTH, layer, None)
}

fn layer_view(
    gpu: &Arc<Gpu>,
    image: vk::Image,
    format: vk::Format,
    aspect_mask: vk::ImageAspectFlags,
    layer: u32,
    usage: Option<vk::ImageUsageFlags>,
) -> Result<Owned<vk::ImageView>, GpuError> {
    let mut view_usage = vk::ImageViewUsageCreateInfo::default().usage(usage.unwrap_or_default());
    let mut info = vk::ImageViewCreateInfo::default()
        .image(image)
        .view_type(vk::ImageViewType::TYPE_2D)
        .format(format)
        .subresource_range(vk::ImageSubresourceRange {
            aspect_mask,
            base_mip_level: 0,
            level_count: 1,
            base_array_layer: layer,
            layer_count: 1,
        });
    if usage.is_some() && gpu.api_version >= vk::API_VERSION_1_1 {
        info = info.push_next(&mut view_usage);
    }
    // SAFETY: the image is a live one of this device with this format, aspect and layer.
    unsafe {
        let handle =
            gpu.device.create_image_view(&info, None).map_err(GpuError::from_call("vkCreateImageView"))?;
        Ok(Owned::new(gpu, handle, |device, handle| device.destroy_image_view(handle, None)))
    }
}

/// A view of a part of an image as an array, in the given format and for the given usage alone.
pub(crate) fn array_view(
    gpu: &Arc<Gpu>,
    part: ImagePart,
    format: vk::Format,
    usage: vk::ImageUsageFlags,
) -> Result<Owned<vk::ImageView>, GpuError> {
    let mut usage = vk::ImageViewUsageCreateInfo::default().usage(usage);
    let mut info = vk::ImageViewCreateInfo::default()
        .image(part.image)
        .view_type(vk::ImageViewType::TYPE_2D_ARRAY)
        .format(format)
        .subresource_range(vk::ImageSubresourceRange {
            aspect_mask: part.aspects,
            base_mip_level: part.level,
            level_count: 1,
            base_array_layer: part.first_layer,
            layer_count: part.layers,
        });
    if gpu.api_version >= vk::API_VERSION_1_1 {
        info = info.push_next(&mut usage);
    }
    // SAFETY: the image is a live one of this device that such views may be made of.
    unsafe {
        let handle =
            gpu.device.create_image_view(&info, None).map_err(GpuError::from_call("vkCreateImageView"))?;
        Ok(Owned::new(gpu, handle, |device, handle| device.destroy_image_view(handle, None)))
    }
}
