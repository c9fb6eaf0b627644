//! Copies of maps, made ahead of the passes that read them.

use super::image::Range;
use super::lower;
use ash::vk;

/// A buffer of one map, which stays mapped.
#[derive(Clone, Copy)]
pub(super) struct Capture {
    buffer: vk::Buffer,
    memory: vk::DeviceMemory,
    size: vk::DeviceSize,
    /// Address of its mapped memory.
    address: usize,
}

/// The buffers that are not in use.
pub(super) struct Captures {
    memory: vk::PhysicalDeviceMemoryProperties,
    free: Vec<Capture>,
}

impl Captures {
    pub fn new(memory: vk::PhysicalDeviceMemoryProperties) -> Self {
        Self { memory, free: Vec::new() }
    }

    /// A buffer of that size, if the device has memory for it.
    ///
    /// # Safety
    ///
    /// The device is live.
    pub unsafe fn take(&mut self, device: &ash::Device, size: vk::DeviceSize) -> Option<Capture> {
        if let Some(index) = self.free.iter().position(|capture| capture.size == size) {
            return Some(self.free.swap_remove(index));
        }
        let _no_ones = crate::faults::StandIn::new();
        // SAFETY: the caller vouches for the device; after a failure half-way, the objects are not used any more.
        unsafe {
            let info = vk::BufferCreateInfo::default().size(size).usage(vk::BufferUsageFlags::TRANSFER_DST);
            let buffer = device.create_buffer(&info, None).ok()?;
            let needs = device.get_buffer_memory_requirements(buffer);
            let host = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
            let index = (0..self.memory.memory_type_count).find(|&index| {
                let flags = self.memory.memory_types[index as usize].property_flags;
                needs.memory_type_bits & (1 << index) != 0 && flags.contains(host)
            });
            let info = vk::MemoryAllocateInfo::default().allocation_size(needs.size);
            let allocated =
                index.and_then(|index| device.allocate_memory(&info.memory_type_index(index), None).ok());
            let Some(memory) = allocated else {
                device.destroy_buffer(buffer, None);
                return None;
            };
            let bound = device.bind_buffer_memory(buffer, memory, 0);
            let mapped =
                bound.and_then(|()| device.map_memory(memory, 0, vk::WHOLE_SIZE, Default::default()));
            match mapped {
                Ok(address) => Some(Capture { buffer, memory, size, address: address as usize }),
                Err(_) => {
                    device.destroy_buffer(buffer, None);
                    device.free_memory(memory, None);
                    None
                }
            }
        }
    }

    pub fn give_back(&mut self, capture: Capture) {
        self.free.push(capture);
    }

    /// # Safety
    ///
    /// The device is live, and none of its work uses a buffer.
    pub unsafe fn destroy(&mut self, device: &ash::Device) {
        for capture in self.free.drain(..) {
            // SAFETY: the caller vouches for it.
            unsafe {
                device.destroy_buffer(capture.buffer, None);
                device.free_memory(capture.memory, None);
            }
        }
    }
}

impl Capture {
    /// The bytes of the map.
    ///
    /// # Safety
    ///
    /// The copy has completed, and nothing submits it again while the result lives.
    pub unsafe fn bytes(&self) -> &[u8] {
        // SAFETY: the memory is mapped, coherent and has that size; the caller vouches for the device.
        unsafe { std::slice::from_raw_parts(self.address as *const u8, self.size as usize) }
    }
}

/// Records a copy of a map, which is in `layout`, and stays in it.
///
/// The copy takes the place of the read by the rate stage, which `lower` replaced by the fragment shader: it
/// is ordered behind that stage by a barrier ahead, and the stage behind it by another.
///
/// # Safety
///
/// The buffer is in the recording state and outside of passes; the image is live.
pub(super) unsafe fn copy(
    device: &ash::Device,
    buffer: vk::CommandBuffer,
    capture: &Capture,
    (image, range, extent): (vk::Image, Range, vk::Extent2D),
    layout: vk::ImageLayout,
    (stages, access): (vk::PipelineStageFlags2, vk::AccessFlags2),
) {
    let (fragment, transfer) = (vk::PipelineStageFlags::FRAGMENT_SHADER, vk::PipelineStageFlags::TRANSFER);
    let general = vk::ImageLayout::GENERAL;
    let whole = vk::ImageSubresourceRange {
        aspect_mask: vk::ImageAspectFlags::COLOR,
        base_mip_level: range.level,
        level_count: 1,
        base_array_layer: range.layer,
        layer_count: range.layers,
    };
    let layers = vk::ImageSubresourceLayers {
        aspect_mask: vk::ImageAspectFlags::COLOR,
        mip_level: range.level,
        base_array_layer: range.layer,
        layer_count: range.layers,
    };
    let of_image = vk::ImageMemoryBarrier::default()
        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .image(image)
        .subresource_range(whole);
    let before = of_image
        .old_layout(layout)
        .new_layout(general)
        .src_access_mask(lower::access(narrow_access(access)) | vk::AccessFlags::SHADER_READ)
        .dst_access_mask(vk::AccessFlags::TRANSFER_READ);
    let after = of_image.old_layout(general).new_layout(layout).dst_access_mask(vk::AccessFlags::SHADER_READ);
    let of_buffer = vk::BufferMemoryBarrier::default()
        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .buffer(capture.buffer)
        .size(vk::WHOLE_SIZE)
        .src_access_mask(vk::AccessFlags::TRANSFER_WRITE);
    let again = of_buffer.dst_access_mask(vk::AccessFlags::TRANSFER_WRITE);
    let read = of_buffer.dst_access_mask(vk::AccessFlags::HOST_READ);
    let region = vk::BufferImageCopy::default().image_subresource(layers).image_extent(extent.into());
    let waits_for = lower::stages(narrow(stages)) | fragment;
    let (host, none) = (vk::PipelineStageFlags::HOST, vk::DependencyFlags::empty());
    // SAFETY: the caller vouches for buffer and image; the copy fits the capture, which has a byte a texel.
    unsafe {
        device.cmd_pipeline_barrier(buffer, transfer, transfer, none, &[], &[again], &[]);
        device.cmd_pipeline_barrier(buffer, waits_for, transfer, none, &[], &[], &[before]);
        device.cmd_copy_image_to_buffer(buffer, image, general, capture.buffer, &[region]);
        device.cmd_pipeline_barrier(buffer, transfer, fragment | host, none, &[], &[read], &[after]);
    }
}

/// Stages that have no bit in Vulkan 1.0 become all of them.
fn narrow(stages: vk::PipelineStageFlags2) -> vk::PipelineStageFlags {
    match u32::try_from(stages.as_raw()) {
        Ok(bits) => vk::PipelineStageFlags::from_raw(bits),
        Err(_) => vk::PipelineStageFlags::ALL_COMMANDS,
    }
}

fn narrow_access(access: vk::AccessFlags2) -> vk::AccessFlags {
    match u32::try_from(access.as_raw()) {
        Ok(bits) => vk::AccessFlags::from_raw(bits),
        Err(_) => vk::AccessFlags::MEMORY_WRITE,
    }
}
