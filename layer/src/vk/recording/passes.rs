//! Render passes.

use super::{Buffer, Within, binding, drawing, draws, stencil, timed, with_buffer};
use crate::abi::copies::slice;
use crate::backend::mask::{Attachments, DepthWork, MaskMap, Masks, OpenMask, PassContext};
use crate::pass_detection::{Pass, Target, Unmasked};
use crate::vk::candidates::Candidate;
use crate::vk::chain::extension;
use crate::vk::objects::{Objects, RenderPass};
use ash::vk;
use smallvec::SmallVec;
use std::sync::Arc;

/// `vkCmdBeginRenderPass`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn begin(
    handle: vk::CommandBuffer,
    info: *const vk::RenderPassBeginInfo<'_>,
    contents: vk::SubpassContents,
) {
    hook!(
        "vkCmdBeginRenderPass",
        with_buffer,
        cmd_begin_render_pass(handle, info, contents),
        |known, next, answer| {
            let begin = |info: *const vk::RenderPassBeginInfo<'_>| {
                // SAFETY: the next layer's function, with the application's structure or an amended copy of it.
                unsafe { next(handle, info, contents) };
                answer.made();
            };
            match known {
                // SAFETY: the application's own arguments, with the valid usage of the call.
                Some(known) => unsafe { begin_tracked(&known, handle, (info, is_inline(contents)), begin) },
                None => begin(info),
            }
        }
    );
}

/// `vkCmdBeginRenderPass2`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn begin2(
    handle: vk::CommandBuffer,
    info: *const vk::RenderPassBeginInfo<'_>,
    subpass: *const vk::SubpassBeginInfo<'_>,
) {
    hook!(
        "vkCmdBeginRenderPass2",
        with_buffer,
        cmd_begin_render_pass2(handle, info, subpass),
        |known, next, answer| {
            let begin = |info: *const vk::RenderPassBeginInfo<'_>| {
                // SAFETY: the next layer's function, with the application's structure or an amended copy of it.
                unsafe { next(handle, info, subpass) };
                answer.made();
            };
            match known {
                // SAFETY: the application's own arguments, with the valid usage of the call.
                Some(known) => unsafe {
                    let contents = (*subpass).contents;
                    begin_tracked(&known, handle, (info, is_inline(contents)), begin)
                },
                None => begin(info),
            }
        }
    );
}

/// `vkCmdEndRenderPass`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn end(handle: vk::CommandBuffer) {
    hook!("vkCmdEndRenderPass", with_buffer, cmd_end_render_pass(handle), |known, next| {
        next();
        if let Some(known) = known {
            // SAFETY: the command buffer is recording, by valid usage, and outside of render passes since the call.
            unsafe { end_tracked(&known, handle) };
        }
    });
}

/// `vkCmdEndRenderPass2`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn end2(handle: vk::CommandBuffer, info: *const vk::SubpassEndInfo<'_>) {
    hook!("vkCmdEndRenderPass2", with_buffer, cmd_end_render_pass2(handle, info), |known, next| {
        next();
        if let Some(known) = known {
            // SAFETY: the command buffer is recording, by valid usage, and outside of render passes since the call.
            unsafe { end_tracked(&known, handle) };
        }
    });
}

/// `vkCmdClearAttachments`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn clear_attachments(
    handle: vk::CommandBuffer,
    count: u32,
    attachments: *const vk::ClearAttachment,
    rect_count: u32,
    rects: *const vk::ClearRect,
) {
    hook!(
        "vkCmdClearAttachments",
        with_buffer,
        cmd_clear_attachments(handle, count, attachments, rect_count, rects),
        |known, next| {
            next();
            // SAFETY: valid usage demands so many attachments.
            let clears_depth = unsafe { slice(attachments, count) }
                .iter()
                .any(|cleared| cleared.aspect_mask.contains(vk::ImageAspectFlags::DEPTH));
            if let Some(known) = known.filter(|_| clears_depth) {
                known.recorded().add(Within { clears_depth, ..Within::default() });
            }
        }
    );
}

/// Whether a subpass with these contents may have commands of the primary command buffer.
fn is_inline(contents: vk::SubpassContents) -> bool {
    contents != vk::SubpassContents::SECONDARY_COMMAND_BUFFERS
}

/// Begins a render pass with `begin`, with rates or a mask where it may have them, and notes it. One whose render pass or
/// framebuffer is not known is left out.
///
/// # Safety
///
/// Valid usage of vkCmdBeginRenderPass.
unsafe fn begin_tracked(
    buffer: &Buffer,
    handle: vk::CommandBuffer,
    (info, is_inline): (*const vk::RenderPassBeginInfo<'_>, bool),
    begin: impl FnOnce(*const vk::RenderPassBeginInfo<'_>),
) {
    let armed = &buffer.armed;
    // SAFETY: the structure is valid, by the valid usage of vkCmdBeginRenderPass.
    let instance = unsafe { Instance::of(&armed.objects, &*info) };
    let mut pass = instance.as_ref().filter(|_| armed.follows_passes()).map(Instance::pass);
    // SAFETY: the command buffer is recording outside of render passes, as one begins.
    unsafe { timed::pass_begins(buffer, handle, pass.as_ref()) };
    if let Some(instance) = &instance {
        buffer.leave_targets(instance.left_in());
    }
    let (candidate, mask) = match (&armed.rate_attachments, &armed.masks) {
        (Some(rates), _) => {
            let target = pass.as_ref().and_then(|pass| armed.objects.first_color(pass));
            // SAFETY: the command buffer is recording and the structure valid, as above.
            let image = unsafe {
                binding::pass_begins(&armed.next, rates, handle, || rates.leaves_alone((*info).render_pass));
                rates.begin_render_pass(info, target, begin)
            };
            (image.map(|image| armed.candidates.with_rate_image(image, true)), None)
        }
        (None, Some(masks)) => {
            let instance = instance.as_ref().zip(pass.as_mut());
            // SAFETY: valid usage of vkCmdBeginRenderPass, as this function requires.
            unsafe { begin_masked(buffer, masks, handle, (info, is_inline), instance, begin) }
        }
        (None, None) => {
            begin(info);
            (None, None)
        }
    };
    buffer.recorded().begin(pass, candidate, mask);
    draws::pass_begins(buffer, handle);
    // SAFETY: the command buffer is recording, as above; the pass was begun.
    unsafe { drawing::pass_begins(buffer, handle) };
}

/// Begins a render pass with `begin`, with a mask where it may have one: only where its instance is known and followed. Returns its
/// candidate and its mask.
///
/// # Safety
///
/// Valid usage of vkCmdBeginRenderPass.
unsafe fn begin_masked(
    buffer: &Buffer,
    masks: &Masks,
    handle: vk::CommandBuffer,
    (info, is_inline): (*const vk::RenderPassBeginInfo<'_>, bool),
    instance: Option<(&Instance, &mut Pass)>,
    begin: impl FnOnce(*const vk::RenderPassBeginInfo<'_>),
) -> (Option<Arc<Candidate>>, Option<OpenMask>) {
    let Some((instance, pass)) = instance else {
        // SAFETY: vkCmdBeginRenderPass is valid only in a command buffer that is recording, outside of render passes.
        unsafe { buffer.fill_all(handle) };
        begin(info);
        return (None, None);
    };
    // SAFETY: the pointer is valid, by the valid usage of vkCmdBeginRenderPass, for the time of the call.
    let structure = unsafe { &*info };
    // SAFETY: the structure is that of vkCmdBeginRenderPass.
    let attachments = unsafe { instance.attachments(masks, structure) };
    let loading = |work: DepthWork| match work.covers {
        true => Ok(*structure),
        false => masks.loading_begin(structure),
    };
    // SAFETY: vkCmdBeginRenderPass is valid only in a command buffer that is recording, outside of render passes.
    let (candidate, mask, loading) = unsafe {
        let place = (&attachments, structure.render_area, is_inline);
        buffer.open_mask(masks, handle, pass, place, loading)
    };
    begin(loading.as_ref().map_or(info, std::ptr::from_ref));
    (candidate, mask)
}

/// A pass has ended.
///
/// # Safety
///
/// The command buffer is recording, outside of render passes.
pub unsafe fn end_tracked(buffer: &Buffer, handle: vk::CommandBuffer) {
    // SAFETY: the command buffer is recording, as `# Safety` demands.
    unsafe { drawing::leave(buffer, handle) };
    stencil::changes(buffer, handle);
    draws::settle(buffer, handle);
    let (mask, bound) = {
        let mut recorded = buffer.recorded();
        if buffer.armed.follows_passes() {
            recorded.end_draws(buffer.armed.has_static_viewports());
        }
        let mask = recorded.end();
        let bound = mask.as_ref().map(|_| (recorded.compute.clone(), recorded.offsets.clone()));
        (mask, bound)
    };
    if let (Some(masks), Some(mask), Some((compute, offsets))) = (&buffer.armed.masks, mask, bound) {
        // SAFETY: the command buffer is recording, as `# Safety` demands; the attachments of the pass are live, as they are in use.
        unsafe {
            masks.end_pass(&mask, handle);
            compute.restore(&buffer.armed.next, handle);
            offsets.restore(&buffer.armed.next, handle);
            buffer.recorded().pending.extend(mask.pending().iter().cloned());
            buffer.fill_where(handle, |pending| !pending.may_wait());
        }
    }
}

impl Buffer {
    /// The candidate of a pass; of a depth pre-pass, that of the passes that go on with its depth.
    pub(super) fn candidate(&self, pass: &Pass, attachments: &Attachments) -> Option<Arc<Candidate>> {
        let armed = &self.armed;
        let Some(depth) = attachments.are_a_prepass(&armed.objects) else {
            return armed.candidates.of(armed.backend.as_deref()?, &armed.objects, pass);
        };
        let depth = depth.target.image;
        let count = self.recorded().prepasses.count(depth);
        armed.candidates.known(armed.masks.as_ref()?.chained(depth, count)?)
    }

    /// Opens the mask of a pass with these attachments and this render area, which is about to begin, inline or not, and fills ahead of it. Returns the
    /// pass's candidate, its mask if it has one, and if that needs it the begin of the pass from `loading`.
    ///
    /// # Safety
    ///
    /// `handle` is this command buffer, which is recording, outside of render passes, and about to begin this pass.
    pub(super) unsafe fn open_mask<T>(
        &self,
        masks: &Masks,
        handle: vk::CommandBuffer,
        pass: &mut Pass,
        (attachments, area, is_inline): (&Attachments, vk::Rect2D, bool),
        loading: impl FnOnce(DepthWork) -> Result<T, Unmasked>,
    ) -> (Option<Arc<Candidate>>, Option<OpenMask>, Option<T>) {
        // Skipped pixels would be missing in the count of a query around the pass, and dispatches under a condition may not run.
        pass.facts.is_queried |= self.recorded().is_queried();
        let candidate = self.candidate(pass, attachments);
        let covering = self.covering(attachments.depth.map(|depth| depth.target.image));
        let context = self.context((area, is_inline), attachments, covering.as_ref());
        let target = candidate.as_ref().map(|candidate| (candidate.target, candidate.mask()));
        // SAFETY: the command buffer is recording outside of render passes, as `# Safety` demands.
        let settle = |mask: Option<&_>| unsafe { self.settle(handle, attachments, area, mask) };
        // SAFETY: as above; the attachments belong to the pass that is about to begin.
        let opened =
            unsafe { masks.begin_pass(handle, target, pass, attachments, context, (loading, settle)) };
        let (mask, loading) = opened.unzip();
        if mask.as_ref().is_some_and(OpenMask::binds_ahead) {
            // The draws of the pass read them. The compute state is restored after the pass.
            let offsets = self.recorded().offsets.clone();
            // SAFETY: as above.
            unsafe { offsets.restore(&self.armed.next, handle) };
        }
        (candidate, mask, loading.flatten())
    }

    /// State at the start of a pass of this render area, inline or not. `covered_by`: the mask whose template its multisampled depth holds, if any.
    pub(super) fn context<'a>(
        &'a self,
        (area, is_inline): (vk::Rect2D, bool),
        attachments: &Attachments,
        covered_by: Option<&'a Arc<MaskMap>>,
    ) -> PassContext<'a> {
        let recorded = self.recorded();
        let prepasses = attachments.depth.map_or(0, |depth| recorded.prepasses.last(depth.target.image));
        PassContext {
            frame: &self.armed.frame,
            objects: &self.armed.objects,
            covered_by,
            prepasses,
            is_primary: self.is_primary,
            restores_compute: recorded.restores_compute(),
            restores_graphics: recorded.restores_graphics(),
            has_offsets: !recorded.offsets.is_empty(),
            follows_graphics: recorded.drawing.is_followed(),
            is_conditional: recorded.is_conditional,
            is_queried: recorded.is_queried(),
            is_inline,
            area,
        }
    }
}

/// An instance of a render pass, with its targets by their attachments' numbers.
struct Instance {
    render_pass: Arc<RenderPass>,
    targets: SmallVec<[Option<Target>; 8]>,
    area: vk::Rect2D,
}

impl Instance {
    /// # Safety
    ///
    /// Valid usage of vkCmdBeginRenderPass.
    unsafe fn of(objects: &Objects, info: &vk::RenderPassBeginInfo<'_>) -> Option<Self> {
        let render_pass = objects.render_pass(info.render_pass)?;
        let framebuffer = objects.framebuffer(info.framebuffer)?;
        let targets = if framebuffer.is_imageless {
            // SAFETY: the chain is valid, as `# Safety` demands, with so many views.
            let views = unsafe {
                extension::<vk::RenderPassAttachmentBeginInfo<'_>>(info.p_next)
                    .map_or(&[][..], |begin| slice(begin.p_attachments, begin.attachment_count))
            };
            views.iter().map(|&view| Some(objects.view(view)?.target)).collect()
        } else {
            framebuffer.attachments.clone()
        };
        Some(Self { render_pass, targets, area: info.render_area })
    }

    /// Its targets, with the layouts in which it leaves them.
    fn left_in(&self) -> impl Iterator<Item = (Target, vk::ImageLayout)> {
        let attachments = self.targets.iter().zip(&self.render_pass.attachments);
        attachments.filter_map(|(target, attachment)| Some(((*target)?, attachment.final_layout)))
    }

    fn pass(&self) -> Pass {
        let render_pass = &self.render_pass;
        let target = |&index: &u32| self.targets.get(index as usize).copied().flatten();
        Pass {
            colors: render_pass.colors.iter().filter_map(target).collect(),
            resolves: render_pass.resolves.iter().filter_map(target).collect(),
            depth: render_pass.depth.as_ref().and_then(target),
            area: super::area(self.area),
            region: super::area(self.area),
            view_mask: render_pass.view_mask,
            facts: render_pass.facts,
            unmasked: None,
            draws: None,
        }
    }

    /// # Safety
    ///
    /// Valid usage of vkCmdBeginRenderPass.
    unsafe fn attachments(&self, masks: &Masks, info: &vk::RenderPassBeginInfo<'_>) -> Attachments {
        // SAFETY: the array has that many valid elements, by the valid usage of vkCmdBeginRenderPass.
        let clears = unsafe { slice(info.p_clear_values, info.clear_value_count) };
        let is_loadable = masks.can_load(info.render_pass);
        Attachments::of_render_pass(&self.render_pass, &self.targets, clears, is_loadable)
    }
}
