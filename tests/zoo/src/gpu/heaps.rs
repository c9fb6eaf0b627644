//! Descriptor heaps (VK_EXT_descriptor_heap), which are newer than the headers of `ash`.

use super::{Buffer, Gpu};
use anyhow::{Context, Result};
use ash::vk;
use std::ffi::{CStr, c_void};
use std::mem::transmute;
use std::ptr::{null, null_mut};

/// `VkPhysicalDeviceDescriptorHeapFeaturesEXT`.
#[repr(C)]
pub struct HeapFeatures {
    s_type: vk::StructureType,
    next: *mut c_void,
    pub descriptor_heap: vk::Bool32,
    capture_replay: vk::Bool32,
}

impl Default for HeapFeatures {
    fn default() -> Self {
        let s_type = vk::StructureType::from_raw(1_000_135_009);
        Self { s_type, next: null_mut(), descriptor_heap: vk::FALSE, capture_replay: vk::FALSE }
    }
}

// SAFETY: the specification allows it in that chain, and it begins as all such structures do.
unsafe impl vk::ExtendsPhysicalDeviceFeatures2 for HeapFeatures {}

/// `VkPhysicalDeviceDescriptorHeapPropertiesEXT`.
#[repr(C)]
struct HeapProperties {
    s_type: vk::StructureType,
    next: *mut c_void,
    sampler_heap_alignment: u64,
    resource_heap_alignment: u64,
    max_sampler_heap_size: u64,
    max_resource_heap_size: u64,
    min_sampler_heap_reserved_range: u64,
    min_sampler_heap_reserved_range_with_embedded: u64,
    min_resource_heap_reserved_range: u64,
    sampler_descriptor_size: u64,
    image_descriptor_size: u64,
    buffer_descriptor_size: u64,
    sampler_descriptor_alignment: u64,
    image_descriptor_alignment: u64,
    buffer_descriptor_alignment: u64,
    max_push_data_size: u64,
    image_capture_replay_opaque_data_size: usize,
    max_descriptor_heap_embedded_samplers: u32,
    sampler_ycbcr_conversion_count: u32,
    sparse_descriptor_heaps: vk::Bool32,
    protected_descriptor_heaps: vk::Bool32,
}

// SAFETY: as for the features.
unsafe impl vk::ExtendsPhysicalDeviceProperties2 for HeapProperties {}

/// `VkBindHeapInfoEXT`.
#[repr(C)]
struct BindHeapInfo {
    s_type: vk::StructureType,
    next: *const c_void,
    address: u64,
    size: u64,
    reserved_offset: u64,
    reserved_size: u64,
}

/// `VkPushDataInfoEXT`.
#[repr(C)]
struct PushDataInfo {
    s_type: vk::StructureType,
    next: *const c_void,
    offset: u32,
    data: *const c_void,
    size: usize,
}

/// `VkResourceDescriptorInfoEXT`, of a buffer.
#[repr(C)]
struct ResourceDescriptorInfo {
    s_type: vk::StructureType,
    next: *const c_void,
    ty: vk::DescriptorType,
    range: *const [u64; 2],
}

/// `VkHostAddressRangeEXT`.
#[repr(C)]
struct HostAddressRange {
    address: *mut c_void,
    size: usize,
}

/// `VkDescriptorSetAndBindingMappingEXT` of binding 0 of set 0, with the descriptor whose number is push data.
#[repr(C)]
struct BindingMapping {
    s_type: vk::StructureType,
    next: *const c_void,
    set: u32,
    first_binding: u32,
    binding_count: u32,
    resources: u32,
    source: i32,
    data: MappingData,
}

/// `VkDescriptorMappingSourceDataEXT`: offset in the heap, offset in push data, and twice the bytes from one descriptor to the next; the rest is
/// of samplers. It holds pointers, too.
#[repr(C, align(8))]
struct MappingData([u32; 14]);

/// `VkShaderDescriptorSetAndBindingMappingInfoEXT`.
#[repr(C)]
struct MappingInfo {
    s_type: vk::StructureType,
    next: *const c_void,
    count: u32,
    mappings: *const BindingMapping,
}

/// Place of the uniforms of a pipeline's shaders in a heap.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct HeapBinding {
    /// Offset of the descriptor's number in push data.
    pub push_offset: u32,
    /// Bytes from one descriptor to the next.
    pub stride: u32,
}

/// `VK_PIPELINE_CREATE_2_DESCRIPTOR_HEAP_BIT_EXT`.
pub const PIPELINE_FLAG: u64 = 1 << 36;

/// `VK_BUFFER_USAGE_DESCRIPTOR_HEAP_BIT_EXT`.
const BUFFER_USAGE: vk::BufferUsageFlags = vk::BufferUsageFlags::from_raw(1 << 28);

impl HeapBinding {
    /// Calls with the chain of shader stages that have it.
    pub fn chained<R>(self, call: impl FnOnce(*const c_void) -> R) -> R {
        const PUSH_INDEX: i32 = 1;
        let mut data = [0; 14];
        data[..4].copy_from_slice(&[0, self.push_offset, self.stride, self.stride]);
        let mapping = BindingMapping {
            s_type: vk::StructureType::from_raw(1_000_135_005),
            next: null(),
            set: 0,
            first_binding: 0,
            binding_count: 1,
            resources: 0x7fff_ffff,
            source: PUSH_INDEX,
            data: MappingData(data),
        };
        let s_type = vk::StructureType::from_raw(1_000_135_006);
        let info = MappingInfo { s_type, next: null(), count: 1, mappings: &raw const mapping };
        call((&raw const info).cast())
    }
}

/// A heap of descriptors of uniform buffers.
pub struct UniformHeap {
    bind: unsafe extern "system" fn(vk::CommandBuffer, *const BindHeapInfo),
    push: unsafe extern "system" fn(vk::CommandBuffer, *const PushDataInfo),
    address: u64,
    size: u64,
    reserved: [u64; 2],
    /// Bytes from one descriptor to the next.
    pub stride: u32,
}

impl UniformHeap {
    /// A heap with descriptors of `count` ranges of a buffer, from `stride` to `stride` bytes, each `size` bytes long.
    ///
    /// # Errors
    /// Errors of the calls, and functions that the device lacks.
    pub fn new(gpu: &Gpu, buffer: &Buffer, (count, stride, size): (usize, usize, usize)) -> Result<Self> {
        let limits = gpu.heap_properties();
        let descriptor = limits.buffer_descriptor_size.next_multiple_of(limits.buffer_descriptor_alignment);
        let reserved = (descriptor * count as u64).next_multiple_of(limits.resource_heap_alignment);
        let heap_size = reserved + limits.min_resource_heap_reserved_range;
        let alignment = limits.resource_heap_alignment;
        let heap = gpu.buffer((heap_size + alignment) as usize, BUFFER_USAGE)?;
        let start = gpu.address(&heap).next_multiple_of(alignment) - gpu.address(&heap);
        let write = gpu.heap_function(c"vkWriteResourceDescriptorsEXT")?;
        // SAFETY: the name gives the type.
        let write = unsafe {
            transmute::<
                unsafe extern "system" fn(),
                unsafe extern "system" fn(
                    vk::Device,
                    u32,
                    *const ResourceDescriptorInfo,
                    *const HostAddressRange,
                ) -> vk::Result,
            >(write)
        };
        for index in 0..count {
            let range = [gpu.address(buffer) + (index * stride) as u64, size as u64];
            let info = ResourceDescriptorInfo {
                s_type: vk::StructureType::from_raw(1_000_135_002),
                next: null(),
                ty: vk::DescriptorType::UNIFORM_BUFFER,
                range: &raw const range,
            };
            let mut bytes = vec![0u8; limits.buffer_descriptor_size as usize];
            let to = HostAddressRange { address: bytes.as_mut_ptr().cast(), size: bytes.len() };
            // SAFETY: both structures and all that they point to are valid.
            unsafe { write(gpu.device.handle(), 1, &info, &to) }.result()?;
            heap.write(start as usize + index * descriptor as usize, &bytes);
        }
        // SAFETY: the names give the types.
        unsafe {
            Ok(Self {
                bind: transmute::<
                    unsafe extern "system" fn(),
                    unsafe extern "system" fn(vk::CommandBuffer, *const BindHeapInfo),
                >(gpu.heap_function(c"vkCmdBindResourceHeapEXT")?),
                push: transmute::<
                    unsafe extern "system" fn(),
                    unsafe extern "system" fn(vk::CommandBuffer, *const PushDataInfo),
                >(gpu.heap_function(c"vkCmdPushDataEXT")?),
                address: gpu.address(&heap) + start,
                size: heap_size,
                reserved: [reserved, limits.min_resource_heap_reserved_range],
                stride: descriptor as u32,
            })
        }
    }

    /// Binds it.
    ///
    /// # Safety
    /// The command buffer is being recorded.
    pub unsafe fn bind(&self, commands: vk::CommandBuffer) {
        let info = BindHeapInfo {
            s_type: vk::StructureType::from_raw(1_000_135_003),
            next: null(),
            address: self.address,
            size: self.size,
            reserved_offset: self.reserved[0],
            reserved_size: self.reserved[1],
        };
        // SAFETY: the command buffer is being recorded, as `# Safety` demands.
        unsafe { (self.bind)(commands, &info) };
    }

    /// Pushes data from an offset on.
    ///
    /// # Safety
    /// The command buffer is being recorded.
    pub unsafe fn push(&self, commands: vk::CommandBuffer, offset: u32, data: &[u8]) {
        let info = PushDataInfo {
            s_type: vk::StructureType::from_raw(1_000_135_004),
            next: null(),
            offset,
            data: data.as_ptr().cast(),
            size: data.len(),
        };
        // SAFETY: the command buffer is being recorded, as `# Safety` demands.
        unsafe { (self.push)(commands, &info) };
    }
}

impl Gpu {
    fn heap_properties(&self) -> HeapProperties {
        // SAFETY: all of its fields may be 0.
        let mut limits: HeapProperties = unsafe { std::mem::zeroed() };
        limits.s_type = vk::StructureType::from_raw(1_000_135_008);
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut limits);
        // SAFETY: the physical device is of this instance, and has the extension.
        unsafe { self.instance.get_physical_device_properties2(self.physical, &mut properties) };
        limits
    }

    fn heap_function(&self, name: &CStr) -> Result<unsafe extern "system" fn()> {
        // SAFETY: the device is live.
        let found = unsafe { self.instance.get_device_proc_addr(self.device.handle(), name.as_ptr()) };
        found.with_context(|| format!("the device lacks {name:?}"))
    }
}
