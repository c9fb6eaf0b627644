//! Bound compute state, so that it can be bound again after work of ours between the application's commands.
//!
//! Hooked only where there is such work: binding is frequent.

use super::descriptor_buffers::points;
use super::sets::BoundSets;
use super::{Buffer, drawing, draws, with_buffer};
use crate::abi::copies::slice;
use crate::backend::mask::follows_graphics;
use crate::vk::device_slots::DeviceSlots;
use crate::vk::dispatch_key::DispatchKey;
use crate::vk::functions::ArmedTable;
use crate::vk::objects::descriptors::written_views;
use ash::vk;
use std::mem;

/// The bound compute state of a command buffer.
#[derive(Debug, Clone, Default)]
pub struct Bound {
    pipeline: vk::Pipeline,
    /// In place of a pipeline.
    shader: vk::ShaderEXT,
    sets: BoundSets,
}

impl Bound {
    /// Forgets all; the memory stays.
    pub fn clear(&mut self) {
        self.pipeline = vk::Pipeline::null();
        self.shader = vk::ShaderEXT::null();
        self.sets.clear();
    }

    /// Whether [`Self::restore`] binds everything again.
    pub fn is_complete(&self) -> bool {
        self.sets.is_complete()
    }

    /// A pipeline is bound.
    pub fn bind_pipeline(&mut self, pipeline: vk::Pipeline) {
        self.pipeline = pipeline;
        self.shader = vk::ShaderEXT::null();
    }

    /// A shader object is bound in place of a pipeline; null: neither.
    pub fn bind_shader(&mut self, shader: vk::ShaderEXT) {
        self.pipeline = vk::Pipeline::null();
        self.shader = shader;
    }

    /// Something is bound that is not kept.
    pub fn bind_more(&mut self) {
        self.sets.bind_more();
    }

    /// Binds it again, with the next layer's functions.
    ///
    /// # Safety
    ///
    /// `commands` is recording, and this was its bound state.
    pub unsafe fn restore(&self, next: &ArmedTable, commands: vk::CommandBuffer) {
        let point = vk::PipelineBindPoint::COMPUTE;
        // SAFETY: the command buffer is recording, as `# Safety` demands; the bound objects stay valid as long as it does.
        unsafe {
            if let Some(bind) = next.cmd_bind_pipeline
                && self.pipeline != vk::Pipeline::null()
            {
                bind(commands, point, self.pipeline);
            }
            if let Some(bind) = next.cmd_bind_shaders
                && self.shader != vk::ShaderEXT::null()
            {
                bind(commands, 1, &vk::ShaderStageFlags::COMPUTE, &self.shader);
            }
            self.sets.restore(next, commands, point);
        }
    }
}

/// The next layer's vkCmdBindDescriptorSets, found without a lock: engines call that for every draw.
static QUICK_BINDS: DeviceSlots = DeviceSlots::new();

/// A device is made.
pub fn device_made(key: DispatchKey, next: &ArmedTable) {
    if let Some(bind) = next.cmd_bind_descriptor_sets {
        QUICK_BINDS.add(key, bind as *mut ());
    }
}

/// A device is about to be destroyed.
pub fn device_ends(key: DispatchKey) {
    QUICK_BINDS.remove(key);
}

/// `vkCmdBindDescriptorSets`.
///
/// # Safety
///
/// The valid usage of the call.
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
    if point == vk::PipelineBindPoint::GRAPHICS {
        // SAFETY: the application's own arguments: `count` sets.
        unsafe { draws::bind(handle, first, slice(sets, count)) };
    }
    // SAFETY: the application's own arguments.
    let key = unsafe { DispatchKey::of(handle) };
    let is_kept = point == vk::PipelineBindPoint::COMPUTE || follows_graphics();
    let next = match key.filter(|_| !is_kept).and_then(|key| QUICK_BINDS.find(key)) {
        // SAFETY: it was made from such a function of this device, which lives.
        Some(next) => unsafe { mem::transmute::<*mut (), vk::PFN_vkCmdBindDescriptorSets>(next) },
        None => bind_sets_tracked,
    };
    // SAFETY: as above.
    unsafe { next(handle, point, layout, first, count, sets, offset_count, offsets) }
}

/// The same, of any device, and noted.
///
/// # Safety
///
/// The valid usage of the call.
#[allow(clippy::too_many_arguments, reason = "those of the call")]
unsafe extern "system" fn bind_sets_tracked(
    handle: vk::CommandBuffer,
    point: vk::PipelineBindPoint,
    layout: vk::PipelineLayout,
    first: u32,
    count: u32,
    sets: *const vk::DescriptorSet,
    offset_count: u32,
    offsets: *const u32,
) {
    hook!(
        "vkCmdBindDescriptorSets",
        with_buffer,
        cmd_bind_descriptor_sets(handle, point, layout, first, count, sets, offset_count, offsets),
        |known, next| {
            next();
            if let Some(known) = known {
                // SAFETY: valid usage demands so many offsets and sets.
                let (offsets, sets) = unsafe { (slice(offsets, offset_count), slice(sets, count)) };
                // SAFETY: the command buffer is recording, by valid usage.
                unsafe { note_sets(&known, handle, point, (layout, first, sets, offsets)) };
            }
        }
    );
}

/// Sets were bound at a point: a layout, the first number, the sets, and their dynamic offsets.
///
/// # Safety
///
/// `handle` is this command buffer, which is recording.
unsafe fn note_sets(
    known: &Buffer,
    handle: vk::CommandBuffer,
    point: vk::PipelineBindPoint,
    (layout, first, sets, offsets): (vk::PipelineLayout, u32, &[vk::DescriptorSet], &[u32]),
) {
    // Rate attachments need no commands among the application's.
    if known.armed.masks.is_none() {
        return;
    }
    known.recorded().offsets.bind_sets(point);
    match point {
        vk::PipelineBindPoint::COMPUTE => {
            known.recorded().compute.sets.bind(layout, first, sets, offsets);
        }
        vk::PipelineBindPoint::GRAPHICS => {
            known.recorded().drawing.bind_sets(layout, first, sets, offsets);
            // SAFETY: the command buffer is recording, as `# Safety` demands.
            unsafe { drawing::bind_ours_again(known, handle) };
        }
        _ => {}
    }
}

/// `vkCmdBindDescriptorSets2`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn bind_sets2(
    handle: vk::CommandBuffer,
    info: *const vk::BindDescriptorSetsInfoKHR<'_>,
) {
    hook!("vkCmdBindDescriptorSets2", with_buffer, cmd_bind_descriptor_sets2(handle, info), |known, next| {
        // SAFETY: the pointer is valid, by the valid usage of vkCmdBindDescriptorSets2, for the time of the call.
        let info = unsafe { &*info };
        // SAFETY: valid usage demands so many sets and offsets.
        let (sets, offsets) = unsafe {
            let sets = slice(info.p_descriptor_sets, info.descriptor_set_count);
            (sets, slice(info.p_dynamic_offsets, info.dynamic_offset_count))
        };
        let points = points(info.stage_flags);
        if points.contains(&vk::PipelineBindPoint::GRAPHICS) {
            // SAFETY: `handle` is live, by valid usage.
            unsafe { draws::bind(handle, info.first_set, sets) };
        }
        if let Some(known) = known.as_ref().filter(|_| !info.p_next.is_null()) {
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { known.fill_before_binding(handle) };
        }
        next();
        let Some(known) = known else { return };
        // A chained structure may specify a different layout.
        if !info.p_next.is_null() {
            known.recorded().compute.bind_more();
            known.recorded().drawing.bind_more();
        }
        for point in points {
            if info.layout == vk::PipelineLayout::null() {
                // Sets without a layout cannot be bound again.
                known.recorded().offsets.bind_sets(point);
                // SAFETY: the command buffer is recording, by valid usage.
                unsafe { note_more(&known, handle, at(point)) };
                continue;
            }
            // SAFETY: as above.
            unsafe { note_sets(&known, handle, point, (info.layout, info.first_set, sets, offsets)) };
        }
    });
}

/// Whether a bind point is for compute, and for drawing.
fn at(point: vk::PipelineBindPoint) -> [bool; 2] {
    [vk::PipelineBindPoint::COMPUTE, vk::PipelineBindPoint::GRAPHICS].map(|known| known == point)
}

/// Whether stages compute, and draw.
fn of(stages: vk::ShaderStageFlags) -> [bool; 2] {
    let points = points(stages);
    [vk::PipelineBindPoint::COMPUTE, vk::PipelineBindPoint::GRAPHICS].map(|known| points.contains(&known))
}

/// Hooks of commands that push descriptors, which cannot be bound again here; the next layer's function of that name is in the table's
/// `$field`. `$push` notes the images that draws read by them.
macro_rules! pushes {
    ($($name:ident, $call:literal, $field:ident: ($($argument:ident: $type:ty),*), for $points:expr, $push:ident($($pushed:expr),*);)*) => {$(
        #[doc = concat!("`", $call, "`.")]
        ///
        /// # Safety
        ///
        /// The valid usage of the call.
        pub unsafe extern "system" fn $name(handle: vk::CommandBuffer, $($argument: $type),*) {
            hook!($call, with_buffer, $field(handle $(, $argument)*), |known, next| {
                if let Some(known) = &known {
                    // SAFETY: the command buffer is recording, by valid usage.
                    unsafe { known.fill_before_binding(handle) };
                }
                next();
                // SAFETY: the command buffer is recording, and pointers are valid, by valid usage.
                unsafe {
                    let points = $points;
                    if points[1] {
                        $push(handle, $($pushed),*);
                    }
                    if let Some(known) = known {
                        note_unkept(&known, handle, points);
                    }
                }
            });
        }
    )*};
}

/// Notes the images of pushes to the set of that number, for drawing.
///
/// # Safety
///
/// `handle` is a live command buffer; so many writes are valid.
unsafe fn push_writes(
    handle: vk::CommandBuffer,
    number: u32,
    (count, writes): (u32, *const vk::WriteDescriptorSet<'_>),
) {
    // SAFETY: as `# Safety` demands.
    unsafe {
        let views = slice(writes, count).iter().flat_map(|write| written_views(write));
        draws::push(handle, number, views);
    }
}

/// Notes the images of a push by a template, if it is for drawing.
///
/// # Safety
///
/// `handle` is a live command buffer; `data` is as the template describes it.
unsafe fn push_data(
    handle: vk::CommandBuffer,
    number: u32,
    (template, data): (vk::DescriptorUpdateTemplate, *const std::ffi::c_void),
) {
    // SAFETY: as `# Safety` demands.
    let Some(armed) = (unsafe { draws::cached_device(handle) }) else { return };
    match armed.objects.descriptors.template(template) {
        // SAFETY: as above.
        Some(template) if template.draws() => unsafe { draws::push(handle, number, template.views(data)) },
        Some(_) => {}
        None => draws::bind_unknown(handle),
    }
}

/// State that is not kept was bound, for computing or for drawing.
///
/// # Safety
///
/// `handle` is this command buffer, which is recording.
unsafe fn note_more(known: &Buffer, handle: vk::CommandBuffer, points: [bool; 2]) {
    if points[1] {
        draws::bind_unknown(handle);
    }
    // SAFETY: as `# Safety` demands.
    unsafe { note_unkept(known, handle, points) };
}

/// As [`note_more`], where the reads of draws are known.
///
/// # Safety
///
/// As there.
unsafe fn note_unkept(known: &Buffer, handle: vk::CommandBuffer, [computes, draws]: [bool; 2]) {
    if known.armed.masks.is_none() {
        return;
    }
    if computes {
        known.recorded().compute.bind_more();
    }
    if draws {
        known.recorded().drawing.bind_more();
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        unsafe { drawing::bind_ours_again(known, handle) };
    }
}

pushes! {
    push_set, "vkCmdPushDescriptorSet", cmd_push_descriptor_set: (
        point: vk::PipelineBindPoint,
        layout: vk::PipelineLayout,
        set: u32,
        count: u32,
        writes: *const vk::WriteDescriptorSet<'_>
    ), for at(point), push_writes(set, (count, writes));
    push_set_with_template, "vkCmdPushDescriptorSetWithTemplate", cmd_push_descriptor_set_with_template: (
        template: vk::DescriptorUpdateTemplate,
        layout: vk::PipelineLayout,
        set: u32,
        data: *const std::ffi::c_void
    ), for [true; 2], push_data(set, (template, data));
    push_set2, "vkCmdPushDescriptorSet2", cmd_push_descriptor_set2: (
        info: *const vk::PushDescriptorSetInfoKHR<'_>
    ), for of((*info).stage_flags),
        push_writes((*info).set, ((*info).descriptor_write_count, (*info).p_descriptor_writes));
    push_set_with_template2, "vkCmdPushDescriptorSetWithTemplate2", cmd_push_descriptor_set_with_template2: (
        info: *const vk::PushDescriptorSetWithTemplateInfoKHR<'_>
    ), for [true; 2], push_data((*info).set, ((*info).descriptor_update_template, (*info).p_data));
}
