//! Types of Vulkan: all types of `ash`, and types of newer extensions.

#![allow(non_camel_case_types, reason = "names of the specification, as `ash` has them")]

use std::ffi::c_void;

pub use ash::vk::*;

/// A command with an opaque structure: the draws of VK_KHR_device_address_commands, and `vkCmdBeginConditionalRendering2EXT`.
pub type PFN_vkCmdWithInfo = unsafe extern "system" fn(CommandBuffer, info: *const c_void);

/// `vkCmdDrawIndirectByteCount2EXT` (VK_KHR_device_address_commands).
pub type PFN_vkCmdDrawIndirectByteCount2EXT = unsafe extern "system" fn(
    CommandBuffer,
    instances: u32,
    first_instance: u32,
    counter: *const c_void,
    counter_offset: u32,
    vertex_stride: u32,
);

/// `vkCmdEndRendering2KHR` (VK_KHR_maintenance10), which began as `vkCmdEndRendering2EXT` (VK_EXT_fragment_density_map_offset).
pub type PFN_vkCmdEndRendering2 = unsafe extern "system" fn(CommandBuffer, info: *const c_void);

/// `vkCmdBindSamplerHeapEXT` and `vkCmdBindResourceHeapEXT` (VK_EXT_descriptor_heap).
pub type PFN_vkCmdBindHeap = unsafe extern "system" fn(CommandBuffer, *const BindHeapInfo);

/// `vkCmdPushDataEXT` (VK_EXT_descriptor_heap).
pub type PFN_vkCmdPushData = unsafe extern "system" fn(CommandBuffer, *const PushDataInfo);

/// `vkCmdExecuteGeneratedCommandsEXT` (VK_EXT_device_generated_commands).
pub type PFN_vkCmdExecuteGeneratedCommandsEXT =
    unsafe extern "system" fn(CommandBuffer, is_preprocessed: Bool32, *const GeneratedCommandsInfo);

/// `VkBindHeapInfoEXT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BindHeapInfo {
    /// `VK_STRUCTURE_TYPE_BIND_HEAP_INFO_EXT`.
    pub s_type: StructureType,
    /// A chain of extensions, or null.
    pub p_next: *const c_void,
    /// Address and size.
    pub heap: [u64; 2],
    /// Offset and size of the driver's own range.
    pub reserved: [u64; 2],
}

/// `VkPushDataInfoEXT`.
#[repr(C)]
pub struct PushDataInfo {
    /// `VK_STRUCTURE_TYPE_PUSH_DATA_INFO_EXT`.
    pub s_type: StructureType,
    /// A chain of extensions, or null.
    pub p_next: *const c_void,
    /// Offset in push data, bytes.
    pub offset: u32,
    /// The bytes.
    pub data: *const c_void,
    /// Number of bytes.
    pub size: usize,
}

/// The beginning of `VkGeneratedCommandsInfoEXT`.
#[repr(C)]
pub struct GeneratedCommandsInfo {
    /// `VK_STRUCTURE_TYPE_GENERATED_COMMANDS_INFO_EXT`.
    pub s_type: StructureType,
    /// A chain of extensions, or null.
    pub p_next: *const c_void,
    /// Stages of the commands.
    pub shader_stages: ShaderStageFlags,
    /// A set of pipelines or shaders for generated commands; 0: the bound ones draw.
    pub indirect_execution_set: u64,
}

/// `VK_PIPELINE_CREATE_2_CAPTURE_DATA_BIT_KHR` (VK_KHR_pipeline_binary).
pub const PIPELINE_CREATE_2_CAPTURE_DATA_KHR: PipelineCreateFlags2KHR =
    PipelineCreateFlags2KHR::from_raw(0x8000_0000);

/// `VkPipelineBinaryInfoKHR`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PipelineBinaryInfo {
    /// `VK_STRUCTURE_TYPE_PIPELINE_BINARY_INFO_KHR`.
    pub s_type: StructureType,
    /// A chain of extensions, or null.
    pub p_next: *const c_void,
    /// Number of binaries.
    pub count: u32,
    /// Their handles.
    pub binaries: *const u64,
}

// SAFETY: begins as all structures of chains do, and the type is that of the specification.
unsafe impl TaggedStructure for PipelineBinaryInfo {
    const STRUCTURE_TYPE: StructureType = StructureType::from_raw(1_000_483_002);
}
