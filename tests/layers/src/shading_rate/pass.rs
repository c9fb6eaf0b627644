//! The begin and end of passes: what they say of rates is checked and taken out, and the map is copied ahead.

use super::barrier::note;
use super::chain::{LeftOut, find, slice};
use super::image::{Range, View};
use super::lines::ShadingRatePass;
use super::lower::{self, RATE_LAYOUT, RATE_READ, RATE_STAGE, RATE_USAGE};
use super::map::Shape;
use super::rate::RENDERING_TEXEL;
use super::recording::{Current, RecordedPass};
use super::render_pass::{RateAttachment, RenderPass};
use super::replay::{Event, Masks};
use super::state::State;
use super::{Emulator, capture, emulator, findings};
use ash::vk;

const KIND: &str = "command";

/// A pass that begins with a rate attachment.
struct Begun<'a> {
    form: &'static str,
    area: vk::Rect2D,
    layers: u32,
    view_mask: u32,
    formats: Vec<vk::Format>,
    texel: [u32; 2],
    view: &'a View,
    /// The map's layout as the pass begins.
    layout: vk::ImageLayout,
    /// The rule that this is so.
    rule: &'static str,
    waits_for: (vk::PipelineStageFlags2, vk::AccessFlags2),
}

/// Copies the map, and notes the pass; returns its place in the recording.
///
/// # Safety
///
/// The buffer is in the recording state and outside of passes.
unsafe fn begin(
    emulator: &Emulator,
    state: &mut State,
    buffer: vk::CommandBuffer,
    begun: Begun<'_>,
) -> usize {
    let View { image, range, extent, .. } = *begun.view;
    note(state, buffer, Event::Read { image, range, layout: begun.layout, rule: begun.rule });
    let vk::Rect2D { offset, extent: pixels } = begun.area;
    let [x, y] = [offset.x, offset.y].map(|at| at.max(0) as u32);
    let shape = Shape::under([x, y, pixels.width, pixels.height], begun.texel, extent, range.layers);
    let copied = if begun.layout == vk::ImageLayout::UNDEFINED {
        None
    } else {
        let device = &emulator.next.functions;
        let layout = lower::layout(begun.layout);
        // SAFETY: the caller vouches for the buffer; the image is live, or the pass would not be valid.
        unsafe {
            state.captures.take(device, shape.bytes()).inspect(|capture| {
                capture::copy(device, buffer, capture, (image, range, extent), layout, begun.waits_for);
            })
        }
    };
    let line = ShadingRatePass {
        index: 0,
        form: begun.form.to_owned(),
        area: [x, y, pixels.width, pixels.height],
        layers: begun.layers,
        view_mask: begun.view_mask,
        formats: begun.formats.iter().map(|format| format!("{format:?}")).collect(),
        draws: 0,
        draws_obeying: 0,
        texel: begun.texel,
        image: findings::name(image),
        map: None,
    };
    let recording = state.recordings.entry(buffer).or_default();
    recording.passes.push(RecordedPass { line, image, capture: copied.map(|capture| (capture, shape)) });
    recording.passes.len() - 1
}

/// # Safety
///
/// As for [`begin`]; `info` is valid.
unsafe fn render_pass_begins(buffer: vk::CommandBuffer, info: &vk::RenderPassBeginInfo<'_>) {
    // SAFETY: the caller vouches for it.
    unsafe {
        let emulator = emulator(buffer);
        let mut state = emulator.state();
        let state = &mut *state;
        let known = (state.render_passes.get(&info.render_pass), state.framebuffers.get(&info.framebuffer));
        let (Some(render_pass), Some(framebuffer)) = known else { return };
        let (render_pass, framebuffer) = (render_pass.clone(), framebuffer.clone());
        let rule = "VUID-VkRenderPassBeginInfo-renderPass-00904";
        let compatible = render_pass.rates == framebuffer.rates;
        state.findings.require(compatible, KIND, rule, info.framebuffer, || {
            format!(
                "rate attachments {:?} of the pass, {:?} of the framebuffer",
                render_pass.rates, framebuffer.rates
            )
        });
        let given = find::<vk::RenderPassAttachmentBeginInfo<'_>>(info.p_next)
            .map_or(&[][..], |given| slice(given.p_attachments, given.attachment_count));
        let views = framebuffer.views.as_deref().unwrap_or(given);
        let mut passes: Vec<Option<usize>> = Vec::new();
        for (subpass, rate) in render_pass.rates.iter().enumerate() {
            let before = render_pass.rates[..subpass].iter().position(|other| other == rate);
            let pass = match (before, rate) {
                (Some(before), _) => passes[before],
                (None, Some(rate)) => {
                    let view =
                        views.get(rate.attachment as usize).and_then(|view| state.views.get(view)).copied();
                    if let (Some(view), None) = (&view, &framebuffer.views) {
                        check_promise(state, &framebuffer.usages, rate, view, info.framebuffer);
                    }
                    view.map(|view| {
                        let form = if framebuffer.views.is_some() { "render_pass" } else { "imageless" };
                        let described =
                            Described { form, layers: framebuffer.layers, area: info.render_area };
                        subpass_begins(&emulator, state, buffer, &render_pass, subpass, &view, &described)
                    })
                }
                (None, None) => None,
            };
            passes.push(pass);
        }
        let recording = state.recordings.entry(buffer).or_default();
        recording.current = Some(Current::RenderPass { render_pass, subpass: 0, passes });
    }
}

/// What a render pass's begin says of all its subpasses.
struct Described {
    form: &'static str,
    layers: u32,
    area: vk::Rect2D,
}

/// # Safety
///
/// As for [`begin`].
unsafe fn subpass_begins(
    emulator: &Emulator,
    state: &mut State,
    buffer: vk::CommandBuffer,
    render_pass: &RenderPass,
    subpass: usize,
    view: &View,
    described: &Described,
) -> usize {
    let rate = render_pass.rates[subpass];
    let layouts = rate.and_then(|rate| render_pass.layouts.get(rate.attachment as usize));
    let (initial, last) = layouts.map_or_else(Default::default, |layouts| (layouts.initial, layouts.last));
    if !render_pass.waits_for.0.is_empty() {
        let masks = Masks { src: render_pass.waits_for, dst: (RATE_STAGE, RATE_READ) };
        note(state, buffer, Event::Barrier { image: None, masks });
    }
    let begun = Begun {
        form: described.form,
        area: described.area,
        layers: described.layers,
        view_mask: render_pass.view_masks[subpass],
        formats: render_pass.formats.clone(),
        texel: rate.map_or([0; 2], |rate| rate.texel),
        view,
        layout: initial,
        rule: "VUID-vkCmdBeginRenderPass-initialLayout-00900",
        waits_for: render_pass.waits_for,
    };
    // SAFETY: the caller vouches for the buffer.
    let pass = unsafe { begin(emulator, state, buffer, begun) };
    note(state, buffer, Event::Left { image: view.image, range: view.range, layout: last });
    pass
}

fn check_promise(
    state: &mut State,
    usages: &[vk::ImageUsageFlags],
    rate: &RateAttachment,
    view: &View,
    framebuffer: vk::Framebuffer,
) {
    let promised = usages.get(rate.attachment as usize).copied();
    let rule = "VUID-VkRenderPassBeginInfo-framebuffer-04627";
    state.findings.require(promised == view.usage, KIND, rule, framebuffer, || {
        format!("{:?}, and the framebuffer has {promised:?}", view.usage)
    });
}

pub(super) unsafe extern "system" fn begin_render_pass(
    buffer: vk::CommandBuffer,
    info: *const vk::RenderPassBeginInfo<'_>,
    contents: vk::SubpassContents,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        render_pass_begins(buffer, &*info);
        (emulator(buffer).v1_0().cmd_begin_render_pass)(buffer, info, contents);
    }
}

pub(super) unsafe extern "system" fn begin_render_pass2(
    buffer: vk::CommandBuffer,
    info: *const vk::RenderPassBeginInfo<'_>,
    subpass: *const vk::SubpassBeginInfo<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        render_pass_begins(buffer, &*info);
        let Some(next) = emulator(buffer).functions.begin_render_pass2 else { return };
        next(buffer, info, subpass);
    }
}

/// # Safety
///
/// The buffer is live.
unsafe fn subpass_ends(buffer: vk::CommandBuffer) {
    // SAFETY: the caller vouches for it.
    let emulator = unsafe { emulator(buffer) };
    let mut state = emulator.state();
    let current = state.recordings.get_mut(&buffer).and_then(|recording| recording.current.as_mut());
    if let Some(Current::RenderPass { subpass, .. }) = current {
        *subpass += 1;
    }
}

/// # Safety
///
/// The buffer is live.
unsafe fn pass_ends(buffer: vk::CommandBuffer) {
    // SAFETY: the caller vouches for it.
    let emulator = unsafe { emulator(buffer) };
    if let Some(recording) = emulator.state().recordings.get_mut(&buffer) {
        recording.current = None;
    }
}

pub(super) unsafe extern "system" fn next_subpass(buffer: vk::CommandBuffer, contents: vk::SubpassContents) {
    // SAFETY: the application's valid arguments.
    unsafe {
        subpass_ends(buffer);
        (emulator(buffer).v1_0().cmd_next_subpass)(buffer, contents);
    }
}

pub(super) unsafe extern "system" fn next_subpass2(
    buffer: vk::CommandBuffer,
    begin: *const vk::SubpassBeginInfo<'_>,
    end: *const vk::SubpassEndInfo<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        subpass_ends(buffer);
        let Some(next) = emulator(buffer).functions.next_subpass2 else { return };
        next(buffer, begin, end);
    }
}

pub(super) unsafe extern "system" fn end_render_pass(buffer: vk::CommandBuffer) {
    // SAFETY: the application's valid argument.
    unsafe {
        pass_ends(buffer);
        (emulator(buffer).v1_0().cmd_end_render_pass)(buffer);
    }
}

pub(super) unsafe extern "system" fn end_render_pass2(
    buffer: vk::CommandBuffer,
    end: *const vk::SubpassEndInfo<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        pass_ends(buffer);
        let Some(next) = emulator(buffer).functions.end_render_pass2 else { return };
        next(buffer, end);
    }
}

pub(super) unsafe extern "system" fn end_rendering(buffer: vk::CommandBuffer) {
    // SAFETY: the application's valid argument.
    unsafe {
        pass_ends(buffer);
        let Some(next) = emulator(buffer).functions.end_rendering else { return };
        next(buffer);
    }
}

type RateInfo<'a> = vk::RenderingFragmentShadingRateAttachmentInfoKHR<'a>;

pub(super) unsafe extern "system" fn begin_rendering(
    buffer: vk::CommandBuffer,
    info: *const vk::RenderingInfo<'_>,
) {
    // SAFETY: the application's valid arguments, without the extension's structure.
    unsafe {
        let emulator = emulator(buffer);
        let Some(next) = emulator.functions.begin_rendering else { return };
        let mut state = emulator.state();
        let chained = find::<RateInfo<'_>>((*info).p_next);
        let rule = "VUID-VkRenderingInfo-pNext-pNext";
        let holds = chained.is_none() || emulator.enabled.extension;
        state.findings.require(holds, KIND, rule, buffer, || "the extension is not enabled".to_owned());
        let rate = chained.filter(|rate| rate.image_view != vk::ImageView::null());
        let mut pass = None;
        if let Some(rate) = rate {
            check_rendering(&emulator, &mut state, buffer, &*info, rate);
            let resumes = (*info).flags.contains(vk::RenderingFlags::RESUMING);
            let view = state.views.get(&rate.image_view).copied();
            // Nothing may come between a pass and its continuation.
            if let Some(view) = view.filter(|_| !resumes) {
                let formats = formats(&state, &*info);
                pass = Some(begin(
                    &emulator,
                    &mut state,
                    buffer,
                    Begun {
                        form: "dynamic",
                        area: (*info).render_area,
                        layers: if (*info).view_mask == 0 { (*info).layer_count } else { 1 },
                        view_mask: (*info).view_mask,
                        formats,
                        texel: texel(rate),
                        view: &view,
                        layout: rate.image_layout,
                        rule: "rate attachment is in its layout",
                        waits_for: Default::default(),
                    },
                ));
            }
        }
        let recording = state.recordings.entry(buffer).or_default();
        recording.current = Some(Current::Rendering { pass, attachment: Some(rate.is_some()) });
        let mut lowered = *info;
        let mut left_out = LeftOut::new();
        left_out
            .leave_out(&mut lowered, vk::StructureType::RENDERING_FRAGMENT_SHADING_RATE_ATTACHMENT_INFO_KHR);
        next(buffer, &lowered);
    }
}

fn texel(rate: &RateInfo<'_>) -> [u32; 2] {
    let texel = rate.shading_rate_attachment_texel_size;
    [texel.width, texel.height]
}

/// # Safety
///
/// The structure is valid.
unsafe fn colours<'a>(info: &vk::RenderingInfo<'a>) -> &'a [vk::RenderingAttachmentInfo<'a>] {
    // SAFETY: the caller vouches for it.
    unsafe { slice(info.p_color_attachments, info.color_attachment_count) }
}

/// # Safety
///
/// The structure is valid.
unsafe fn formats(state: &State, info: &vk::RenderingInfo<'_>) -> Vec<vk::Format> {
    // SAFETY: the caller vouches for it.
    let colours = unsafe { colours(info) };
    colours.iter().filter_map(|colour| state.views.get(&colour.image_view)).map(|view| view.format).collect()
}

/// # Safety
///
/// The structures are valid.
unsafe fn check_rendering(
    emulator: &Emulator,
    state: &mut State,
    buffer: vk::CommandBuffer,
    info: &vk::RenderingInfo<'_>,
    rate: &RateInfo<'_>,
) {
    let handle = rate.image_view;
    let findings = &mut state.findings;
    let mut require = |holds, rule: &str, message: String| {
        findings.require(holds, KIND, rule, buffer, || message);
    };
    require(emulator.enabled.attachment, "attachmentFragmentShadingRate", "rate attachment".to_owned());
    let prefix = "VUID-VkRenderingFragmentShadingRateAttachmentInfoKHR-imageView";
    let layout = rate.image_layout;
    let allowed = [vk::ImageLayout::GENERAL, RATE_LAYOUT].contains(&layout);
    require(allowed, &format!("{prefix}-06147"), format!("{layout:?}"));
    // SAFETY: the caller vouches for the structures.
    let (colours, depth, stencil) =
        unsafe { (colours(info), slice(info.p_depth_attachment, 1), slice(info.p_stencil_attachment, 1)) };
    for attachment in [colours, depth, stencil].into_iter().flatten() {
        let other = [attachment.image_view, attachment.resolve_image_view];
        require(!other.contains(&handle), "VUID-VkRenderingInfo-imageView-06125", "also drawn to".to_owned());
        let holds = attachment.image_layout != RATE_LAYOUT;
        let rule = "VUID-VkRenderingAttachmentInfo-imageView-06143";
        require(holds, rule, format!("{:?}", attachment.image_layout));
    }
    if let Some(View { usage: Some(usage), range: Range { layers, .. }, extent, .. }) =
        state.views.get(&handle)
    {
        require(usage.contains(RATE_USAGE), &format!("{prefix}-06148"), format!("{usage:?}"));
        let [texel_width, texel_height] = texel(rate).map(|side| side.max(1));
        let vk::Rect2D { offset, extent: area } = info.render_area;
        let width = (offset.x.max(0) as u32 + area.width).div_ceil(texel_width);
        let height = (offset.y.max(0) as u32 + area.height).div_ceil(texel_height);
        let rule = "VUID-VkRenderingInfo-pNext-06119";
        require(extent.width >= width, rule, format!("{} of {width} texels", extent.width));
        let rule = "VUID-VkRenderingInfo-pNext-06121";
        require(extent.height >= height, rule, format!("{} of {height} texels", extent.height));
        if info.view_mask == 0 {
            let enough = *layers == 1 || *layers >= info.layer_count;
            let message = format!("{layers} layers for {}", info.layer_count);
            require(enough, "VUID-VkRenderingInfo-imageView-06123", message);
        } else {
            let enough = *layers == 1 || *layers >= u32::BITS - info.view_mask.leading_zeros();
            let message = format!("{layers} layers for the views {:#b}", info.view_mask);
            require(enough, "VUID-VkRenderingInfo-imageView-06124", message);
        }
        let layered = *layers == 1 || emulator.profile.layered();
        require(layered, "layeredShadingRateAttachments", format!("{layers} layers"));
    }
    RENDERING_TEXEL.check(emulator, &mut state.findings, rate.shading_rate_attachment_texel_size, buffer);
}
