//! What is bound for compute, so that it can be bound again after work of ours between the application's commands.
//!
//! Hooked only where there is such work: binding is frequent.

use super::with_buffer;
use crate::abi::guard;
use crate::vk::dispatch::ArmedTable;
use ash::vk;
use smallvec::SmallVec;
use std::slice;

/// What a command buffer has bound for compute.
#[derive(Debug, Clone, Default)]
pub struct Bound {
    pipeline: vk::Pipeline,
    /// By the number of the set.
    sets: SmallVec<[Option<Set>; 8]>,
    /// Whether something is bound that is not kept here.
    has_more: bool,
}

/// A descriptor set, as it was bound.
#[derive(Debug, Clone)]
struct Set {
    layout: vk::PipelineLayout,
    handle: vk::DescriptorSet,
    offsets: SmallVec<[u32; 4]>,
}

/// Sets of higher numbers are not kept.
const MOST_SETS: usize = 32;

impl Bound {
    /// Forgets all; the memory stays.
    pub fn clear(&mut self) {
        self.pipeline = vk::Pipeline::null();
        self.sets.clear();
        self.has_more = false;
    }

    /// Whether [`Self::restore`] binds everything again.
    pub fn is_whole(&self) -> bool {
        !self.has_more
    }

    /// A pipeline is bound.
    pub fn bind_pipeline(&mut self, pipeline: vk::Pipeline) {
        self.pipeline = pipeline;
    }

    /// Something is bound that is not kept.
    pub fn bind_more(&mut self) {
        self.has_more = true;
    }

    /// Sets are bound from number `first` on. How many of the dynamic offsets belong to which set nobody knows here, so
    /// that with several sets and offsets it is not kept.
    fn bind_sets(
        &mut self,
        layout: vk::PipelineLayout,
        first: u32,
        sets: &[vk::DescriptorSet],
        offsets: &[u32],
    ) {
        let first = first as usize;
        let end = first + sets.len();
        if end > MOST_SETS || (sets.len() > 1 && !offsets.is_empty()) {
            self.has_more = true;
            return;
        }
        if self.sets.len() < end {
            self.sets.resize(end, None);
        }
        for (place, &handle) in self.sets[first..end].iter_mut().zip(sets) {
            *place = Some(Set { layout, handle, offsets: offsets.into() });
        }
    }

    /// Binds it again, with the next layer's functions.
    ///
    /// # Safety
    ///
    /// `commands` is recording, and this is what it had bound.
    pub unsafe fn restore(&self, next: &ArmedTable, commands: vk::CommandBuffer) {
        let point = vk::PipelineBindPoint::COMPUTE;
        // SAFETY: the caller vouches for the command buffer; what was bound stays valid as long as that does.
        unsafe {
            if let Some(bind) = next.cmd_bind_pipeline
                && self.pipeline != vk::Pipeline::null()
            {
                bind(commands, point, self.pipeline);
            }
            let Some(bind) = next.cmd_bind_descriptor_sets else { return };
            for (number, set) in (0..).zip(&self.sets) {
                if let Some(Set { layout, handle, offsets }) = set {
                    let (count, first) = (offsets.len() as u32, offsets.as_ptr());
                    bind(commands, point, *layout, number, 1, handle, count, first);
                }
            }
        }
    }
}

/// `vkCmdBindDescriptorSets`.
#[allow(clippy::too_many_arguments, reason = "those of the call")]
pub unsafe extern "system" fn bind_sets(
    handle: vk::CommandBuffer,
    point: vk::PipelineBindPoint,
    layout: vk::PipelineLayout,
    first: u32,
    count: u32,
    sets: *const vk::DescriptorSet,
    offset_count: u32,
    offsets: *const u32,
) {
    guard(
        "vkCmdBindDescriptorSets",
        || (),
        |_| {
            // SAFETY: the application's own arguments: `count` sets and `offset_count` offsets.
            unsafe {
                let Some((known, next)) = with_buffer(handle, |next| next.cmd_bind_descriptor_sets) else {
                    return;
                };
                next(handle, point, layout, first, count, sets, offset_count, offsets);
                if let Some(known) = known.filter(|_| point == vk::PipelineBindPoint::COMPUTE) {
                    let offsets = if offset_count == 0 {
                        &[]
                    } else {
                        slice::from_raw_parts(offsets, offset_count as usize)
                    };
                    let sets = if count == 0 { &[] } else { slice::from_raw_parts(sets, count as usize) };
                    known.recorded().compute.bind_sets(layout, first, sets, offsets);
                }
            }
        },
    );
}

/// Hooks of commands that bind what is not kept here; the next layer's function of that name is in the table's `$field`.
macro_rules! binds_more {
    ($($name:ident, $call:literal, $field:ident: ($($argument:ident: $type:ty),*), if $point:expr;)*) => {$(
        #[doc = concat!("`", $call, "`.")]
        pub unsafe extern "system" fn $name(handle: vk::CommandBuffer, $($argument: $type),*) {
            guard(
                $call,
                || (),
                |_| {
                    // SAFETY: the application's own arguments.
                    unsafe {
                        let Some((known, next)) = with_buffer(handle, |next| next.$field) else { return };
                        next(handle, $($argument),*);
                        if let Some(known) = known.filter(|_| $point) {
                            known.recorded().compute.bind_more();
                        }
                    }
                },
            );
        }
    )*};
}

binds_more! {
    push_set, "vkCmdPushDescriptorSetKHR", cmd_push_descriptor_set: (
        point: vk::PipelineBindPoint,
        layout: vk::PipelineLayout,
        set: u32,
        count: u32,
        writes: *const vk::WriteDescriptorSet<'_>
    ), if point == vk::PipelineBindPoint::COMPUTE;
    push_set_with_template, "vkCmdPushDescriptorSetWithTemplateKHR", cmd_push_descriptor_set_with_template: (
        template: vk::DescriptorUpdateTemplate,
        layout: vk::PipelineLayout,
        set: u32,
        data: *const std::ffi::c_void
    ), if true;
    bind_sets2, "vkCmdBindDescriptorSets2KHR", cmd_bind_descriptor_sets2: (
        info: *const vk::BindDescriptorSetsInfoKHR<'_>
    ), if (*info).stage_flags.contains(vk::ShaderStageFlags::COMPUTE);
    push_set2, "vkCmdPushDescriptorSet2KHR", cmd_push_descriptor_set2: (
        info: *const vk::PushDescriptorSetInfoKHR<'_>
    ), if (*info).stage_flags.contains(vk::ShaderStageFlags::COMPUTE);
    push_set_with_template2, "vkCmdPushDescriptorSetWithTemplate2KHR", cmd_push_descriptor_set_with_template2: (
        info: *const vk::PushDescriptorSetWithTemplateInfoKHR<'_>
    ), if true;
    bind_buffers, "vkCmdBindDescriptorBuffersEXT", cmd_bind_descriptor_buffers: (
        count: u32,
        infos: *const vk::DescriptorBufferBindingInfoEXT<'_>
    ), if true;
    set_buffer_offsets, "vkCmdSetDescriptorBufferOffsetsEXT", cmd_set_descriptor_buffer_offsets: (
        point: vk::PipelineBindPoint,
        layout: vk::PipelineLayout,
        first: u32,
        count: u32,
        indices: *const u32,
        offsets: *const vk::DeviceSize
    ), if point == vk::PipelineBindPoint::COMPUTE;
    bind_embedded_samplers, "vkCmdBindDescriptorBufferEmbeddedSamplersEXT", cmd_bind_descriptor_buffer_embedded_samplers: (
        point: vk::PipelineBindPoint,
        layout: vk::PipelineLayout,
        set: u32
    ), if point == vk::PipelineBindPoint::COMPUTE;
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;

    fn sets(numbers: &[u64]) -> Vec<vk::DescriptorSet> {
        numbers.iter().map(|&number| vk::DescriptorSet::from_raw(number)).collect()
    }

    #[test]
    fn the_last_set_of_a_number_counts() {
        let layout = vk::PipelineLayout::from_raw(1);
        let mut bound = Bound::default();
        bound.bind_sets(layout, 1, &sets(&[10, 11]), &[]);
        bound.bind_sets(vk::PipelineLayout::from_raw(2), 2, &sets(&[20]), &[64]);
        let kept: Vec<_> = bound
            .sets
            .iter()
            .map(|set| set.as_ref().map(|set| (set.layout.as_raw(), set.handle.as_raw(), set.offsets.len())))
            .collect();
        assert_eq!(kept, [None, Some((1, 10, 0)), Some((2, 20, 1))]);
        assert!(bound.is_whole());
        bound.clear();
        assert!(bound.sets.is_empty());
    }

    #[test]
    fn what_cannot_be_told_apart_is_not_kept() {
        let layout = vk::PipelineLayout::from_raw(1);
        let mut bound = Bound::default();
        bound.bind_sets(layout, 0, &sets(&[1, 2]), &[64]);
        assert!(!bound.is_whole());
        bound.clear();
        assert!(bound.is_whole());
        bound.bind_sets(layout, MOST_SETS as u32, &sets(&[1]), &[]);
        assert!(!bound.is_whole());
    }
}
