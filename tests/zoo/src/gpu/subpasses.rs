//! Render passes of two subpasses in one framebuffer, by vkCreateRenderPass2: the second reads, as its input
//! attachment, the colour of the first.

use super::pass::{TARGETS, dependencies};
use super::{Attachment, Gpu, Made, Target};
use anyhow::Result;
use ash::vk;

/// Description of such a pass.
#[derive(Clone, Copy)]
pub struct SubpassesSpec {
    /// Drawn first, then read.
    pub light: Attachment,
    pub depth: Attachment,
    /// Drawn by the second subpass.
    pub color: Attachment,
    /// As of a pass.
    pub view_mask: u32,
}

/// Such a pass with its images.
pub struct Subpasses {
    /// The subpass of each pipeline.
    pub targets: [Target; 2],
    framebuffer: vk::Framebuffer,
    clears: [vk::ClearValue; 3],
    extent: [u32; 2],
}

impl Gpu {
    /// Makes one for each of `specs`, which differ in the images of `color` alone: they share the render pass.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn subpasses(&self, specs: &[SubpassesSpec]) -> Result<Vec<Subpasses>> {
        let Some(first) = specs.first() else { return Ok(Vec::new()) };
        let render_pass = self.two_subpasses(first)?;
        let target = |subpass, attachment: &Attachment, depth| Target {
            render_pass,
            subpass,
            colors: vec![attachment.image.format],
            depth,
            view_mask: first.view_mask,
            samples: attachment.image.samples,
        };
        let targets = [
            target(0, &first.light, first.depth.image.format),
            target(1, &first.color, vk::Format::UNDEFINED),
        ];
        let make = |spec: &SubpassesSpec| {
            let attachments = [spec.light, spec.depth, spec.color];
            let views = attachments.map(|attachment| attachment.image.view);
            let extent = spec.color.image.extent;
            let framebuffer = self.framebuffer(render_pass, &views, extent)?;
            self.keep(Made::Framebuffer(framebuffer));
            let clears = attachments.map(|attachment| attachment.clear);
            Ok(Subpasses { targets: targets.clone(), framebuffer, clears, extent })
        };
        specs.iter().map(make).collect()
    }

    fn two_subpasses(&self, spec: &SubpassesSpec) -> Result<vk::RenderPass> {
        let attachments = [spec.light, spec.depth, spec.color].map(|attachment| {
            vk::AttachmentDescription2::default()
                .format(attachment.image.format)
                .samples(vk::SampleCountFlags::from_raw(attachment.image.samples))
                .load_op(attachment.load)
                .store_op(attachment.store)
                .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
                .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
                .initial_layout(attachment.before)
                .final_layout(attachment.after)
        });
        let reference = |index, layout| {
            [vk::AttachmentReference2::default()
                .attachment(index)
                .layout(layout)
                .aspect_mask(vk::ImageAspectFlags::COLOR)]
        };
        let light = reference(0, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL);
        let depth = reference(1, vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL)[0]
            .aspect_mask(vk::ImageAspectFlags::DEPTH);
        let input = reference(0, vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL);
        let color = reference(2, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL);
        let subpass = || {
            vk::SubpassDescription2::default()
                .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
                .view_mask(spec.view_mask)
        };
        let subpasses = [
            subpass().color_attachments(&light).depth_stencil_attachment(&depth),
            subpass().input_attachments(&input).color_attachments(&color),
        ];
        let [before, after] = dependencies(1);
        let between = vk::SubpassDependency {
            src_subpass: 0,
            dst_subpass: 1,
            src_stage_mask: TARGETS,
            dst_stage_mask: vk::PipelineStageFlags::FRAGMENT_SHADER,
            src_access_mask: vk::AccessFlags::COLOR_ATTACHMENT_WRITE,
            dst_access_mask: vk::AccessFlags::INPUT_ATTACHMENT_READ,
            dependency_flags: vk::DependencyFlags::BY_REGION,
        };
        // The target of the second subpass also changes its layout after the commands before the pass.
        let before_second = vk::SubpassDependency { dst_subpass: 1, ..before };
        let dependencies = [before, before_second, between, after].map(|one| {
            // With multiview each view of a subpass depends on the same view of the other.
            let within = one.src_subpass != vk::SUBPASS_EXTERNAL && one.dst_subpass != vk::SUBPASS_EXTERNAL;
            let local = if within && spec.view_mask != 0 {
                vk::DependencyFlags::VIEW_LOCAL
            } else {
                vk::DependencyFlags::empty()
            };
            vk::SubpassDependency2::default()
                .src_subpass(one.src_subpass)
                .dst_subpass(one.dst_subpass)
                .src_stage_mask(one.src_stage_mask)
                .dst_stage_mask(one.dst_stage_mask)
                .src_access_mask(one.src_access_mask)
                .dst_access_mask(one.dst_access_mask)
                .dependency_flags(one.dependency_flags | local)
        });
        let masks = [spec.view_mask];
        let mut info = vk::RenderPassCreateInfo2::default()
            .attachments(&attachments)
            .subpasses(&subpasses)
            .dependencies(&dependencies);
        if spec.view_mask != 0 {
            info = info.correlated_view_masks(&masks);
        }
        // SAFETY: the structures outlive the call; the style's needs hold Vulkan 1.2.
        let render_pass = unsafe { self.device.create_render_pass2(&info, None) }?;
        self.keep(Made::RenderPass(render_pass));
        Ok(render_pass)
    }
}

impl Subpasses {
    /// Begins the pass and its first subpass.
    pub fn begin(&self, gpu: &Gpu, commands: vk::CommandBuffer) {
        gpu.note_pass(self.targets[0].seen(self.extent, self.extent));
        let [width, height] = self.extent;
        let area = vk::Rect2D { offset: vk::Offset2D::default(), extent: vk::Extent2D { width, height } };
        let info = vk::RenderPassBeginInfo::default()
            .render_pass(self.targets[0].render_pass)
            .framebuffer(self.framebuffer)
            .render_area(area)
            .clear_values(&self.clears);
        // SAFETY: the command buffer is being recorded, outside of a render pass; all objects are live.
        unsafe { gpu.cmd_begin_render_pass(commands, &info, vk::SubpassContents::INLINE) };
        gpu.set_viewport(commands, self.extent);
    }

    /// Goes on to the second subpass.
    pub fn next(&self, gpu: &Gpu, commands: vk::CommandBuffer) {
        // SAFETY: the first subpass was begun.
        unsafe { gpu.cmd_next_subpass(commands, vk::SubpassContents::INLINE) };
    }

    /// Ends the pass.
    pub fn end(&self, gpu: &Gpu, commands: vk::CommandBuffer) {
        // SAFETY: the second subpass was begun.
        unsafe { gpu.cmd_end_render_pass(commands) };
    }
}
