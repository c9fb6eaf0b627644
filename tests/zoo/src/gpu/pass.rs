//! Render passes of one subpass: as VkRenderPass with VkFramebuffer, or with dynamic rendering.
//!
//! All code that begins a pass notes it in [`Gpu::begun`], with its parameters in Vulkan.

mod order;

pub use order::{TARGETS, dependencies};

use super::{Attachment, Gpu, Image, Made};
use crate::truth::PassSeen;
use anyhow::Result;
use ash::vk;

/// Kind of a pass: render pass and framebuffer, imageless framebuffer, or dynamic rendering.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    RenderPass,
    /// A VkFramebuffer without views: they are named when the pass begins.
    Imageless,
    Dynamic,
}

/// The pass of a pipeline.
#[derive(Clone, Debug, Default)]
pub struct Target {
    /// Null for dynamic rendering.
    pub render_pass: vk::RenderPass,
    pub subpass: u32,
    pub colors: Vec<vk::Format>,
    /// UNDEFINED where there is no depth.
    pub depth: vk::Format,
    pub view_mask: u32,
    pub samples: u32,
}

/// Description of a pass. Each colour attachment may have one that it is resolved to.
#[derive(Clone, Default)]
pub struct PassSpec {
    pub colors: Vec<Attachment>,
    pub resolves: Vec<Attachment>,
    pub depth: Option<Attachment>,
    /// Views of a multiview pass, else 0.
    pub view_mask: u32,
}

/// A pass with its images.
pub struct Pass {
    kind: Kind,
    spec: PassSpec,
    /// Its rate image, where the application sets rates itself.
    rates: Option<Image>,
    pub framebuffer: vk::Framebuffer,
    pub target: Target,
    pub extent: [u32; 2],
}

impl PassSpec {
    /// Colour alone.
    pub fn color(color: Attachment) -> Self {
        Self { colors: vec![color], ..Self::default() }
    }

    /// Colour and depth.
    pub fn new(color: Attachment, depth: Attachment) -> Self {
        Self { colors: vec![color], depth: Some(depth), ..Self::default() }
    }

    /// Depth alone.
    pub fn depth(depth: Attachment) -> Self {
        Self { depth: Some(depth), ..Self::default() }
    }

    /// For two views at once.
    pub fn multiview(self) -> Self {
        Self { view_mask: 0b11, ..self }
    }

    /// Resolved, at its end, to this.
    pub fn resolved(self, to: Attachment) -> Self {
        Self { resolves: vec![to], ..self }
    }

    pub(super) fn attachments(&self) -> impl Iterator<Item = &Attachment> {
        self.colors.iter().chain(&self.resolves).chain(&self.depth)
    }

    fn extent(&self) -> [u32; 2] {
        self.attachments().next().map_or([1, 1], |attachment| attachment.image.extent)
    }

    fn target(&self, render_pass: vk::RenderPass) -> Target {
        let first = self.colors.first().or(self.depth.as_ref());
        Target {
            render_pass,
            subpass: 0,
            colors: self.colors.iter().map(|color| color.image.format).collect(),
            depth: self.depth.map_or(vk::Format::UNDEFINED, |depth| depth.image.format),
            view_mask: self.view_mask,
            samples: first.map_or(1, |attachment| attachment.image.samples),
        }
    }
}

impl Target {
    /// Result of [`Gpu::begun`] for a pass with this target.
    pub fn seen(&self, extent: [u32; 2], area: [u32; 2]) -> PassSeen {
        PassSeen {
            frame: 0,
            extent,
            area,
            layers: self.view_mask.count_ones().max(1),
            samples: self.samples,
            format: self.colors.first().unwrap_or(&self.depth).as_raw(),
        }
    }
}

impl Gpu {
    /// Makes a pass, and keeps its objects.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn pass(&self, kind: Kind, spec: PassSpec) -> Result<Pass> {
        let render_pass =
            if kind == Kind::Dynamic { vk::RenderPass::null() } else { self.render_pass(&spec)? };
        let target = spec.target(render_pass);
        self.pass_like(kind, &target, spec)
    }

    /// Another pass of the same formats, loads and layouts as the one that `target` is of: it shares the render pass.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn pass_like(&self, kind: Kind, target: &Target, spec: PassSpec) -> Result<Pass> {
        let extent = spec.extent();
        let rates = self.rate_image(&spec, extent)?;
        let framebuffer = match kind {
            Kind::Dynamic => vk::Framebuffer::null(),
            Kind::RenderPass => {
                let images = spec.attachments().map(|attachment| &attachment.image);
                let views: Vec<_> = images.chain(&rates).map(|image| image.view).collect();
                let framebuffer = self.framebuffer(target.render_pass, &views, extent)?;
                self.keep(Made::Framebuffer(framebuffer));
                framebuffer
            }
            Kind::Imageless => self.imageless_framebuffer(target.render_pass, &spec, extent)?,
        };
        Ok(Pass { kind, spec, rates, framebuffer, target: target.clone(), extent })
    }

    /// Makes a framebuffer, which the caller destroys.
    ///
    /// # Errors
    /// Errors of vkCreateFramebuffer.
    pub fn framebuffer(
        &self,
        render_pass: vk::RenderPass,
        views: &[vk::ImageView],
        extent: [u32; 2],
    ) -> Result<vk::Framebuffer> {
        let info = vk::FramebufferCreateInfo::default()
            .render_pass(render_pass)
            .attachments(views)
            .width(extent[0])
            .height(extent[1])
            .layers(1);
        // SAFETY: the render pass and the views are live.
        Ok(unsafe { self.device.create_framebuffer(&info, None) }?)
    }

    fn imageless_framebuffer(
        &self,
        render_pass: vk::RenderPass,
        spec: &PassSpec,
        extent: [u32; 2],
    ) -> Result<vk::Framebuffer> {
        let formats: Vec<_> = spec.attachments().map(|attachment| [attachment.image.format]).collect();
        let images: Vec<_> = spec
            .attachments()
            .zip(&formats)
            .map(|(attachment, format)| {
                vk::FramebufferAttachmentImageInfo::default()
                    .usage(attachment.image.usage)
                    .width(extent[0])
                    .height(extent[1])
                    .layer_count(attachment.image.layers)
                    .view_formats(format)
            })
            .collect();
        let mut attachments = vk::FramebufferAttachmentsCreateInfo::default().attachment_image_infos(&images);
        let mut info = vk::FramebufferCreateInfo::default()
            .flags(vk::FramebufferCreateFlags::IMAGELESS)
            .render_pass(render_pass)
            .width(extent[0])
            .height(extent[1])
            .layers(1)
            .push_next(&mut attachments);
        info.attachment_count = images.len() as u32;
        // SAFETY: the render pass is live, the structures outlive the call.
        let framebuffer = unsafe { self.device.create_framebuffer(&info, None) }?;
        self.keep(Made::Framebuffer(framebuffer));
        Ok(framebuffer)
    }

    fn render_pass(&self, spec: &PassSpec) -> Result<vk::RenderPass> {
        if self.sets_rates(spec) {
            return self.render_pass_with_rates(spec);
        }
        let descriptions: Vec<_> = spec.attachments().map(Attachment::description).collect();
        let reference = |index, layout| vk::AttachmentReference { attachment: index, layout };
        let (count, resolves) = (spec.colors.len() as u32, spec.resolves.len() as u32);
        let color = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
        let colors: Vec<_> = (0..count).map(|index| reference(index, color)).collect();
        let resolved: Vec<_> = (count..count + resolves).map(|index| reference(index, color)).collect();
        let depth = reference(count + resolves, vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
        let mut subpass = vk::SubpassDescription::default()
            .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
            .color_attachments(&colors);
        if !resolved.is_empty() {
            subpass = subpass.resolve_attachments(&resolved);
        }
        if spec.depth.is_some() {
            subpass = subpass.depth_stencil_attachment(&depth);
        }
        let (masks, subpasses, dependencies) = ([spec.view_mask], [subpass], dependencies(0));
        let mut multiview =
            vk::RenderPassMultiviewCreateInfo::default().view_masks(&masks).correlation_masks(&masks);
        let mut info = vk::RenderPassCreateInfo::default()
            .attachments(&descriptions)
            .subpasses(&subpasses)
            .dependencies(&dependencies);
        if spec.view_mask != 0 {
            info = info.push_next(&mut multiview);
        }
        // SAFETY: the structures outlive the call.
        let render_pass = unsafe { self.device.create_render_pass(&info, None) }?;
        self.keep(Made::RenderPass(render_pass));
        Ok(render_pass)
    }
}

impl Pass {
    /// A render pass of `target` with a framebuffer of the caller's.
    pub fn with_framebuffer(spec: PassSpec, target: &Target, framebuffer: vk::Framebuffer) -> Self {
        let extent = spec.extent();
        Self { kind: Kind::RenderPass, spec, rates: None, framebuffer, target: target.clone(), extent }
    }

    /// Begins it, with a viewport over all of it.
    pub fn begin(&self, gpu: &Gpu, commands: vk::CommandBuffer) {
        self.begin_area(gpu, commands, self.extent);
    }

    /// Begins it with this render area, and a viewport over that.
    pub fn begin_area(&self, gpu: &Gpu, commands: vk::CommandBuffer, area: [u32; 2]) {
        self.begin_with(gpu, commands, area, vk::SubpassContents::INLINE);
        gpu.set_viewport(commands, area);
    }

    /// Begins it for the contents of secondary command buffers.
    pub fn begin_for_secondaries(&self, gpu: &Gpu, commands: vk::CommandBuffer) {
        self.begin_with(gpu, commands, self.extent, vk::SubpassContents::SECONDARY_COMMAND_BUFFERS);
    }

    fn begin_with(
        &self,
        gpu: &Gpu,
        commands: vk::CommandBuffer,
        area: [u32; 2],
        contents: vk::SubpassContents,
    ) {
        let number = gpu.note_pass(self.target.seen(self.extent, area));
        if let Some(image) = &self.rates {
            gpu.write_rates(commands, image, number);
        }
        let area = vk::Rect2D {
            offset: vk::Offset2D::default(),
            extent: vk::Extent2D { width: area[0], height: area[1] },
        };
        if self.kind == Kind::Dynamic {
            return self.begin_rendering(gpu, commands, area);
        }
        let clears: Vec<_> = self.spec.attachments().map(|attachment| attachment.clear).collect();
        let views: Vec<_> = self.spec.attachments().map(|attachment| attachment.image.view).collect();
        let mut named = vk::RenderPassAttachmentBeginInfo::default().attachments(&views);
        let mut info = vk::RenderPassBeginInfo::default()
            .render_pass(self.target.render_pass)
            .framebuffer(self.framebuffer)
            .render_area(area)
            .clear_values(&clears);
        if self.kind == Kind::Imageless {
            info = info.push_next(&mut named);
        }
        // SAFETY: the command buffer is being recorded, outside of a render pass; all objects are live.
        unsafe { gpu.cmd_begin_render_pass(commands, &info, contents) };
    }

    fn begin_rendering(&self, gpu: &Gpu, commands: vk::CommandBuffer, area: vk::Rect2D) {
        let color = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
        for attachment in self.spec.attachments() {
            gpu.transition(commands, &attachment.image, attachment.before, layout_within(attachment));
        }
        let infos: Vec<_> = (0..)
            .zip(&self.spec.colors)
            .map(|(index, attachment)| {
                let info = attachment.rendering_info(color);
                match self.spec.resolves.get::<usize>(index) {
                    Some(to) => info
                        .resolve_mode(vk::ResolveModeFlags::AVERAGE)
                        .resolve_image_view(to.image.view)
                        .resolve_image_layout(color),
                    None => info,
                }
            })
            .collect();
        let depth = self.spec.depth.map(|depth| depth.rendering_info(layout_within(&depth)));
        let mut info = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .view_mask(self.spec.view_mask)
            .color_attachments(&infos);
        if let Some(depth) = &depth {
            info = info.depth_attachment(depth);
        }
        let mut rates = self.rates.as_ref().map(|image| gpu.rate_attachment(image));
        if let Some(rates) = &mut rates {
            info = info.push_next(rates);
        }
        // SAFETY: as for render passes; the style's needs hold Vulkan 1.3 and the feature.
        unsafe { gpu.cmd_begin_rendering(commands, &info) };
    }

    /// Ends it.
    pub fn end(&self, gpu: &Gpu, commands: vk::CommandBuffer) {
        if self.kind != Kind::Dynamic {
            // SAFETY: the pass was begun in this command buffer.
            return unsafe { gpu.cmd_end_render_pass(commands) };
        }
        // SAFETY: as above.
        unsafe { gpu.cmd_end_rendering(commands) };
        for attachment in self.spec.attachments() {
            gpu.transition(commands, &attachment.image, layout_within(attachment), attachment.after);
        }
    }
}

fn layout_within(attachment: &Attachment) -> vk::ImageLayout {
    if attachment.is_depth() {
        vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL
    } else {
        vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL
    }
}

/// A view of an eye's image for each of `images`, each in a pass made by `spec`; they share one render pass.
pub fn passes(
    gpu: &Gpu,
    kind: Kind,
    images: &[Image],
    spec: impl Fn(Image) -> PassSpec,
) -> Result<Vec<Pass>> {
    let mut passes: Vec<Pass> = Vec::with_capacity(images.len());
    for image in images {
        let pass = match passes.first() {
            Some(first) => gpu.pass_like(kind, &first.target, spec(*image))?,
            None => gpu.pass(kind, spec(*image))?,
        };
        passes.push(pass);
    }
    Ok(passes)
}
