use super::*;
use crate::abi::copies::room;
use vk::ImageAspectFlags as Aspects;
use vk::ImageLayout as Layout;

fn reference(attachment: u32, layout: Layout) -> vk::AttachmentReference {
    vk::AttachmentReference { attachment, layout }
}

/// G-buffer and depth, lighting that reads both: the two subpasses of mobile renderers.
const ATTACHMENTS: [(vk::Format, vk::AttachmentLoadOp, Layout); 3] = [
    (vk::Format::R8G8B8A8_SRGB, vk::AttachmentLoadOp::DONT_CARE, Layout::UNDEFINED),
    (vk::Format::D24_UNORM_S8_UINT, vk::AttachmentLoadOp::CLEAR, Layout::UNDEFINED),
    (vk::Format::R16G16B16A16_SFLOAT, vk::AttachmentLoadOp::LOAD, Layout::COLOR_ATTACHMENT_OPTIMAL),
];

fn attachments() -> Vec<vk::AttachmentDescription> {
    let attachment = |&(format, load_op, initial_layout): &(_, _, _)| {
        vk::AttachmentDescription::default()
            .flags(vk::AttachmentDescriptionFlags::MAY_ALIAS)
            .format(format)
            .samples(vk::SampleCountFlags::TYPE_4)
            .load_op(load_op)
            .store_op(vk::AttachmentStoreOp::STORE)
            .stencil_load_op(vk::AttachmentLoadOp::CLEAR)
            .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
            .initial_layout(initial_layout)
            .final_layout(Layout::GENERAL)
    };
    ATTACHMENTS.iter().map(attachment).collect()
}

fn with_converted(chain: *const std::ffi::c_void, check: impl Fn(&vk::RenderPassCreateInfo2<'_>)) {
    let attachments = attachments();
    let drawn =
        [reference(0, Layout::COLOR_ATTACHMENT_OPTIMAL), reference(vk::ATTACHMENT_UNUSED, Layout::UNDEFINED)];
    let depth = reference(1, Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
    let inputs = [
        reference(0, Layout::SHADER_READ_ONLY_OPTIMAL),
        reference(1, Layout::DEPTH_STENCIL_READ_ONLY_OPTIMAL),
        reference(vk::ATTACHMENT_UNUSED, Layout::UNDEFINED),
    ];
    let lit = [reference(2, Layout::COLOR_ATTACHMENT_OPTIMAL)];
    let resolved = [reference(0, Layout::GENERAL)];
    let preserved = [1];
    let subpasses = [
        vk::SubpassDescription::default()
            .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
            .color_attachments(&drawn)
            .depth_stencil_attachment(&depth),
        vk::SubpassDescription::default()
            .flags(vk::SubpassDescriptionFlags::PER_VIEW_ATTRIBUTES_NVX)
            .input_attachments(&inputs)
            .color_attachments(&lit)
            .resolve_attachments(&resolved)
            .preserve_attachments(&preserved),
    ];
    let dependency = |src: u32, dst: u32| vk::SubpassDependency {
        src_subpass: src,
        dst_subpass: dst,
        src_stage_mask: vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT,
        dst_stage_mask: vk::PipelineStageFlags::FRAGMENT_SHADER,
        src_access_mask: vk::AccessFlags::COLOR_ATTACHMENT_WRITE,
        dst_access_mask: vk::AccessFlags::INPUT_ATTACHMENT_READ,
        dependency_flags: vk::DependencyFlags::BY_REGION | vk::DependencyFlags::VIEW_LOCAL,
    };
    let dependencies = [dependency(vk::SUBPASS_EXTERNAL, 0), dependency(0, 1), dependency(1, 1)];
    let info = vk::RenderPassCreateInfo {
        p_next: chain,
        flags: vk::RenderPassCreateFlags::TRANSFORM_QCOM,
        ..vk::RenderPassCreateInfo::default()
            .attachments(&attachments)
            .subpasses(&subpasses)
            .dependencies(&dependencies)
    };
    let mut room = room::<16>();
    let mut copies = Copies::new(&mut room);
    // SAFETY: valid structures that outlive the copies.
    check(&unsafe { convert(&info, &mut copies) }.unwrap());
}

#[test]
fn attachments_subpasses_and_dependencies_are_the_same() {
    with_converted(std::ptr::null(), |info| {
        // SAFETY: the structures are valid, as `with_converted` made them.
        let (attached, subpasses, dependencies) = unsafe {
            (
                slice(info.p_attachments, info.attachment_count),
                slice(info.p_subpasses, info.subpass_count),
                slice(info.p_dependencies, info.dependency_count),
            )
        };
        assert_eq!(info.flags, vk::RenderPassCreateFlags::TRANSFORM_QCOM);
        assert_eq!((attached.len(), subpasses.len(), dependencies.len()), (3, 2, 3));
        for (new, old) in attached.iter().zip(attachments()) {
            assert_eq!((new.flags, new.format, new.samples), (old.flags, old.format, old.samples));
            assert_eq!((new.load_op, new.store_op), (old.load_op, old.store_op));
            assert_eq!(
                (new.stencil_load_op, new.stencil_store_op),
                (old.stencil_load_op, old.stencil_store_op)
            );
            assert_eq!((new.initial_layout, new.final_layout), (old.initial_layout, old.final_layout));
        }
        let [first, second] = [&subpasses[0], &subpasses[1]];
        // SAFETY: as above.
        unsafe {
            let colours = slice(first.p_color_attachments, first.color_attachment_count);
            assert_eq!((colours[0].attachment, colours[0].layout), (0, Layout::COLOR_ATTACHMENT_OPTIMAL));
            assert_eq!(colours[1].attachment, vk::ATTACHMENT_UNUSED);
            assert!(first.p_resolve_attachments.is_null() && second.p_depth_stencil_attachment.is_null());
            let depth = first.p_depth_stencil_attachment.as_ref().unwrap();
            assert_eq!((depth.attachment, depth.layout), (1, Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL));
            let inputs = slice(second.p_input_attachments, second.input_attachment_count);
            let numbers: Vec<_> = inputs.iter().map(|input| input.attachment).collect();
            assert_eq!(numbers, [0, 1, vk::ATTACHMENT_UNUSED]);
            assert_eq!(inputs[0].aspect_mask, Aspects::COLOR);
            assert_eq!(inputs[1].aspect_mask, Aspects::DEPTH | Aspects::STENCIL, "all that the format has");
        }
        // SAFETY: as above.
        unsafe {
            let resolves = slice(second.p_resolve_attachments, second.color_attachment_count);
            assert_eq!((resolves[0].attachment, resolves[0].layout), (0, Layout::GENERAL));
            assert_eq!(slice(second.p_preserve_attachments, second.preserve_attachment_count), [1]);
        }
        assert_eq!(second.flags, vk::SubpassDescriptionFlags::PER_VIEW_ATTRIBUTES_NVX);
        assert_eq!((first.view_mask, second.view_mask), (0, 0));
        let ends = dependencies.iter().map(|dependency| (dependency.src_subpass, dependency.dst_subpass));
        assert_eq!(ends.collect::<Vec<_>>(), [(vk::SUBPASS_EXTERNAL, 0), (0, 1), (1, 1)]);
        for dependency in dependencies {
            assert_eq!(dependency.src_stage_mask, vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT);
            assert_eq!(dependency.dst_stage_mask, vk::PipelineStageFlags::FRAGMENT_SHADER);
            assert_eq!(dependency.src_access_mask, vk::AccessFlags::COLOR_ATTACHMENT_WRITE);
            assert_eq!(dependency.dst_access_mask, vk::AccessFlags::INPUT_ATTACHMENT_READ);
            let flags = vk::DependencyFlags::BY_REGION | vk::DependencyFlags::VIEW_LOCAL;
            assert_eq!((dependency.dependency_flags, dependency.view_offset), (flags, 0));
        }
    });
}

#[test]
fn views_and_aspects_of_the_chain_are_converted() {
    let aspects = [vk::InputAttachmentAspectReference {
        subpass: 1,
        input_attachment_index: 1,
        aspect_mask: Aspects::DEPTH,
    }];
    let mut aspects = vk::RenderPassInputAttachmentAspectCreateInfo::default().aspect_references(&aspects);
    let mut multiview = vk::RenderPassMultiviewCreateInfo::default()
        .view_masks(&[3, 2])
        .view_offsets(&[0, -1, 1])
        .correlation_masks(&[3]);
    multiview.p_next = (&raw mut aspects).cast();
    with_converted((&raw const multiview).cast(), |info| {
        // SAFETY: the structures are valid, as `with_converted` made them.
        unsafe {
            let subpasses = slice(info.p_subpasses, info.subpass_count);
            assert_eq!(subpasses.iter().map(|subpass| subpass.view_mask).collect::<Vec<_>>(), [3, 2]);
            let dependencies = slice(info.p_dependencies, info.dependency_count);
            let offsets = dependencies.iter().map(|dependency| dependency.view_offset);
            assert_eq!(offsets.collect::<Vec<_>>(), [0, -1, 1]);
            assert_eq!(slice(info.p_correlated_view_masks, info.correlated_view_mask_count), [3]);
            let inputs = slice(subpasses[1].p_input_attachments, 3);
            assert_eq!((inputs[0].aspect_mask, inputs[1].aspect_mask), (Aspects::COLOR, Aspects::DEPTH));
        }
        assert!(info.p_next.is_null());
    });
}

#[test]
fn a_structure_that_is_not_known_here_stops_it() {
    let density = vk::RenderPassFragmentDensityMapCreateInfoEXT::default();
    let info = vk::RenderPassCreateInfo { p_next: (&raw const density).cast(), ..Default::default() };
    let mut room = room::<16>();
    let mut copies = Copies::new(&mut room);
    // SAFETY: valid structures that outlive the copies.
    let result = unsafe { convert(&info, &mut copies) };
    let unknown = vk::StructureType::RENDER_PASS_FRAGMENT_DENSITY_MAP_CREATE_INFO_EXT;
    assert_eq!(result.map(|_| ()), Err(LeftAlone::Unknown(unknown)));
}
