//! Two frames: the map is written, and a pass reads it.

use super::compute::{TEXELS, Writer};
use super::objects::{COLOUR, framebuffer, rate_image, rate_view, render_pass, view, view_mask};
use super::pipelines::{pipelines, rate};
use super::setup::{SIZE, Setup, extent};
use crate::device::whole;
use ash::vk;

const RATE_LAYOUT: vk::ImageLayout = vk::ImageLayout::FRAGMENT_SHADING_RATE_ATTACHMENT_OPTIMAL_KHR;
const RATE_STAGE: vk::PipelineStageFlags2 = vk::PipelineStageFlags2::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
const RATE_READ: vk::AccessFlags2 = vk::AccessFlags2::FRAGMENT_SHADING_RATE_ATTACHMENT_READ_KHR;

/// A barrier for the rate image.
struct Barrier {
    layouts: [vk::ImageLayout; 2],
    src: (vk::PipelineStageFlags2, vk::AccessFlags2),
    dst: (vk::PipelineStageFlags2, vk::AccessFlags2),
}

/// Draws, and returns the texels of the last map, in hexadecimal digits.
pub fn frames(setup: &Setup) -> String {
    let (vk, plan) = (&setup.vk, &setup.plan);
    let [layers, rate_layers] = setup.layers();
    let [width, height] = setup.texels();
    let mut texels: Vec<u8> = (0..width * height * rate_layers)
        .map(|index| match plan.broken.as_str() {
            "texel value" => 0x0f,
            "coarse texel" => 0b1010,
            _ if plan.is("compute") => TEXELS[(index % width % 2) as usize],
            _ => setup.rates[index as usize % setup.rates.len()],
        })
        .collect();
    // SAFETY: plain use of Vulkan, except for the deliberate errors, which the layer has to find.
    unsafe {
        let (source, source_memory) = setup.buffer(&texels);
        let (rates, rates_memory) = setup.image(&rate_image(setup));
        let colour = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(COLOUR)
            .extent(vk::Extent3D { width: SIZE[0], height: SIZE[1], depth: 1 })
            .mip_levels(1)
            .array_layers(layers)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC);
        let (colour, colour_memory) = setup.image(&colour);
        let views = [view(setup, colour, vk::ImageViewType::TYPE_2D_ARRAY, COLOUR), rate_view(setup, rates)];
        let [pass, other_pass] = [true, false].map(|uses_rates| render_pass(setup, uses_rates));
        let of_framebuffer = if plan.breaks("framebuffer of another") { other_pass } else { pass };
        let framebuffer = framebuffer(setup, of_framebuffer, &views);
        let of_pipeline = if plan.breaks("pipeline of another") { other_pass } else { pass };
        let pipelines = pipelines(setup, of_pipeline);
        let pool =
            vk::CommandPoolCreateInfo::default().flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        let pool = vk.create_command_pool(&pool, None).unwrap();
        let [primary, secondary] =
            [vk::CommandBufferLevel::PRIMARY, vk::CommandBufferLevel::SECONDARY].map(|level| {
                let info = vk::CommandBufferAllocateInfo::default()
                    .command_pool(pool)
                    .level(level)
                    .command_buffer_count(1);
                vk.allocate_command_buffers(&info).unwrap()[0]
            });
        let drawing =
            Drawing { setup, views: &views, pass, framebuffer, pipeline: pipelines.all[0], secondary };
        let writer = plan.is("compute").then(|| Writer::new(setup, views[1]));
        let writing = Writing { setup, writer, source, rates };
        let record = |frame| {
            writing.map(primary, frame);
            if plan.is("framebuffer") {
                drawing.render_pass(primary);
            } else {
                colour_barrier(setup, primary, colour);
                drawing.dynamic(primary);
            }
        };
        for frame in 0..2 {
            let again = frame == 1 && plan.is("resubmitted");
            if again {
                texels.fill(0);
                setup.write(source_memory, &texels);
            } else {
                vk.begin_command_buffer(primary, &vk::CommandBufferBeginInfo::default()).unwrap();
                record(if plan.is("resubmitted") { 0 } else { frame });
                if plan.is("in_one") {
                    record(1);
                }
                vk.end_command_buffer(primary).unwrap();
            }
            if !plan.is("recorded") {
                submit(setup, primary);
            }
            if plan.is("in_one") {
                break;
            }
        }
        if plan.is("left") {
            // Nothing is destroyed.
            std::process::exit(0);
        }
        drop(writing);
        vk.destroy_command_pool(pool, None);
        for pipeline in pipelines.all {
            vk.destroy_pipeline(pipeline, None);
        }
        vk.destroy_pipeline_layout(pipelines.layout, None);
        if let Some(framebuffer) = framebuffer {
            vk.destroy_framebuffer(framebuffer, None);
        }
        for pass in [pass, other_pass] {
            vk.destroy_render_pass(pass, None);
        }
        for view in views {
            vk.destroy_image_view(view, None);
        }
        for (image, memory) in [(rates, rates_memory), (colour, colour_memory)] {
            vk.destroy_image(image, None);
            vk.free_memory(memory, None);
        }
        vk.destroy_buffer(source, None);
        vk.free_memory(source_memory, None);
    }
    texels.iter().map(|texel| format!("{texel:02x}")).collect()
}

/// Submits, and waits.
///
/// # Safety
/// `buffer` is of the setup's device, recorded and not pending.
unsafe fn submit(setup: &Setup, buffer: vk::CommandBuffer) {
    let vk = &setup.vk;
    let buffers = [buffer];
    let infos = [vk::CommandBufferSubmitInfo::default().command_buffer(buffer)];
    // SAFETY: plain use of Vulkan.
    unsafe {
        if setup.plan.is("framebuffer") {
            let submit = vk::SubmitInfo::default().command_buffers(&buffers);
            vk.queue_submit(setup.queue, &[submit], vk::Fence::null()).unwrap();
        } else {
            let submit = vk::SubmitInfo2::default().command_buffer_infos(&infos);
            vk.queue_submit2(setup.queue, &[submit], vk::Fence::null()).unwrap();
        }
        vk.queue_wait_idle(setup.queue).unwrap();
    }
}

/// Writes the map, by a copy or by a dispatch.
struct Writing<'a> {
    setup: &'a Setup,
    writer: Option<Writer<'a>>,
    source: vk::Buffer,
    rates: vk::Image,
}

impl Writing<'_> {
    /// Writes the rate image, which was read by the frame before.
    ///
    /// # Safety
    /// The command buffer is of the setup's device and in the recording state.
    unsafe fn map(&self, buffer: vk::CommandBuffer, frame: u32) {
        let (vk, plan) = (&self.setup.vk, &self.setup.plan);
        let written = match &self.writer {
            Some(_) => (vk::PipelineStageFlags2::COMPUTE_SHADER, vk::AccessFlags2::SHADER_WRITE),
            None => (vk::PipelineStageFlags2::TRANSFER, vk::AccessFlags2::TRANSFER_WRITE),
        };
        let while_written = match &self.writer {
            Some(_) => vk::ImageLayout::GENERAL,
            None => vk::ImageLayout::TRANSFER_DST_OPTIMAL,
        };
        let old = if frame == 0 {
            vk::ImageLayout::UNDEFINED
        } else {
            plan.unless("old layout", rate_layout(self.setup), vk::ImageLayout::TRANSFER_SRC_OPTIMAL)
        };
        let before = plan.unless("read not waited for", RATE_STAGE, vk::PipelineStageFlags2::TOP_OF_PIPE);
        let src = plan.unless(
            "source access without stage",
            (before, vk::AccessFlags2::NONE),
            (vk::PipelineStageFlags2::FRAGMENT_SHADER, RATE_READ),
        );
        let to_write = Barrier { layouts: [old, while_written], src, dst: written };
        let dst = match plan.broken.as_str() {
            "stage" => (vk::PipelineStageFlags2::FRAGMENT_SHADER, vk::AccessFlags2::SHADER_READ),
            "access" => (RATE_STAGE, vk::AccessFlags2::NONE),
            "access without stage" => (vk::PipelineStageFlags2::FRAGMENT_SHADER, RATE_READ),
            _ => (RATE_STAGE, RATE_READ),
        };
        let read =
            plan.unless("layout at use", rate_layout(self.setup), vk::ImageLayout::TRANSFER_SRC_OPTIMAL);
        let host = (vk::PipelineStageFlags2::HOST, vk::AccessFlags2::HOST_WRITE);
        let to_read =
            Barrier { layouts: [while_written, read], src: plan.unless("source", written, host), dst };
        let layers = vk::ImageSubresourceLayers::default()
            .aspect_mask(vk::ImageAspectFlags::COLOR)
            .layer_count(self.setup.layers()[1]);
        let region = [vk::BufferImageCopy::default()
            .image_subresource(layers)
            .image_extent(extent(self.setup.texels()).into())];
        // SAFETY: plain use of Vulkan.
        unsafe {
            barrier(self.setup, buffer, self.rates, &to_write);
            match &self.writer {
                Some(writer) => writer.write(buffer),
                None => vk.cmd_copy_buffer_to_image(buffer, self.source, self.rates, while_written, &region),
            }
            if plan.is("transition") || plan.breaks("no barrier") {
                return;
            }
            barrier(self.setup, buffer, self.rates, &to_read);
            if plan.breaks("written after") {
                let layouts = [read, while_written];
                let back = Barrier { layouts, src: (RATE_STAGE, RATE_READ), dst: written };
                barrier(self.setup, buffer, self.rates, &back);
                let wrong = Barrier { layouts: [while_written, read], src: written, dst: written };
                barrier(self.setup, buffer, self.rates, &wrong);
            }
        }
    }
}

/// The layout in which the map is read.
fn rate_layout(setup: &Setup) -> vk::ImageLayout {
    if setup.plan.is("general") { vk::ImageLayout::GENERAL } else { RATE_LAYOUT }
}

/// Places a barrier: in the form with framebuffers by Vulkan 1.0, in the others by Vulkan 1.3.
///
/// # Safety
/// The command buffer is of the setup's device and in the recording state.
unsafe fn barrier(setup: &Setup, buffer: vk::CommandBuffer, image: vk::Image, with: &Barrier) {
    let vk = &setup.vk;
    let stages = |stages: vk::PipelineStageFlags2| vk::PipelineStageFlags::from_raw(stages.as_raw() as u32);
    let access = |access: vk::AccessFlags2| vk::AccessFlags::from_raw(access.as_raw() as u32);
    let [old, new] = with.layouts;
    // SAFETY: plain use of Vulkan.
    unsafe {
        if setup.plan.is("framebuffer") {
            let barrier = vk::ImageMemoryBarrier::default()
                .old_layout(old)
                .new_layout(new)
                .src_access_mask(access(with.src.1))
                .dst_access_mask(access(with.dst.1))
                .image(image)
                .subresource_range(whole());
            let (src, dst) = (stages(with.src.0), stages(with.dst.0));
            vk.cmd_pipeline_barrier(buffer, src, dst, Default::default(), &[], &[], &[barrier]);
        } else {
            let barriers = [vk::ImageMemoryBarrier2::default()
                .old_layout(old)
                .new_layout(new)
                .src_stage_mask(with.src.0)
                .src_access_mask(with.src.1)
                .dst_stage_mask(with.dst.0)
                .dst_access_mask(with.dst.1)
                .image(image)
                .subresource_range(whole())];
            vk.cmd_pipeline_barrier2(buffer, &vk::DependencyInfo::default().image_memory_barriers(&barriers));
        }
    }
}

/// # Safety
/// The command buffer is of the setup's device and in the recording state.
unsafe fn colour_barrier(setup: &Setup, buffer: vk::CommandBuffer, colour: vk::Image) {
    let stage = vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT;
    let write = vk::AccessFlags2::COLOR_ATTACHMENT_WRITE;
    let new = setup.plan.unless("foreign layout", vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL, RATE_LAYOUT);
    let layouts = [vk::ImageLayout::UNDEFINED, new];
    // SAFETY: plain use of Vulkan.
    unsafe { barrier(setup, buffer, colour, &Barrier { layouts, src: (stage, write), dst: (stage, write) }) }
}

struct Drawing<'a> {
    setup: &'a Setup,
    views: &'a [vk::ImageView; 2],
    pass: vk::RenderPass,
    framebuffer: Option<vk::Framebuffer>,
    pipeline: vk::Pipeline,
    secondary: vk::CommandBuffer,
}

impl Drawing<'_> {
    /// # Safety
    /// The command buffer is of the setup's device and in the recording state.
    unsafe fn render_pass(&self, buffer: vk::CommandBuffer) {
        let vk = &self.setup.vk;
        let clears = [vk::ClearValue::default()];
        let mut given = vk::RenderPassAttachmentBeginInfo::default().attachments(self.views);
        let mut info = vk::RenderPassBeginInfo::default()
            .render_pass(self.pass)
            .framebuffer(self.framebuffer.unwrap())
            .render_area(vk::Rect2D::default().extent(extent(SIZE)))
            .clear_values(&clears);
        if self.setup.plan.is("imageless") {
            info = info.push_next(&mut given);
        }
        // SAFETY: plain use of Vulkan.
        unsafe {
            if self.setup.plan.is("secondary") {
                let inherited = vk::CommandBufferInheritanceInfo::default().render_pass(self.pass);
                self.record_secondary(&inherited);
                let contents = vk::SubpassContents::SECONDARY_COMMAND_BUFFERS;
                vk.cmd_begin_render_pass(buffer, &info, contents);
                vk.cmd_execute_commands(buffer, &[self.secondary]);
            } else {
                vk.cmd_begin_render_pass(buffer, &info, vk::SubpassContents::INLINE);
                self.draw(buffer);
            }
            vk.cmd_end_render_pass(buffer);
        }
    }

    /// # Safety
    /// The command buffer is of the setup's device and in the recording state.
    unsafe fn dynamic(&self, buffer: vk::CommandBuffer) {
        let (vk, plan) = (&self.setup.vk, &self.setup.plan);
        let [colour, rates] = *self.views;
        let attachments = [vk::RenderingAttachmentInfo::default()
            .image_view(plan.unless("also drawn to", colour, rates))
            .image_layout(plan.unless(
                "foreign layout",
                vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
                RATE_LAYOUT,
            ))
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)];
        let mut rate = vk::RenderingFragmentShadingRateAttachmentInfoKHR::default()
            .image_view(rates)
            .image_layout(plan.unless(
                "layout",
                rate_layout(self.setup),
                vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
            ))
            .shading_rate_attachment_texel_size(super::objects::texel(self.setup));
        let secondary = plan.is("secondary");
        let flags = if secondary {
            vk::RenderingFlags::CONTENTS_SECONDARY_COMMAND_BUFFERS
        } else {
            vk::RenderingFlags::empty()
        };
        let layers = if plan.is("multiview") { 1 } else { plan.unless("layered view and layers", 1, 3) };
        let mut info = vk::RenderingInfo::default()
            .flags(flags)
            .render_area(vk::Rect2D::default().extent(extent(SIZE)))
            .layer_count(layers)
            .view_mask(view_mask(self.setup))
            .color_attachments(&attachments);
        if !plan.is("without_extension") || plan.breaks("rendering") {
            info = info.push_next(&mut rate);
        }
        // SAFETY: plain use of Vulkan.
        unsafe {
            if secondary {
                let formats = [COLOUR];
                let mut rendering = vk::CommandBufferInheritanceRenderingInfo::default()
                    .color_attachment_formats(&formats)
                    .rasterization_samples(vk::SampleCountFlags::TYPE_1);
                let inherited = vk::CommandBufferInheritanceInfo::default().push_next(&mut rendering);
                self.record_secondary(&inherited);
            }
            if plan.is("suspended") {
                info.flags = vk::RenderingFlags::SUSPENDING;
                vk.cmd_begin_rendering(buffer, &info);
                self.draw(buffer);
                vk.cmd_end_rendering(buffer);
                info.flags = vk::RenderingFlags::RESUMING;
            }
            vk.cmd_begin_rendering(buffer, &info);
            if secondary {
                vk.cmd_execute_commands(buffer, &[self.secondary]);
            } else {
                self.draw(buffer);
            }
            vk.cmd_end_rendering(buffer);
        }
    }

    /// # Safety
    /// The secondary command buffer is not pending; `inherited` is of the setup's objects.
    unsafe fn record_secondary(&self, inherited: &vk::CommandBufferInheritanceInfo<'_>) {
        let vk = &self.setup.vk;
        let begin = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::RENDER_PASS_CONTINUE)
            .inheritance_info(inherited);
        // SAFETY: plain use of Vulkan.
        unsafe {
            vk.begin_command_buffer(self.secondary, &begin).unwrap();
            self.draw(self.secondary);
            vk.end_command_buffer(self.secondary).unwrap();
        }
    }

    /// # Safety
    /// The command buffer is of the setup's device and in the recording state.
    unsafe fn draw(&self, buffer: vk::CommandBuffer) {
        let (vk, plan) = (&self.setup.vk, &self.setup.plan);
        let (size, combiners) = rate(self.setup);
        // SAFETY: plain use of Vulkan.
        unsafe {
            vk.cmd_bind_pipeline(buffer, vk::PipelineBindPoint::GRAPHICS, self.pipeline);
            vk.cmd_set_line_width(buffer, 1.0);
            if plan.is("dynamic_state") && !plan.breaks("rate not set") {
                (self.setup.set_rate.fp().cmd_set_fragment_shading_rate_khr)(buffer, &size, &combiners);
            }
            vk.cmd_draw(buffer, 3, 1, 0, 0);
        }
    }
}
