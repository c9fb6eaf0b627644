//! What is bound for compute, so that it can be bound again after work of ours between the application's commands.
//!
//! Hooked only where there is such work: binding is frequent.

use super::with_buffer;
use crate::abi::guard;
use crate::vk::dispatch::ArmedTable;
use crate::vk::dispatch_key::DispatchKey;
use ash::vk;
use smallvec::SmallVec;
use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering};
use std::{mem, ptr, slice};

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

/// The next layer's vkCmdBindDescriptorSets of one device, found without a lock: engines call that for every draw.
///
/// It changes only while that device is made or destroyed, when no command buffer of it is recorded (external synchronization
/// of vkDestroyDevice), so that both words belong together for whoever finds the key of his own.
struct QuickBind {
    /// 0: of none.
    key: AtomicUsize,
    next: AtomicPtr<()>,
}

static QUICK_BIND: QuickBind = QuickBind { key: AtomicUsize::new(0), next: AtomicPtr::new(ptr::null_mut()) };

/// A device is made. The first one is found quickly as long as it lives.
pub fn device_made(key: DispatchKey, next: &ArmedTable) {
    let Some(bind) = next.cmd_bind_descriptor_sets else { return };
    let QuickBind { key: quick, next } = &QUICK_BIND;
    // Reserved first: two devices may be made at once.
    if quick.compare_exchange(0, RESERVED, Ordering::AcqRel, Ordering::Relaxed).is_ok() {
        next.store(bind as *mut (), Ordering::Relaxed);
        quick.store(key.address(), Ordering::Release);
    }
}

/// A device is about to be destroyed.
pub fn device_ends(key: DispatchKey) {
    let _ = QUICK_BIND.key.compare_exchange(key.address(), 0, Ordering::AcqRel, Ordering::Relaxed);
}

/// No address of a dispatch table.
const RESERVED: usize = 1;

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
    // SAFETY: the application's own arguments.
    let next = match unsafe { DispatchKey::of(handle) } {
        Some(key)
            if point != vk::PipelineBindPoint::COMPUTE
                && QUICK_BIND.key.load(Ordering::Acquire) == key.address() =>
        {
            let next = QUICK_BIND.next.load(Ordering::Relaxed);
            // SAFETY: it was made from such a function, and stored before the key of this device, which lives.
            unsafe { mem::transmute::<*mut (), vk::PFN_vkCmdBindDescriptorSets>(next) }
        }
        _ => bind_sets_noted,
    };
    // SAFETY: as above.
    unsafe { next(handle, point, layout, first, count, sets, offset_count, offsets) }
}

/// The same, of any device, and noted where it is for compute.
#[allow(clippy::too_many_arguments, reason = "those of the call")]
unsafe extern "system" fn bind_sets_noted(
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
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(
                with_buffer: handle,
                cmd_bind_descriptor_sets(handle, point, layout, first, count, sets, offset_count, offsets),
                ()
            )
        },
        |answer| {
            // SAFETY: the application's own arguments: `count` sets and `offset_count` offsets.
            unsafe {
                let Some((known, next)) = with_buffer(handle, |next| next.cmd_bind_descriptor_sets) else {
                    return;
                };
                next(handle, point, layout, first, count, sets, offset_count, offsets);
                answer.made();
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
                // SAFETY: the application's own arguments.
                || unsafe { pass_on!(with_buffer: handle, $field(handle, $($argument),*), ()) },
                |answer| {
                    // SAFETY: the application's own arguments.
                    unsafe {
                        let Some((known, next)) = with_buffer(handle, |next| next.$field) else { return };
                        next(handle, $($argument),*);
                        answer.made();
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
