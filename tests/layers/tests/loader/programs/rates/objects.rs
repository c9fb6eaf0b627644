//! Images, views, render passes and framebuffers; alone with pipelines, where one of them is broken.

use super::pipelines::pipelines;
use super::setup::{SIZE, Setup, extent};
use ash::vk;

const RATE_LAYOUT: vk::ImageLayout = vk::ImageLayout::FRAGMENT_SHADING_RATE_ATTACHMENT_OPTIMAL_KHR;
pub const COLOUR: vk::Format = vk::Format::R8G8B8A8_UNORM;

/// Creates, and destroys, the object of the test.
pub fn create(setup: &Setup) {
    let vk = &setup.vk;
    // SAFETY: the layer has to find the errors of the objects; nothing is drawn.
    unsafe {
        let (image, memory) = setup.image(&rate_image(setup));
        let view = rate_view(setup, image);
        let pass = render_pass(setup, true);
        let framebuffer = framebuffer(setup, pass, &[rate_view(setup, image), view]);
        let pipelines = pipelines(setup, pass);
        for pipeline in pipelines.all {
            vk.destroy_pipeline(pipeline, None);
        }
        vk.destroy_pipeline_layout(pipelines.layout, None);
        if let Some(framebuffer) = framebuffer {
            vk.destroy_framebuffer(framebuffer, None);
        }
        vk.destroy_render_pass(pass, None);
        vk.destroy_image_view(view, None);
        vk.destroy_image(image, None);
        vk.free_memory(memory, None);
    }
}

pub fn rate_image<'a>(setup: &Setup) -> vk::ImageCreateInfo<'a> {
    let plan = &setup.plan;
    let [mut width, mut height] = setup.texels();
    if plan.breaks("narrow") {
        width -= 1;
    }
    if plan.breaks("low") {
        height -= 1;
    }
    let cube = plan.breaks("cube view");
    if cube {
        width = height;
    }
    let layers = if plan.broken.starts_with("layered view") { 2 } else { setup.layers()[1] };
    let flags = if cube {
        vk::ImageCreateFlags::CUBE_COMPATIBLE
    } else {
        plan.unless("view format", vk::ImageCreateFlags::empty(), vk::ImageCreateFlags::MUTABLE_FORMAT)
    };
    let mut usage = vk::ImageUsageFlags::TRANSFER_DST;
    if plan.breaks("usage") {
        usage |= vk::ImageUsageFlags::SAMPLED;
    } else {
        usage |= vk::ImageUsageFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
    }
    if plan.is("compute") {
        usage |= vk::ImageUsageFlags::STORAGE;
    }
    let volume = plan.breaks("3D image");
    vk::ImageCreateInfo::default()
        .flags(flags)
        .image_type(if volume { vk::ImageType::TYPE_3D } else { vk::ImageType::TYPE_2D })
        .format(plan.unless("image format", vk::Format::R8_UINT, vk::Format::R8_UNORM))
        .extent(vk::Extent3D { width, height, depth: 1 })
        .mip_levels(1)
        .array_layers(if cube { 6 } else { layers })
        .samples(plan.unless("samples", vk::SampleCountFlags::TYPE_1, vk::SampleCountFlags::TYPE_4))
        .tiling(plan.unless("tiling", vk::ImageTiling::OPTIMAL, vk::ImageTiling::LINEAR))
        .usage(usage)
}

pub fn rate_view(setup: &Setup, image: vk::Image) -> vk::ImageView {
    let plan = &setup.plan;
    let view_type = if plan.breaks("3D image") {
        vk::ImageViewType::TYPE_3D
    } else {
        plan.unless("cube view", vk::ImageViewType::TYPE_2D_ARRAY, vk::ImageViewType::CUBE)
    };
    let format = plan.unless("image format", vk::Format::R8_UINT, vk::Format::R8_UNORM);
    view(setup, image, view_type, plan.unless("view format", format, vk::Format::R8_SINT))
}

pub fn view(
    setup: &Setup,
    image: vk::Image,
    view_type: vk::ImageViewType,
    format: vk::Format,
) -> vk::ImageView {
    let info = vk::ImageViewCreateInfo::default()
        .image(image)
        .view_type(view_type)
        .format(format)
        .subresource_range(crate::device::whole());
    // SAFETY: plain use of Vulkan.
    unsafe { setup.vk.create_image_view(&info, None).unwrap() }
}

pub fn texel(setup: &Setup) -> vk::Extent2D {
    let side = setup.texel;
    extent(match setup.plan.broken.as_str() {
        "texel width odd" => [12, side],
        "texel height odd" => [side, 12],
        "texel too wide" => [2 * side, side],
        "texel too high" => [side, 2 * side],
        "texel too narrow" => [side / 2, side],
        "texel too low" => [side, side / 2],
        _ => [side; 2],
    })
}

/// Views of multiview.
pub fn view_mask(setup: &Setup) -> u32 {
    match (setup.plan.is("multiview"), setup.plan.breaks("view beyond layers")) {
        (true, true) => 0b100,
        (true, false) => 0b11,
        _ => 0,
    }
}

/// A render pass of a colour attachment and a rate attachment, which is used if `uses_rates`.
pub fn render_pass(setup: &Setup, uses_rates: bool) -> vk::RenderPass {
    let plan = &setup.plan;
    let colour = vk::AttachmentDescription2::default()
        .format(COLOUR)
        .samples(vk::SampleCountFlags::TYPE_1)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(vk::AttachmentStoreOp::STORE)
        .final_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL);
    let rate = vk::AttachmentDescription2::default()
        .format(plan.unless("attachment format", vk::Format::R8_UINT, vk::Format::R8_SINT))
        .samples(vk::SampleCountFlags::TYPE_1)
        .load_op(plan.unless("load", vk::AttachmentLoadOp::LOAD, vk::AttachmentLoadOp::DONT_CARE))
        .store_op(vk::AttachmentStoreOp::STORE)
        .initial_layout(if plan.is("transition") {
            vk::ImageLayout::TRANSFER_DST_OPTIMAL
        } else {
            RATE_LAYOUT
        })
        .final_layout(RATE_LAYOUT);
    let attachments = [colour, rate];
    let colours = [vk::AttachmentReference2::default()
        .attachment(0)
        .aspect_mask(vk::ImageAspectFlags::COLOR)
        .layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)];
    let inputs = [vk::AttachmentReference2::default()
        .attachment(1)
        .aspect_mask(vk::ImageAspectFlags::COLOR)
        .layout(vk::ImageLayout::GENERAL)];
    let rates = vk::AttachmentReference2::default()
        .attachment(plan.unless("attachment index", 1, 7))
        .layout(plan.unless("layout", RATE_LAYOUT, vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL));
    let mut chained = vk::FragmentShadingRateAttachmentInfoKHR::default()
        .fragment_shading_rate_attachment(&rates)
        .shading_rate_attachment_texel_size(texel(setup));
    let mut subpass = vk::SubpassDescription2::default()
        .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
        .view_mask(view_mask(setup))
        .color_attachments(&colours);
    if plan.breaks("used otherwise") {
        subpass = subpass.input_attachments(&inputs);
    }
    if uses_rates && (!plan.is("without_extension") || plan.breaks("subpass")) {
        subpass = subpass.push_next(&mut chained);
    }
    let subpasses = [subpass];
    let (output, write) =
        (vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT, vk::AccessFlags::COLOR_ATTACHMENT_WRITE);
    let before = vk::SubpassDependency2::default().src_subpass(vk::SUBPASS_EXTERNAL).dst_subpass(0);
    let of_colour =
        before.src_stage_mask(output).src_access_mask(write).dst_stage_mask(output).dst_access_mask(write);
    let of_rates = before
        .src_stage_mask(vk::PipelineStageFlags::TRANSFER)
        .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
        .dst_stage_mask(vk::PipelineStageFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR)
        .dst_access_mask(vk::AccessFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_READ_KHR);
    let dependencies = [of_colour, of_rates];
    let waits_for_rates = plan.breaks("dependency") || plan.is("transition") && !plan.breaks("no dependency");
    let info = vk::RenderPassCreateInfo2::default()
        .attachments(&attachments)
        .subpasses(&subpasses)
        .dependencies(if waits_for_rates { &dependencies } else { &dependencies[..1] });
    // SAFETY: plain use of Vulkan.
    unsafe { setup.vk.create_render_pass2(&info, None).unwrap() }
}

/// A framebuffer of a render pass, imageless if the form is; none where the form has no framebuffers.
pub fn framebuffer(
    setup: &Setup,
    render_pass: vk::RenderPass,
    views: &[vk::ImageView; 2],
) -> Option<vk::Framebuffer> {
    let plan = &setup.plan;
    if !plan.is("framebuffer") {
        return None;
    }
    let [width, height] = SIZE;
    let formats = [[COLOUR], [vk::Format::R8_UINT]];
    let rates = rate_image(setup);
    let [layers, rate_layers] = setup.layers();
    let images = [
        vk::FramebufferAttachmentImageInfo::default()
            .usage(vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC)
            .width(width)
            .height(height)
            .layer_count(layers)
            .view_formats(&formats[0]),
        vk::FramebufferAttachmentImageInfo::default()
            .usage(if plan.breaks("promised usage") {
                rates.usage | vk::ImageUsageFlags::STORAGE
            } else {
                rates.usage
            })
            .width(rates.extent.width)
            .height(rates.extent.height)
            .layer_count(if plan.breaks("layers") { 2 } else { rate_layers })
            .view_formats(&formats[1]),
    ];
    let mut attachments = vk::FramebufferAttachmentsCreateInfo::default().attachment_image_infos(&images);
    let mut info = vk::FramebufferCreateInfo::default()
        .render_pass(render_pass)
        .width(width)
        .height(height)
        .layers(plan.unless("layers", plan.unless("layered view and layers", 1, 3), 3));
    if plan.is("imageless") {
        info.attachment_count = 2;
        info = info.flags(vk::FramebufferCreateFlags::IMAGELESS).push_next(&mut attachments);
    } else {
        info = info.attachments(views);
    }
    // SAFETY: plain use of Vulkan.
    Some(unsafe { setup.vk.create_framebuffer(&info, None).unwrap() })
}
