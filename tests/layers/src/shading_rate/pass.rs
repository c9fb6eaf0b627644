//! The begin and end of passes: their rate attachments are checked and removed, and the map is copied ahead.

use super::barrier::note;
use super::chain::{find, slice};
use super::image::View;
use super::lines::ShadingRatePass;
use super::lower::{self, RATE_READ, RATE_STAGE};
use super::map::Shape;
use super::recording::{Current, RecordedPass};
use super::render_pass::{RateAttachment, RenderPass, are_compatible};
use super::replay::{Event, Masks};
use super::state::State;
use super::{Emulator, capture, emulator, findings};
use ash::vk;

const KIND: &str = "command";

/// A pass that begins with a rate attachment.
pub(super) struct Begun<'a> {
    pub form: &'static str,
    pub area: vk::Rect2D,
    pub layers: u32,
    pub view_mask: u32,
    /// Of the colour attachments.
    pub targets: Vec<View>,
    pub texel: [u32; 2],
    pub view: &'a View,
    /// The map's layout as the pass begins.
    pub layout: vk::ImageLayout,
    /// The rule that this is so.
    pub rule: &'static str,
    pub waits_for: (vk::PipelineStageFlags2, vk::AccessFlags2),
}

/// Copies the map, and notes the pass; returns its place in the recording.
///
/// # Safety
///
/// The buffer is in the recording state and outside of passes.
pub(super) unsafe fn begin_reading(
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
        formats: begun.targets.iter().map(|view| format!("{:?}", view.format)).collect(),
        targets: begun.targets.iter().map(|view| findings::name(view.image)).collect(),
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
/// As for [`begin_reading`]; `info` is valid.
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
        let compatible = are_compatible(&render_pass.rates, &framebuffer.rates);
        state.findings.require(compatible, KIND, rule, info.framebuffer, || {
            format!(
                "rate attachments {:?} of the pass, {:?} of the framebuffer",
                render_pass.rates, framebuffer.rates
            )
        });
        let given = find::<vk::RenderPassAttachmentBeginInfo<'_>>(info.p_next)
            .map_or(&[][..], |given| slice(given.p_attachments, given.attachment_count));
        let views = framebuffer.views.as_deref().unwrap_or(given);
        let known_view =
            |index: u32| views.get(index as usize).and_then(|view| state.views.get(view)).copied();
        let described = Described {
            form: if framebuffer.views.is_some() { "render_pass" } else { "imageless" },
            layers: framebuffer.layers,
            area: info.render_area,
            targets: render_pass.colours.iter().filter_map(|&colour| known_view(colour)).collect(),
        };
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

/// Facts of all subpasses from a render pass's begin.
struct Described {
    form: &'static str,
    layers: u32,
    area: vk::Rect2D,
    targets: Vec<View>,
}

/// # Safety
///
/// As for [`begin_reading`].
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
        targets: described.targets.clone(),
        texel: rate.map_or([0; 2], |rate| rate.texel),
        view,
        layout: initial,
        rule: "VUID-vkCmdBeginRenderPass-initialLayout-00900",
        waits_for: render_pass.waits_for,
    };
    // SAFETY: the caller vouches for the buffer.
    let pass = unsafe { begin_reading(emulator, state, buffer, begun) };
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

/// # Safety
/// As `vkCmdBeginRenderPass`.
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

/// # Safety
/// As `vkCmdBeginRenderPass2`.
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
pub(super) unsafe fn pass_ends(buffer: vk::CommandBuffer) {
    // SAFETY: the caller vouches for it.
    let emulator = unsafe { emulator(buffer) };
    if let Some(recording) = emulator.state().recordings.get_mut(&buffer) {
        recording.current = None;
    }
}

/// # Safety
/// As `vkCmdNextSubpass`.
pub(super) unsafe extern "system" fn next_subpass(buffer: vk::CommandBuffer, contents: vk::SubpassContents) {
    // SAFETY: the application's valid arguments.
    unsafe {
        subpass_ends(buffer);
        (emulator(buffer).v1_0().cmd_next_subpass)(buffer, contents);
    }
}

/// # Safety
/// As `vkCmdNextSubpass2`.
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

/// # Safety
/// As `vkCmdEndRenderPass`.
pub(super) unsafe extern "system" fn end_render_pass(buffer: vk::CommandBuffer) {
    // SAFETY: the application's valid argument.
    unsafe {
        pass_ends(buffer);
        (emulator(buffer).v1_0().cmd_end_render_pass)(buffer);
    }
}

/// # Safety
/// As `vkCmdEndRenderPass2`.
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
