//! Images, each with one view of all of it.

use super::{Gpu, Made};
use anyhow::{Context, Result};
use ash::vk;

/// The format of depth everywhere.
pub const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

/// An image, or some layers of it, and its view.
#[derive(Clone, Copy, Debug)]
pub struct Image {
    pub handle: vk::Image,
    pub view: vk::ImageView,
    pub format: vk::Format,
    pub extent: [u32; 2],
    pub base_layer: u32,
    pub layers: u32,
    pub base_level: u32,
    pub levels: u32,
    pub samples: u32,
    /// Usage of its view.
    pub usage: vk::ImageUsageFlags,
}

/// Description of an image; [`Gpu::image`] makes it.
#[derive(Clone, Copy)]
pub struct ImageSpec {
    pub format: vk::Format,
    pub extent: [u32; 2],
    pub layers: u32,
    pub levels: u32,
    pub samples: u32,
    pub usage: vk::ImageUsageFlags,
    pub flags: vk::ImageCreateFlags,
}

impl ImageSpec {
    /// A render target that can be sampled and copied.
    pub fn new(format: vk::Format, extent: [u32; 2]) -> Self {
        let attachment = if is_depth(format) {
            vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT
        } else {
            vk::ImageUsageFlags::COLOR_ATTACHMENT
        };
        Self {
            format,
            extent,
            layers: 1,
            levels: 1,
            samples: 1,
            usage: attachment | vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_SRC,
            flags: vk::ImageCreateFlags::empty(),
        }
    }

    /// Depth that nothing reads after its pass.
    pub fn depth(extent: [u32; 2]) -> Self {
        Self::new(DEPTH, extent).usage(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT)
    }

    pub fn layers(self, layers: u32) -> Self {
        Self { layers, ..self }
    }

    pub fn samples(self, samples: u32) -> Self {
        Self { samples, ..self }
    }

    pub fn usage(self, usage: vk::ImageUsageFlags) -> Self {
        Self { usage, ..self }
    }
}

impl Image {
    /// Subresource range of the view.
    pub fn range(&self) -> vk::ImageSubresourceRange {
        vk::ImageSubresourceRange {
            aspect_mask: aspect(self.format),
            base_mip_level: self.base_level,
            level_count: self.levels,
            base_array_layer: self.base_layer,
            layer_count: self.layers,
        }
    }

    /// One of its levels, for barriers: the view stays.
    pub fn level(&self, level: u32) -> Self {
        Self { base_level: level, levels: 1, ..*self }
    }

    /// Its largest level, for copies.
    pub fn subresource(&self) -> vk::ImageSubresourceLayers {
        vk::ImageSubresourceLayers {
            aspect_mask: aspect(self.format),
            mip_level: 0,
            base_array_layer: self.base_layer,
            layer_count: self.layers,
        }
    }
}

impl Gpu {
    /// Makes an image with memory of its own and a view, and keeps them.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn image(&self, spec: &ImageSpec) -> Result<Image> {
        let info = vk::ImageCreateInfo::default()
            .flags(spec.flags)
            .image_type(vk::ImageType::TYPE_2D)
            .format(spec.format)
            .extent(vk::Extent3D { width: spec.extent[0], height: spec.extent[1], depth: 1 })
            .mip_levels(spec.levels)
            .array_layers(spec.layers)
            .samples(vk::SampleCountFlags::from_raw(spec.samples))
            .usage(spec.usage)
            .sharing_mode(self.sharing().0)
            .queue_family_indices(self.sharing().1);
        // SAFETY: the structure outlives the call.
        let handle = unsafe { self.device.create_image(&info, None) }?;
        self.keep(Made::Image(handle));
        // SAFETY: the image is live.
        let needs = unsafe { self.device.get_image_memory_requirements(handle) };
        let memory = self.memory(needs, vk::MemoryPropertyFlags::DEVICE_LOCAL)?;
        // SAFETY: both are live; the memory is as large and of the type that the image needs.
        unsafe { self.device.bind_image_memory(handle, memory, 0) }?;
        let ImageSpec { format, extent, layers, levels, samples, usage, .. } = *spec;
        let view = vk::ImageView::null();
        let (base_layer, base_level) = (0, 0);
        let image =
            Image { handle, view, format, extent, base_layer, layers, base_level, levels, samples, usage };
        let image = self.viewed(&image)?;
        self.keep(Made::View(image.view));
        Ok(image)
    }

    /// The same image with a new view by its description, for its usage alone. The caller destroys the view.
    ///
    /// # Errors
    /// Errors of vkCreateImageView.
    pub fn viewed(&self, image: &Image) -> Result<Image> {
        let view_type =
            if image.layers == 1 { vk::ImageViewType::TYPE_2D } else { vk::ImageViewType::TYPE_2D_ARRAY };
        let mut usage = vk::ImageViewUsageCreateInfo::default().usage(image.usage);
        let info = vk::ImageViewCreateInfo::default()
            .image(image.handle)
            .view_type(view_type)
            .format(image.format)
            .subresource_range(image.range())
            .push_next(&mut usage);
        // SAFETY: the image is live, and the structures outlive the call.
        let view = unsafe { self.device.create_image_view(&info, None) }?;
        Ok(Image { view, ..*image })
    }

    pub(super) fn memory(
        &self,
        needs: vk::MemoryRequirements,
        properties: vk::MemoryPropertyFlags,
    ) -> Result<vk::DeviceMemory> {
        let types = &self.memory.memory_types[..self.memory.memory_type_count as usize];
        let index = (0_u32..)
            .zip(types)
            .position(|(index, ty)| {
                needs.memory_type_bits & (1 << index) != 0 && ty.property_flags.contains(properties)
            })
            .context("no memory of a type that is needed")?;
        let mut flags = vk::MemoryAllocateFlagsInfo::default().flags(vk::MemoryAllocateFlags::DEVICE_ADDRESS);
        let mut info =
            vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(index as u32);
        if self.has_addresses {
            info = info.push_next(&mut flags);
        }
        // SAFETY: the structure outlives the call.
        let memory = unsafe { self.device.allocate_memory(&info, None) }?;
        self.keep(Made::Memory(memory));
        Ok(memory)
    }
}

pub(super) fn is_depth(format: vk::Format) -> bool {
    matches!(format, vk::Format::D16_UNORM | vk::Format::D32_SFLOAT)
}

fn aspect(format: vk::Format) -> vk::ImageAspectFlags {
    if is_depth(format) { vk::ImageAspectFlags::DEPTH } else { vk::ImageAspectFlags::COLOR }
}
