//! Dynamic rendering: its rate attachments are checked and removed.

use super::chain::{LeftOut, find, slice};
use super::image::{Range, View};
use super::lower::{RATE_LAYOUT, RATE_USAGE};
use super::pass::{Begun, begin_reading, pass_ends};
use super::rate::RENDERING_TEXEL;
use super::recording::Current;
use super::state::State;
use super::{Emulator, emulator};
use ash::vk;

const KIND: &str = "command";

/// # Safety
/// As `vkCmdEndRendering`.
pub(super) unsafe extern "system" fn end_rendering(buffer: vk::CommandBuffer) {
    // SAFETY: the application's valid argument.
    unsafe {
        pass_ends(buffer);
        let Some(next) = emulator(buffer).functions.end_rendering else { return };
        next(buffer);
    }
}

type RateInfo<'a> = vk::RenderingFragmentShadingRateAttachmentInfoKHR<'a>;

/// # Safety
/// As `vkCmdBeginRendering`.
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
                let targets = targets(&state, &*info);
                pass = Some(begin_reading(
                    &emulator,
                    &mut state,
                    buffer,
                    Begun {
                        form: "dynamic",
                        area: (*info).render_area,
                        layers: if (*info).view_mask == 0 { (*info).layer_count } else { 1 },
                        view_mask: (*info).view_mask,
                        targets,
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
unsafe fn targets(state: &State, info: &vk::RenderingInfo<'_>) -> Vec<View> {
    // SAFETY: the caller vouches for it.
    let colours = unsafe { colours(info) };
    colours.iter().filter_map(|colour| state.views.get(&colour.image_view)).copied().collect()
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
