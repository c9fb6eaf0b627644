use super::*;
use crate::abi::copies::room;
use crate::backend::attachment::capabilities;

type Rates<'a> = vk::FragmentShadingRateAttachmentInfoKHR<'a>;

fn reference(attachment: u32) -> vk::AttachmentReference2<'static> {
    vk::AttachmentReference2::default()
        .attachment(attachment)
        .layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
}

type Amended<'a> = Result<(vk::RenderPassCreateInfo2<'a>, AddedRates), LeftAlone>;

fn check(subpasses: &[vk::SubpassDescription2<'_>], check: impl FnOnce(Amended<'_>)) {
    check_with(false, subpasses, check);
}

fn check_with(needs_depth: bool, subpasses: &[vk::SubpassDescription2<'_>], check: impl FnOnce(Amended<'_>)) {
    let attachments = [vk::AttachmentDescription2::default().format(vk::Format::R8G8B8A8_UNORM); 2];
    let info = vk::RenderPassCreateInfo2::default().attachments(&attachments).subpasses(subpasses);
    let mut room = room::<64>();
    let mut copies = Copies::new(&mut room);
    // SAFETY: valid structures that outlive the copies.
    check(unsafe { with_rates(&info, &capabilities::tests::offered([16, 16]), needs_depth, &mut copies) });
}

#[test]
fn each_colour_subpass_reads_it_and_others_preserve_it() {
    let (colour, depth) = ([reference(0)], reference(1));
    let preserved = [0];
    let chained = vk::SubpassDescriptionDepthStencilResolve::default();
    let mut draws = vk::SubpassDescription2::default().view_mask(2).color_attachments(&colour);
    draws.p_next = (&raw const chained).cast();
    let prepares = vk::SubpassDescription2::default()
        .view_mask(5)
        .depth_stencil_attachment(&depth)
        .preserve_attachments(&preserved);
    check(&[prepares, draws], |result| {
        let (info, added) = result.unwrap();
        assert_eq!(added, AddedRates { attachment: 2, views: 3 });
        // SAFETY: so many attachments, each valid.
        let attachments = unsafe { slice(info.p_attachments, info.attachment_count) };
        assert_eq!(attachments.len(), 3);
        let rates = &attachments[2];
        let layout = vk::ImageLayout::FRAGMENT_SHADING_RATE_ATTACHMENT_OPTIMAL_KHR;
        assert_eq!((rates.format, rates.samples), (vk::Format::R8_UINT, vk::SampleCountFlags::TYPE_1));
        assert_eq!(
            (rates.load_op, rates.store_op),
            (vk::AttachmentLoadOp::LOAD, vk::AttachmentStoreOp::STORE)
        );
        assert_eq!((rates.initial_layout, rates.final_layout), (layout, layout));
        // SAFETY: the structures are valid, with so many elements in their arrays.
        unsafe {
            let [prepares, draws] = slice(info.p_subpasses, info.subpass_count) else { panic!() };
            assert_eq!(slice(prepares.p_preserve_attachments, prepares.preserve_attachment_count), [0, 2]);
            assert!(find::<Rates<'_>>(prepares.p_next).is_none());
            let rates = find::<Rates<'_>>(draws.p_next).unwrap();
            let texel = rates.shading_rate_attachment_texel_size;
            assert_eq!((texel.width, texel.height), (16, 16));
            let reference = rates.p_fragment_shading_rate_attachment.as_ref().unwrap();
            assert_eq!((reference.attachment, reference.layout), (2, layout));
            assert!(find::<vk::SubpassDescriptionDepthStencilResolve<'_>>(draws.p_next).is_some());
        }
    });
}

#[test]
fn where_attachments_cost_time_only_subpasses_with_depth_have_one() {
    let (colour, depth) = ([reference(0)], reference(1));
    let filters = vk::SubpassDescription2::default().color_attachments(&colour);
    let draws = filters.depth_stencil_attachment(&depth);
    let attached = |needs_depth| {
        let mut attached = Vec::new();
        check_with(needs_depth, &[draws, filters], |result| {
            let (info, _) = result.unwrap();
            // SAFETY: the structures are valid, with so many elements.
            unsafe {
                for subpass in slice(info.p_subpasses, info.subpass_count) {
                    let has_rates = find::<Rates<'_>>(subpass.p_next).is_some();
                    assert_eq!(subpass.preserve_attachment_count, u32::from(!has_rates));
                    attached.push(has_rates);
                }
            }
        });
        attached
    };
    assert_eq!((attached(false), attached(true)), (vec![true, true], vec![true, false]));
    check_with(true, &[filters], |result| assert_eq!(result.err(), Some(LeftAlone::NoColour)));
}

#[test]
fn a_structure_without_an_attachment_is_filled() {
    let colour = [reference(0)];
    let unused = vk::AttachmentReference2::default().attachment(vk::ATTACHMENT_UNUSED);
    for mut own in [Rates::default(), Rates::default().fragment_shading_rate_attachment(&unused)] {
        let draws = vk::SubpassDescription2::default().color_attachments(&colour).push_next(&mut own);
        check(&[draws], |result| {
            let (info, _) = result.unwrap();
            // SAFETY: the structures are valid.
            unsafe {
                let subpass = info.p_subpasses.as_ref().unwrap();
                let rates = find::<Rates<'_>>(subpass.p_next).unwrap();
                assert_eq!((*rates.p_fragment_shading_rate_attachment).attachment, 2);
                assert!(find::<Rates<'_>>(rates.p_next).is_none(), "not doubled");
            }
        });
    }
}

#[test]
fn passes_with_rates_of_their_own_or_without_colour_are_left_alone() {
    let (colour, depth) = ([reference(0)], reference(1));
    let own = reference(1);
    let mut rates = Rates::default().fragment_shading_rate_attachment(&own);
    let draws = vk::SubpassDescription2::default().color_attachments(&colour);
    let obeys = draws.push_next(&mut rates);
    check(&[draws, obeys], |result| assert_eq!(result.unwrap_err(), LeftAlone::OwnRates));
    let prepares = vk::SubpassDescription2::default().depth_stencil_attachment(&depth);
    let unused = [reference(vk::ATTACHMENT_UNUSED)];
    let nothing = vk::SubpassDescription2::default().color_attachments(&unused);
    check(&[prepares, nothing], |result| assert_eq!(result.unwrap_err(), LeftAlone::NoColour));
}

/// Godot's mobile renderer: the second subpass reads the scene as an input attachment, and maps its tones.
#[test]
fn a_subpass_that_maps_tones_stays_at_full_rate() {
    let (scene, picture, depth) = ([reference(0)], [reference(1)], reference(1));
    let draws = vk::SubpassDescription2::default().color_attachments(&scene);
    let maps = vk::SubpassDescription2::default().color_attachments(&picture).input_attachments(&scene);
    let both = [reference(0), reference(1)];
    let lights = vk::SubpassDescription2::default().color_attachments(&picture).input_attachments(&both);
    let draws_on = maps.depth_stencil_attachment(&depth);
    for (second, obeys) in [(maps, false), (lights, true), (draws_on, true)] {
        check(&[draws, second], |result| {
            let (info, _) = result.unwrap();
            // SAFETY: the structures are valid, with so many elements in their arrays.
            unsafe {
                let [first, second] = slice(info.p_subpasses, info.subpass_count) else { panic!() };
                assert!(find::<Rates<'_>>(first.p_next).is_some());
                assert_eq!(find::<Rates<'_>>(second.p_next).is_some(), obeys);
                let preserved = slice(second.p_preserve_attachments, second.preserve_attachment_count);
                assert_eq!(preserved.contains(&2), !obeys);
            }
        });
    }
    // It reads what no earlier subpass has drawn.
    check(&[maps, draws], |result| {
        // SAFETY: as above.
        unsafe { assert!(find::<Rates<'_>>((*result.unwrap().0.p_subpasses).p_next).is_some()) };
    });
}
