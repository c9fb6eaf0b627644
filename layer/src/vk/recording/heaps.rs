//! Descriptor heaps and push data (VK_EXT_descriptor_heap), so that they can be bound again after work of ours between the application's
//! commands. DXVK uses them on AMD's GPUs, and vkd3d-proton on request.
//!
//! That work binds descriptor sets, which invalidates all heap state (Vulkan specification, vkCmdPushDataEXT), as do the application's own
//! sets and push constants.

use super::descriptor_buffers::note;
use super::{drawing, with_buffer};
use crate::abi::copies::slice;
use crate::abi::pnext::chain;
use crate::vk::functions::ArmedTable;
use crate::vk::newer::{BindHeapInfo, PushDataInfo};
use ash::vk;
use smallvec::SmallVec;
use std::ffi::c_void;

/// `VK_STRUCTURE_TYPE_BIND_HEAP_INFO_EXT`.
const BIND_HEAP_INFO: vk::StructureType = vk::StructureType::from_raw(1_000_135_003);

/// `VK_STRUCTURE_TYPE_PUSH_DATA_INFO_EXT`.
const PUSH_DATA_INFO: vk::StructureType = vk::StructureType::from_raw(1_000_135_004);

/// `VK_STRUCTURE_TYPE_COMMAND_BUFFER_INHERITANCE_DESCRIPTOR_HEAP_INFO_EXT`.
const INHERITANCE_INFO: vk::StructureType = vk::StructureType::from_raw(1_000_135_010);

/// The heaps of a command buffer, and its push data.
#[derive(Debug, Clone, Default)]
pub struct BoundHeaps {
    sampler: Option<HeapRange>,
    resource: Option<HeapRange>,
    /// From offset 0 on.
    data: SmallVec<[u8; 256]>,
    /// Whether a bind or a push had a chain of extensions, which cannot be repeated.
    has_more: bool,
}

/// A bound heap.
#[derive(Clone, Copy, Debug, PartialEq)]
struct HeapRange {
    /// Address and size.
    heap: [u64; 2],
    /// Offset and size of the driver's own range.
    reserved: [u64; 2],
}

/// A heap of resources or of samplers.
#[derive(Clone, Copy)]
enum Kind {
    Sampler,
    Resource,
}

impl BoundHeaps {
    /// Forgets all, as other descriptors are bound; the memory stays.
    pub fn clear(&mut self) {
        self.sampler = None;
        self.resource = None;
        self.data.clear();
        self.has_more = false;
    }

    /// Whether no heap is bound and no data pushed.
    pub fn is_empty(&self) -> bool {
        self.sampler.is_none() && self.resource.is_none() && self.data.is_empty() && !self.has_more
    }

    /// Whether [`Self::restore`] binds everything again.
    pub fn is_complete(&self) -> bool {
        !self.has_more
    }

    fn bind(&mut self, kind: Kind, info: &BindHeapInfo) {
        if !info.p_next.is_null() {
            self.has_more = true;
            return;
        }
        let range = Some(HeapRange { heap: info.heap, reserved: info.reserved });
        match kind {
            Kind::Sampler => self.sampler = range,
            Kind::Resource => self.resource = range,
        }
    }

    /// Data is pushed from an offset on.
    pub(super) fn push(&mut self, offset: usize, bytes: &[u8]) {
        let end = offset + bytes.len();
        if self.data.len() < end {
            self.data.resize(end, 0);
        }
        self.data[offset..end].copy_from_slice(bytes);
    }

    /// Binds and pushes it again, with the next layer's functions. Data that was never pushed becomes 0.
    ///
    /// # Safety
    ///
    /// `commands` is recording, and these calls were recorded in it.
    pub unsafe fn restore(&self, next: &ArmedTable, commands: vk::CommandBuffer) {
        let heaps = [
            (self.sampler.as_ref(), next.cmd_bind_sampler_heap),
            (self.resource.as_ref(), next.cmd_bind_resource_heap),
        ];
        for (range, bind) in heaps {
            if let (Some(&HeapRange { heap, reserved }), Some(bind)) = (range, bind) {
                let info = BindHeapInfo { s_type: BIND_HEAP_INFO, p_next: std::ptr::null(), heap, reserved };
                // SAFETY: the command buffer is recording, as `# Safety` demands; heaps of its earlier calls stay valid while it records.
                unsafe { bind(commands, &info) };
            }
        }
        if let (Some(push), false) = (next.cmd_push_data, self.data.is_empty()) {
            let info = PushDataInfo {
                s_type: PUSH_DATA_INFO,
                p_next: std::ptr::null(),
                offset: 0,
                data: self.data.as_ptr().cast(),
                size: self.data.len(),
            };
            // SAFETY: the command buffer is recording, as above; the data is as long as the application's own calls.
            unsafe { push(commands, &info) };
        }
    }
}

/// Whether a secondary command buffer has the heaps of the primary one.
///
/// # Safety
///
/// The valid usage of vkBeginCommandBuffer for a secondary command buffer.
pub unsafe fn are_inherited(info: &vk::CommandBufferBeginInfo<'_>) -> bool {
    // SAFETY: the pointer is null or valid, and so is its chain, as `# Safety` demands.
    let mut structures = unsafe {
        let inherited = info.p_inheritance_info.as_ref();
        chain(inherited.map_or(std::ptr::null(), |inherited| inherited.p_next))
    };
    structures.any(|structure| structure.ty == INHERITANCE_INFO.as_raw())
}

/// `vkCmdBindSamplerHeapEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn bind_samplers(handle: vk::CommandBuffer, info: *const BindHeapInfo) {
    hook!("vkCmdBindSamplerHeapEXT", with_buffer, cmd_bind_sampler_heap(handle, info), |known, next| {
        // SAFETY: the command buffer is recording, by valid usage.
        unsafe { drawing::leave_for_command(known.as_deref(), handle) };
        next();
        if let Some(known) = known {
            // SAFETY: the structure is valid, by valid usage.
            let info = unsafe { &*info };
            note(&known, handle, &[], |kept| kept.heaps().bind(Kind::Sampler, info));
        }
    });
}

/// `vkCmdBindResourceHeapEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn bind_resources(handle: vk::CommandBuffer, info: *const BindHeapInfo) {
    hook!("vkCmdBindResourceHeapEXT", with_buffer, cmd_bind_resource_heap(handle, info), |known, next| {
        // SAFETY: the command buffer is recording, by valid usage.
        unsafe { drawing::leave_for_command(known.as_deref(), handle) };
        next();
        if let Some(known) = known {
            let points = [vk::PipelineBindPoint::GRAPHICS];
            // SAFETY: the structure is valid, by valid usage.
            let info = unsafe { &*info };
            note(&known, handle, &points, |kept| kept.heaps().bind(Kind::Resource, info));
        }
    });
}

/// `vkCmdPushDataEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn push_data(handle: vk::CommandBuffer, info: *const PushDataInfo) {
    hook!("vkCmdPushDataEXT", with_buffer, cmd_push_data(handle, info), |known, next| {
        // SAFETY: the command buffer is recording, by valid usage.
        unsafe { drawing::leave_for_command(known.as_deref(), handle) };
        next();
        if let Some(known) = known.filter(|known| known.armed.masks.is_some()) {
            // SAFETY: the structure is valid, by valid usage, with so many bytes.
            let (info, bytes) = unsafe { (&*info, slice((*info).data.cast::<u8>(), (*info).size as u32)) };
            let mut recorded = known.recorded();
            let heaps = recorded.offsets.heaps();
            heaps.has_more |= !info.p_next.is_null();
            heaps.push(info.offset as usize, bytes);
        }
    });
}

/// `vkCmdPushConstants`, hooked only where there are heaps and masks: it invalidates heap state.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn push_constants(
    handle: vk::CommandBuffer,
    layout: vk::PipelineLayout,
    stages: vk::ShaderStageFlags,
    offset: u32,
    size: u32,
    values: *const c_void,
) {
    hook!(
        "vkCmdPushConstants",
        with_buffer,
        cmd_push_constants(handle, layout, stages, offset, size, values),
        |known, next| {
            next();
            if let Some(known) = known {
                known.recorded().offsets.heaps().clear();
            }
        }
    );
}

/// `vkCmdPushConstants2`, likewise.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn push_constants2(
    handle: vk::CommandBuffer,
    info: *const vk::PushConstantsInfoKHR<'_>,
) {
    hook!("vkCmdPushConstants2", with_buffer, cmd_push_constants2(handle, info), |known, next| {
        next();
        if let Some(known) = known {
            known.recorded().offsets.heaps().clear();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heap(address: u64) -> BindHeapInfo {
        BindHeapInfo {
            s_type: BIND_HEAP_INFO,
            p_next: std::ptr::null(),
            heap: [address, 64],
            reserved: [0, 16],
        }
    }

    #[test]
    fn heaps_and_data_are_kept_until_others_take_their_place() {
        let mut bound = BoundHeaps::default();
        assert!(bound.is_empty());
        bound.bind(Kind::Resource, &heap(1));
        bound.bind(Kind::Sampler, &heap(2));
        bound.bind(Kind::Resource, &heap(3));
        let addresses = [bound.resource, bound.sampler].map(|range| range.unwrap().heap[0]);
        assert_eq!(addresses, [3, 2]);
        bound.push(4, &[1, 2, 3, 4]);
        bound.push(0, &[5, 6, 7, 8]);
        bound.push(6, &[9]);
        assert_eq!(bound.data.as_slice(), [5, 6, 7, 8, 1, 2, 9, 4]);
        assert!(bound.is_complete() && !bound.is_empty());
        let chain = 0u32;
        bound.bind(Kind::Sampler, &BindHeapInfo { p_next: (&raw const chain).cast(), ..heap(4) });
        assert!(!bound.is_complete());
        bound.clear();
        assert!(bound.is_empty() && bound.is_complete());
    }
}
