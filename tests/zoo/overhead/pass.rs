//! Begin and end of a render pass that clears its targets, as each style does it.

use crate::device::Device;
use crate::target::{Target, whole};
use ash::vk;

/// Begins a pass over a colour target and the depth buffer; with dynamic rendering where `render_pass` is null.
///
/// # Safety
///
/// The command buffer is recording, outside of render passes, and the handles are live.
pub unsafe fn begin(
    device: &Device,
    buffer: vk::CommandBuffer,
    render_pass: vk::RenderPass,
    target: &Target<'_>,
    depth: &Target<'_>,
) {
    let vk = &device.functions;
    let area = vk::Rect2D::default().extent(target.extent);
    let far = vk::ClearDepthStencilValue { depth: 1.0, stencil: 0 };
    let clear = [vk::ClearValue::default(), vk::ClearValue { depth_stencil: far }];
    // SAFETY: plain use of Vulkan; the caller vouches for the handles.
    unsafe {
        if render_pass != vk::RenderPass::null() {
            let pass = vk::RenderPassBeginInfo::default()
                .render_pass(render_pass)
                .framebuffer(target.framebuffer)
                .render_area(area)
                .clear_values(&clear);
            vk.cmd_begin_render_pass(buffer, &pass, vk::SubpassContents::INLINE);
            return;
        }
        order(device, buffer, target, depth);
        let attachment = |view, layout, store, clear| {
            vk::RenderingAttachmentInfo::default()
                .image_view(view)
                .image_layout(layout)
                .load_op(vk::AttachmentLoadOp::CLEAR)
                .store_op(store)
                .clear_value(clear)
        };
        let (store, dont_care) = (vk::AttachmentStoreOp::STORE, vk::AttachmentStoreOp::DONT_CARE);
        let colour_layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
        let depth_layout = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
        let colour = [attachment(target.view, colour_layout, store, clear[0])];
        let depth = attachment(depth.view, depth_layout, dont_care, clear[1]);
        let info = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .color_attachments(&colour)
            .depth_attachment(&depth);
        vk.cmd_begin_rendering(buffer, &info);
    }
}

/// Ends it.
///
/// # Safety
///
/// The pass was begun with [`begin`] and the same render pass.
pub unsafe fn end(device: &Device, buffer: vk::CommandBuffer, render_pass: vk::RenderPass) {
    let vk = &device.functions;
    // SAFETY: the caller vouches for it.
    unsafe {
        if render_pass == vk::RenderPass::null() {
            vk.cmd_end_rendering(buffer);
        } else {
            vk.cmd_end_render_pass(buffer);
        }
    }
}

/// Dependency of the render pass object: the last pass's writes come before this one's clear.
///
/// # Safety
///
/// As for [`begin`].
unsafe fn order(device: &Device, buffer: vk::CommandBuffer, target: &Target<'_>, depth: &Target<'_>) {
    let stages = vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT
        | vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS
        | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS;
    let barrier = |image, aspect, access, layout| {
        vk::ImageMemoryBarrier::default()
            .image(image)
            .subresource_range(whole(aspect))
            .src_access_mask(access)
            .dst_access_mask(access)
            .new_layout(layout)
    };
    let barriers = [
        barrier(
            target.image,
            vk::ImageAspectFlags::COLOR,
            vk::AccessFlags::COLOR_ATTACHMENT_WRITE,
            vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        ),
        barrier(
            depth.image,
            vk::ImageAspectFlags::DEPTH,
            vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_READ | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE,
            vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
        ),
    ];
    let none = vk::DependencyFlags::empty();
    // SAFETY: the caller vouches for the command buffer; the images are live.
    unsafe { device.functions.cmd_pipeline_barrier(buffer, stages, stages, none, &[], &[], &barriers) }
}
