use super::*;

const COLOR: vk::Format = vk::Format::R8G8B8A8_SRGB;
const DEPTH: vk::Format = vk::Format::D32_SFLOAT_S8_UINT;
const COLOR_LAYOUT: vk::ImageLayout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
const DEPTH_LAYOUT: vk::ImageLayout = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
const CLEAR: vk::AttachmentLoadOp = vk::AttachmentLoadOp::CLEAR;
const LOAD: vk::AttachmentLoadOp = vk::AttachmentLoadOp::LOAD;
const STORE: vk::AttachmentStoreOp = vk::AttachmentStoreOp::STORE;

/// Colour in 4 samples, its resolve target, depth, and the target of the second subpass.
const FORMATS: [(vk::Format, vk::SampleCountFlags); 4] = [
    (COLOR, vk::SampleCountFlags::TYPE_4),
    (COLOR, vk::SampleCountFlags::TYPE_1),
    (DEPTH, vk::SampleCountFlags::TYPE_4),
    (COLOR, vk::SampleCountFlags::TYPE_1),
];

fn version_1(masks: Option<[u32; 2]>) -> RenderPass {
    let attachments = FORMATS.map(|(format, samples)| {
        vk::AttachmentDescription::default()
            .format(format)
            .samples(samples)
            .load_op(CLEAR)
            .store_op(STORE)
            .stencil_load_op(LOAD)
            .final_layout(COLOR_LAYOUT)
    });
    let reference = |attachment, layout| vk::AttachmentReference { attachment, layout };
    let unused = reference(vk::ATTACHMENT_UNUSED, vk::ImageLayout::UNDEFINED);
    let first_colors = [unused, reference(0, COLOR_LAYOUT)];
    let first_resolves = [unused, reference(1, COLOR_LAYOUT)];
    let depth = reference(2, DEPTH_LAYOUT);
    let second_colors = [reference(3, COLOR_LAYOUT)];
    let second_inputs = [reference(1, vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)];
    let subpasses = [
        vk::SubpassDescription::default()
            .color_attachments(&first_colors)
            .resolve_attachments(&first_resolves)
            .depth_stencil_attachment(&depth),
        vk::SubpassDescription::default().color_attachments(&second_colors).input_attachments(&second_inputs),
    ];
    let masks = masks.unwrap_or_default();
    let mut multiview = vk::RenderPassMultiviewCreateInfo::default().view_masks(&masks);
    let info = vk::RenderPassCreateInfo::default()
        .attachments(&attachments)
        .subpasses(&subpasses)
        .push_next(&mut multiview);
    // SAFETY: a valid structure.
    unsafe { RenderPass::of_version_1(&info) }
}

fn version_2(masks: [u32; 2], has_rates: bool) -> RenderPass {
    let attachments = FORMATS.map(|(format, samples)| {
        vk::AttachmentDescription2::default()
            .format(format)
            .samples(samples)
            .load_op(CLEAR)
            .store_op(STORE)
            .stencil_load_op(LOAD)
            .final_layout(COLOR_LAYOUT)
    });
    let reference =
        |attachment, layout| vk::AttachmentReference2::default().attachment(attachment).layout(layout);
    let unused = reference(vk::ATTACHMENT_UNUSED, vk::ImageLayout::UNDEFINED);
    let first_colors = [unused, reference(0, COLOR_LAYOUT)];
    let first_resolves = [unused, reference(1, COLOR_LAYOUT)];
    let depth = reference(2, DEPTH_LAYOUT);
    let second_colors = [reference(3, COLOR_LAYOUT)];
    let second_inputs = [reference(1, vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)];
    let rates = if has_rates { reference(3, COLOR_LAYOUT) } else { unused };
    let mut own_rates =
        vk::FragmentShadingRateAttachmentInfoKHR::default().fragment_shading_rate_attachment(&rates);
    let subpasses = [
        vk::SubpassDescription2::default()
            .view_mask(masks[0])
            .color_attachments(&first_colors)
            .resolve_attachments(&first_resolves)
            .depth_stencil_attachment(&depth)
            .push_next(&mut own_rates),
        vk::SubpassDescription2::default()
            .view_mask(masks[1])
            .color_attachments(&second_colors)
            .input_attachments(&second_inputs),
    ];
    let info = vk::RenderPassCreateInfo2::default().attachments(&attachments).subpasses(&subpasses);
    // SAFETY: a valid structure.
    unsafe { RenderPass::of_version_2(&info) }
}

#[test]
fn both_versions_say_the_same() {
    assert_eq!(version_1(None), version_2([0, 0], false));
    assert_eq!(version_1(Some([1, 2])), version_2([1, 2], false));
}

#[test]
fn attachments_of_all_subpasses_are_named_once() {
    let pass = version_2([1, 2], false);
    assert_eq!((pass.colors.as_slice(), pass.resolves.as_slice()), (&[0, 3][..], &[1][..]));
    assert_eq!((pass.depth, pass.view_mask), (Some(2), 3));
    assert_eq!(pass.subpasses[0].colors.as_slice(), [None, Some(0)]);
    assert_eq!(pass.subpasses[0].depth, Some((2, DEPTH_LAYOUT)));
    assert_eq!(pass.subpasses[1].inputs.as_slice(), [Some(1)]);
}

#[test]
fn facts_are_those_of_the_depth_attachment() {
    let facts = version_1(None).facts;
    assert_eq!(
        facts,
        PassFacts { clears_depth: true, stores_depth: true, loads_stencil: true, ..PassFacts::default() }
    );
    assert!(version_2([0, 0], true).facts.has_own_rates);
}
