//! Offsets into descriptor buffers (VK_EXT_descriptor_buffer), and descriptor heaps, so that they can be set again after work of ours between the
//! application's commands.
//!
//! That work binds descriptor sets, after which offsets are no longer valid (Vulkan specification, vkCmdBindDescriptorSets), of any bind
//! point as far as its words go. The buffers stay bound by its words, but not for Khronos' validation since 2026, so that they are bound again too.

use super::heaps::BoundHeaps;
use super::{drawing, draws, with_buffer};
use crate::abi::copies::{find, slice};
use crate::abi::pnext::chain;
use crate::backend::mask::follow_graphics;
use crate::vk::functions::ArmedTable;
use ash::vk;
use smallvec::SmallVec;

/// Offsets, embedded samplers and heaps of a command buffer.
#[derive(Debug, Clone, Default)]
pub struct BufferOffsets {
    /// The bound buffers, unless the application has bound sets since.
    buffers: SmallVec<[BoundBuffer; 2]>,
    /// Whether their bind had a chain of extensions that cannot be repeated.
    has_more_buffers: bool,
    /// In their order.
    calls: SmallVec<[Call; 4]>,
    /// Whether there are calls that cannot be repeated: those with a chain of extensions.
    has_more: bool,
    /// Whether descriptor sets were bound at one bind point after offsets at another, which the specification leaves in doubt.
    is_mixed: bool,
    heaps: BoundHeaps,
}

/// A bound descriptor buffer.
#[derive(Debug, Clone, Copy, PartialEq)]
struct BoundBuffer {
    address: vk::DeviceAddress,
    usage: vk::BufferUsageFlags,
    /// Replaces `usage`, if there is one (`VkBufferUsageFlags2CreateInfo`).
    usage2: Option<vk::BufferUsageFlags2KHR>,
    /// The buffer itself, for push descriptors of some devices.
    push: Option<vk::Buffer>,
}

/// `VkBufferUsageFlags2CreateInfo`.
type Usage2<'a> = vk::BufferUsageFlags2CreateInfoKHR<'a>;

/// `VkDescriptorBufferBindingPushDescriptorBufferHandleEXT`.
type PushBuffer<'a> = vk::DescriptorBufferBindingPushDescriptorBufferHandleEXT<'a>;

impl BoundBuffer {
    /// Of the application's structure; `None` if its chain has structures of another kind.
    ///
    /// # Safety
    ///
    /// The chain is valid.
    unsafe fn read(info: &vk::DescriptorBufferBindingInfoEXT<'_>) -> Option<Self> {
        // SAFETY: the chain is valid, as `# Safety` demands.
        let (usage2, push, all) = unsafe {
            (find::<Usage2<'_>>(info.p_next), find::<PushBuffer<'_>>(info.p_next), chain(info.p_next).count())
        };
        let is_whole = all == usize::from(usage2.is_some()) + usize::from(push.is_some());
        is_whole.then_some(Self {
            address: info.address,
            usage: info.usage,
            usage2: usage2.map(|found| found.usage),
            push: push.map(|found| found.buffer),
        })
    }
}

/// One call that set offsets, or bound embedded samplers.
#[derive(Debug, Clone, PartialEq)]
struct Call {
    point: vk::PipelineBindPoint,
    layout: vk::PipelineLayout,
    first: u32,
    kind: CallKind,
}

#[derive(Debug, Clone, PartialEq)]
enum CallKind {
    /// Pairs of a buffer's number and an offset into it.
    Offsets(SmallVec<[u32; 4]>, SmallVec<[vk::DeviceSize; 4]>),
    Samplers,
}

impl CallKind {
    fn sets(&self) -> u32 {
        match self {
            Self::Offsets(indices, _) => indices.len() as u32,
            Self::Samplers => 1,
        }
    }
}

impl BufferOffsets {
    /// Forgets all; the memory stays.
    pub fn clear(&mut self) {
        self.forget_offsets();
        self.heaps.clear();
    }

    /// Forgets all but heaps: secondary command buffers leave nothing else bound, and heaps only where they have the same ones.
    pub fn forget_offsets(&mut self) {
        self.forget_buffers();
        self.calls.clear();
        self.has_more = false;
        self.is_mixed = false;
    }

    /// Whether nothing of that kind is in use.
    pub fn is_empty(&self) -> bool {
        self.buffers.is_empty()
            && !self.has_more_buffers
            && self.calls.is_empty()
            && !self.has_more
            && self.heaps.is_empty()
    }

    /// Whether [`Self::restore`] sets everything again.
    pub fn is_complete(&self) -> bool {
        !self.has_more_buffers && !self.has_more && !self.is_mixed && self.heaps.is_complete()
    }

    /// The heaps.
    pub fn heaps(&mut self) -> &mut BoundHeaps {
        &mut self.heaps
    }

    /// Buffers are bound, in place of all earlier ones: offsets into those end. `None`: an unknown one.
    fn bind_buffers(&mut self, buffers: impl Iterator<Item = Option<BoundBuffer>>) {
        self.heaps.clear();
        self.forget_buffers();
        for buffer in buffers {
            self.has_more_buffers |= buffer.is_none();
            self.buffers.extend(buffer);
        }
        self.calls.retain(|call| call.kind == CallKind::Samplers);
        self.is_mixed &= !self.calls.is_empty();
    }

    fn forget_buffers(&mut self) {
        self.buffers.clear();
        self.has_more_buffers = false;
    }

    /// Sets are bound at a point.
    pub fn bind_sets(&mut self, point: vk::PipelineBindPoint) {
        self.heaps.clear();
        self.forget_buffers();
        self.calls.retain(|call| call.point != point);
        self.is_mixed = !self.calls.is_empty();
    }

    fn set(&mut self, new: Call) {
        self.heaps.clear();
        let end = |call: &Call| u64::from(call.first) + u64::from(call.kind.sets());
        let is_within =
            |call: &Call| call.point == new.point && call.first >= new.first && end(call) <= end(&new);
        self.calls.retain(|call| !is_within(call));
        self.calls.push(new);
    }

    /// Binds the buffers again, with the next layer's functions.
    ///
    /// # Safety
    ///
    /// `commands` is recording, and they were bound in it.
    unsafe fn restore_buffers(&self, next: &ArmedTable, commands: vk::CommandBuffer) {
        let Some(bind) = next.cmd_bind_descriptor_buffers.filter(|_| !self.buffers.is_empty()) else {
            return;
        };
        let usages = self.buffers.iter().map(|of| Usage2::default().usage(of.usage2.unwrap_or_default()));
        let mut usages: SmallVec<[Usage2<'_>; 2]> = usages.collect();
        let pushed = self.buffers.iter().map(|of| PushBuffer::default().buffer(of.push.unwrap_or_default()));
        let mut pushed: SmallVec<[PushBuffer<'_>; 2]> = pushed.collect();
        let mut infos: SmallVec<[vk::DescriptorBufferBindingInfoEXT<'_>; 2]> = SmallVec::new();
        for (of, (usage2, push)) in self.buffers.iter().zip(usages.iter_mut().zip(&mut pushed)) {
            let mut info = vk::DescriptorBufferBindingInfoEXT::default().address(of.address).usage(of.usage);
            if of.usage2.is_some() {
                usage2.p_next = info.p_next;
                info.p_next = std::ptr::from_mut(usage2).cast();
            }
            if of.push.is_some() {
                push.p_next = info.p_next;
                info.p_next = std::ptr::from_mut(push).cast();
            }
            infos.push(info);
        }
        // SAFETY: the command buffer is recording, as `# Safety` demands; buffers of its earlier calls stay valid while it records.
        unsafe { bind(commands, infos.len() as u32, infos.as_ptr()) };
    }

    /// Binds and sets all again, with the next layer's functions, as it was set.
    ///
    /// # Safety
    ///
    /// `commands` is recording, and these calls were recorded in it.
    pub unsafe fn restore(&self, next: &ArmedTable, commands: vk::CommandBuffer) {
        // SAFETY: the command buffer is recording, and the buffers were bound in it, as `# Safety` demands.
        unsafe { self.restore_buffers(next, commands) };
        for Call { point, layout, first, kind } in &self.calls {
            // SAFETY: the command buffer is recording, as `# Safety` demands; layouts and offsets of its earlier calls stay valid while it records.
            unsafe {
                match kind {
                    CallKind::Offsets(indices, offsets) => {
                        let Some(set) = next.cmd_set_descriptor_buffer_offsets else { return };
                        let count = indices.len() as u32;
                        set(commands, *point, *layout, *first, count, indices.as_ptr(), offsets.as_ptr());
                    }
                    CallKind::Samplers => {
                        let Some(bind) = next.cmd_bind_descriptor_buffer_embedded_samplers else { return };
                        bind(commands, *point, *layout, *first);
                    }
                }
            }
        }
        // SAFETY: as above.
        unsafe { self.heaps.restore(next, commands) };
    }
}

/// The bind points of shader stages.
pub(super) fn points(stages: vk::ShaderStageFlags) -> SmallVec<[vk::PipelineBindPoint; 3]> {
    use vk::ShaderStageFlags as Stages;
    let drawing = Stages::ALL_GRAPHICS | Stages::TASK_EXT | Stages::MESH_EXT;
    let tracing = Stages::RAYGEN_KHR
        | Stages::ANY_HIT_KHR
        | Stages::CLOSEST_HIT_KHR
        | Stages::MISS_KHR
        | Stages::INTERSECTION_KHR
        | Stages::CALLABLE_KHR;
    let all = [
        (Stages::COMPUTE, vk::PipelineBindPoint::COMPUTE),
        (drawing, vk::PipelineBindPoint::GRAPHICS),
        (tracing, vk::PipelineBindPoint::RAY_TRACING_KHR),
    ];
    all.into_iter().filter(|(of, _)| stages.intersects(*of)).map(|(_, point)| point).collect()
}

/// Keeps a call of a command buffer with `keep`; passes at these bind points may read unknown images.
///
/// # Safety
///
/// `handle` is this command buffer, which is recording.
pub(super) unsafe fn note(
    known: &super::Buffer,
    handle: vk::CommandBuffer,
    points: &[vk::PipelineBindPoint],
    keep: impl Fn(&mut BufferOffsets),
) {
    let draws = points.contains(&vk::PipelineBindPoint::GRAPHICS);
    if draws {
        draws::bind_unknown(handle);
    }
    if known.armed.masks.is_none() {
        return;
    }
    {
        let mut recorded = known.recorded();
        if !recorded.drawing.is_followed() {
            // Sets that are bound for drawing count too, from the next command buffers on.
            follow_graphics();
        }
        keep(&mut recorded.offsets);
    }
    if draws {
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        unsafe { drawing::bind_ours_again(known, handle) };
    }
}

/// `vkCmdBindDescriptorBuffersEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn bind(
    handle: vk::CommandBuffer,
    count: u32,
    infos: *const vk::DescriptorBufferBindingInfoEXT<'_>,
) {
    hook!(
        "vkCmdBindDescriptorBuffersEXT",
        with_buffer,
        cmd_bind_descriptor_buffers(handle, count, infos),
        |known, next| {
            next();
            if let Some(known) = known {
                let points = [vk::PipelineBindPoint::GRAPHICS];
                // SAFETY: valid usage demands so many structures.
                let infos = unsafe { slice(infos, count) };
                // SAFETY: their chains are valid, by valid usage.
                let buffers = || infos.iter().map(|info| unsafe { BoundBuffer::read(info) });
                // SAFETY: the command buffer is recording, by valid usage.
                unsafe { note(&known, handle, &points, |kept| kept.bind_buffers(buffers())) };
            }
        }
    );
}

/// `vkCmdSetDescriptorBufferOffsetsEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn set_offsets(
    handle: vk::CommandBuffer,
    point: vk::PipelineBindPoint,
    layout: vk::PipelineLayout,
    first: u32,
    count: u32,
    indices: *const u32,
    offsets: *const vk::DeviceSize,
) {
    hook!(
        "vkCmdSetDescriptorBufferOffsetsEXT",
        with_buffer,
        cmd_set_descriptor_buffer_offsets(handle, point, layout, first, count, indices, offsets),
        |known, next| {
            next();
            if let Some(known) = known {
                // SAFETY: valid usage demands so many indices and offsets.
                let (indices, offsets) = unsafe { (slice(indices, count), slice(offsets, count)) };
                let kind = CallKind::Offsets(indices.into(), offsets.into());
                let call = Call { point, layout, first, kind };
                // SAFETY: the command buffer is recording, by valid usage.
                unsafe { note(&known, handle, &[point], |kept| kept.set(call.clone())) };
            }
        }
    );
}

/// `vkCmdSetDescriptorBufferOffsets2EXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn set_offsets2(
    handle: vk::CommandBuffer,
    info: *const vk::SetDescriptorBufferOffsetsInfoEXT<'_>,
) {
    hook!(
        "vkCmdSetDescriptorBufferOffsets2EXT",
        with_buffer,
        cmd_set_descriptor_buffer_offsets2(handle, info),
        |known, next| {
            next();
            let Some(known) = known else { return };
            // SAFETY: the pointer is valid, by valid usage, which demands as many indices and offsets as sets.
            let (info, indices, offsets) = unsafe {
                let info = &*info;
                (info, slice(info.p_buffer_indices, info.set_count), slice(info.p_offsets, info.set_count))
            };
            let points = points(info.stage_flags);
            let set = |kept: &mut BufferOffsets| {
                // A chained structure may specify a different layout.
                kept.has_more |= !info.p_next.is_null();
                // Without a layout, they cannot be set again.
                for &point in points.iter().filter(|_| info.layout != vk::PipelineLayout::null()) {
                    let kind = CallKind::Offsets(indices.into(), offsets.into());
                    kept.set(Call { point, layout: info.layout, first: info.first_set, kind });
                }
            };
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { note(&known, handle, &points, set) };
        }
    );
}

/// `vkCmdBindDescriptorBufferEmbeddedSamplersEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn bind_samplers(
    handle: vk::CommandBuffer,
    point: vk::PipelineBindPoint,
    layout: vk::PipelineLayout,
    set: u32,
) {
    hook!(
        "vkCmdBindDescriptorBufferEmbeddedSamplersEXT",
        with_buffer,
        cmd_bind_descriptor_buffer_embedded_samplers(handle, point, layout, set),
        |known, next| {
            next();
            if let Some(known) = known {
                let call = Call { point, layout, first: set, kind: CallKind::Samplers };
                // SAFETY: the command buffer is recording, by valid usage.
                unsafe { note(&known, handle, &[point], |kept| kept.set(call.clone())) };
            }
        }
    );
}

/// `vkCmdBindDescriptorBufferEmbeddedSamplers2EXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn bind_samplers2(
    handle: vk::CommandBuffer,
    info: *const vk::BindDescriptorBufferEmbeddedSamplersInfoEXT<'_>,
) {
    hook!(
        "vkCmdBindDescriptorBufferEmbeddedSamplers2EXT",
        with_buffer,
        cmd_bind_descriptor_buffer_embedded_samplers2(handle, info),
        |known, next| {
            next();
            let Some(known) = known else { return };
            // SAFETY: the pointer is valid, by valid usage.
            let info = unsafe { &*info };
            let points = points(info.stage_flags);
            let set = |kept: &mut BufferOffsets| {
                kept.has_more |= !info.p_next.is_null();
                for &point in points.iter().filter(|_| info.layout != vk::PipelineLayout::null()) {
                    kept.set(Call { point, layout: info.layout, first: info.set, kind: CallKind::Samplers });
                }
            };
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { note(&known, handle, &points, set) };
        }
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;

    const COMPUTE: vk::PipelineBindPoint = vk::PipelineBindPoint::COMPUTE;
    const GRAPHICS: vk::PipelineBindPoint = vk::PipelineBindPoint::GRAPHICS;

    fn offsets(point: vk::PipelineBindPoint, first: u32, offsets: &[u64]) -> Call {
        let kind = CallKind::Offsets(offsets.iter().map(|_| 0).collect(), offsets.into());
        Call { point, layout: vk::PipelineLayout::from_raw(1), first, kind }
    }

    fn buffer(address: vk::DeviceAddress) -> BoundBuffer {
        BoundBuffer { address, usage: vk::BufferUsageFlags::empty(), usage2: None, push: None }
    }

    #[test]
    fn offsets_are_kept_until_they_are_set_anew_or_other_buffers_are_bound() {
        let mut kept = BufferOffsets::default();
        let samplers =
            Call { point: GRAPHICS, layout: vk::PipelineLayout::null(), first: 3, kind: CallKind::Samplers };
        for call in [offsets(GRAPHICS, 0, &[64]), offsets(COMPUTE, 0, &[0]), samplers.clone()] {
            kept.set(call);
        }
        kept.set(offsets(GRAPHICS, 0, &[128, 256]));
        let expected = [offsets(COMPUTE, 0, &[0]), samplers.clone(), offsets(GRAPHICS, 0, &[128, 256])];
        assert_eq!(kept.calls.as_slice(), expected);
        kept.bind_buffers([Some(buffer(64))].into_iter());
        assert_eq!((kept.calls.as_slice(), kept.buffers.as_slice()), (&[samplers][..], &[buffer(64)][..]));
        assert!(kept.is_complete() && !kept.is_empty());
        kept.clear();
        assert!(kept.is_empty());
    }

    #[test]
    fn sets_end_offsets_of_their_point_and_put_others_in_doubt() {
        let mut kept = BufferOffsets::default();
        kept.bind_sets(GRAPHICS);
        kept.set(offsets(COMPUTE, 0, &[0]));
        assert!(kept.is_complete(), "offsets after sets are in no doubt");
        kept.bind_sets(GRAPHICS);
        assert!(!kept.is_complete());
        kept.bind_sets(COMPUTE);
        assert!(kept.is_complete() && kept.is_empty());
        kept.set(offsets(COMPUTE, 0, &[0]));
        kept.bind_sets(GRAPHICS);
        kept.bind_buffers([Some(buffer(64))].into_iter());
        assert!(kept.is_complete() && !kept.is_empty(), "buffers alone are bound");
        kept.bind_sets(GRAPHICS);
        assert!(kept.is_complete() && kept.is_empty(), "nothing is set any more");
    }

    #[test]
    fn buffers_with_unknown_extensions_cannot_be_bound_again() {
        let mut usage2 = Usage2::default().usage(vk::BufferUsageFlags2KHR::SAMPLER_DESCRIPTOR_BUFFER_EXT);
        let mut push = PushBuffer::default().buffer(vk::Buffer::from_raw(3));
        let known = vk::DescriptorBufferBindingInfoEXT::default().address(64);
        let expected = BoundBuffer { usage2: Some(usage2.usage), push: Some(push.buffer), ..buffer(64) };
        let known = known.push_next(&mut push).push_next(&mut usage2);
        // SAFETY: the chain is of local structures.
        assert_eq!(unsafe { BoundBuffer::read(&known) }, Some(expected));
        let other = vk::MemoryAllocateInfo::default();
        let unknown =
            vk::DescriptorBufferBindingInfoEXT { p_next: (&raw const other).cast_mut().cast(), ..known };
        // SAFETY: as above.
        let read = unsafe { BoundBuffer::read(&unknown) };
        let mut kept = BufferOffsets::default();
        kept.bind_buffers([read].into_iter());
        assert!(!kept.is_complete() && !kept.is_empty());
        kept.bind_buffers([Some(buffer(64))].into_iter());
        assert!(kept.is_complete(), "in their place");
    }

    #[test]
    fn sets_and_offsets_end_heaps_and_secondary_command_buffers_do_not() {
        let with_data = || {
            let mut kept = BufferOffsets::default();
            kept.heaps().push(0, &[1; 4]);
            kept
        };
        let after = |change: fn(&mut BufferOffsets)| {
            let mut kept = with_data();
            change(&mut kept);
            kept.heaps.is_empty()
        };
        assert!(!with_data().is_empty() && with_data().is_complete());
        assert!(after(|kept| kept.bind_sets(COMPUTE)));
        assert!(after(|kept| kept.set(offsets(GRAPHICS, 0, &[0]))));
        assert!(after(|kept| kept.bind_buffers(std::iter::empty())));
        assert!(after(BufferOffsets::clear));
        assert!(!after(BufferOffsets::forget_offsets));
    }

    #[test]
    fn stages_belong_to_bind_points() {
        use vk::ShaderStageFlags as Stages;
        assert_eq!(points(Stages::VERTEX | Stages::FRAGMENT).as_slice(), [GRAPHICS]);
        assert_eq!(points(Stages::COMPUTE | Stages::MESH_EXT).as_slice(), [COMPUTE, GRAPHICS]);
        assert_eq!(points(Stages::RAYGEN_KHR).as_slice(), [vk::PipelineBindPoint::RAY_TRACING_KHR]);
        assert_eq!(points(Stages::ALL).len(), 3);
    }
}
