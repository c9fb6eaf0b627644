//! Offsets into descriptor buffers (VK_EXT_descriptor_buffer), and descriptor heaps, so that they can be set again after work of ours between the
//! application's commands.
//!
//! That work binds descriptor sets, after which offsets are no longer valid (Vulkan specification, vkCmdBindDescriptorSets), of any bind
//! point as far as its words go. The buffers stay bound by its words, but not for Khronos' validation since 2026, so that they are bound again too.

mod bound;

use super::heaps::BoundHeaps;
use super::{drawing, draws, with_buffer};
use crate::abi::copies::slice;
use crate::backend::mask::follow_graphics;
use crate::vk::functions::ArmedTable;
use ash::vk;
use bound::BoundBuffer;
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

    /// Binds and sets all again, with the next layer's functions, as it was set.
    ///
    /// # Safety
    ///
    /// `commands` is recording, and these calls were recorded in it.
    pub unsafe fn restore(&self, next: &ArmedTable, commands: vk::CommandBuffer) {
        // SAFETY: the command buffer is recording, and the buffers were bound in it, as `# Safety` demands.
        unsafe { bound::restore(&self.buffers, next, commands) };
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
pub(super) fn note(
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
    let mut recorded = known.recorded();
    if !recorded.drawing.is_followed() {
        // Sets that are bound for drawing count too, from the next command buffers on.
        follow_graphics();
    }
    keep(&mut recorded.offsets);
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
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { drawing::leave_for_command(known.as_deref(), handle) };
            next();
            if let Some(known) = known {
                let points = [vk::PipelineBindPoint::GRAPHICS];
                // SAFETY: valid usage demands so many structures.
                let infos = unsafe { slice(infos, count) };
                // SAFETY: their chains are valid, by valid usage.
                let buffers = || infos.iter().map(|info| unsafe { BoundBuffer::read(info) });
                note(&known, handle, &points, |kept| kept.bind_buffers(buffers()));
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
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { drawing::leave_for_command(known.as_deref(), handle) };
            next();
            if let Some(known) = known {
                // SAFETY: valid usage demands so many indices and offsets.
                let (indices, offsets) = unsafe { (slice(indices, count), slice(offsets, count)) };
                let kind = CallKind::Offsets(indices.into(), offsets.into());
                let call = Call { point, layout, first, kind };
                note(&known, handle, &[point], |kept| kept.set(call.clone()));
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
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { drawing::leave_for_command(known.as_deref(), handle) };
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
            note(&known, handle, &points, set);
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
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { drawing::leave_for_command(known.as_deref(), handle) };
            next();
            if let Some(known) = known {
                let call = Call { point, layout, first: set, kind: CallKind::Samplers };
                note(&known, handle, &[point], |kept| kept.set(call.clone()));
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
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { drawing::leave_for_command(known.as_deref(), handle) };
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
            note(&known, handle, &points, set);
        }
    );
}

#[cfg(test)]
mod tests;
