use super::*;
use crate::abi::copies::room;
use crate::backend::attachment::capabilities;
use ash::vk::Handle;

fn colour(view: u64) -> vk::RenderingAttachmentInfo<'static> {
    vk::RenderingAttachmentInfo::default().image_view(vk::ImageView::from_raw(view))
}

#[test]
fn colour_passes_without_rates_of_their_own_want_them() {
    let (drawn, unused) = ([colour(0), colour(1)], [colour(0)]);
    let depth = colour(2);
    let view = vk::ImageView::from_raw(3);
    // SAFETY: valid structures.
    let wants = |info: vk::RenderingInfo<'_>| unsafe { wants_rates(&info) };
    assert_eq!(wants(vk::RenderingInfo::default().color_attachments(&drawn)), Ok(()));
    let prepares = vk::RenderingInfo::default().depth_attachment(&depth);
    assert_eq!(wants(prepares), Err(LeftAlone::NoColour));
    assert_eq!(wants(prepares.color_attachments(&unused)), Err(LeftAlone::NoColour));
    let mut empty = Rates::default();
    let mut own = Rates::default().image_view(view);
    let mut density = vk::RenderingFragmentDensityMapAttachmentInfoEXT::default().image_view(view);
    let draws = vk::RenderingInfo::default().color_attachments(&drawn);
    assert_eq!(wants(draws.push_next(&mut empty)), Ok(()), "vkd3d-proton");
    assert_eq!(wants(draws.push_next(&mut own)), Err(LeftAlone::OwnRates));
    assert_eq!(wants(draws.push_next(&mut density)), Err(LeftAlone::OwnRates));
}

#[test]
fn the_view_is_attached_once_with_texel_size_and_layout() {
    let drawn = [colour(1)];
    let view = vk::ImageView::from_raw(9);
    let mut empty = Rates::default();
    let mut group = vk::DeviceGroupRenderPassBeginInfo::default();
    let plain = vk::RenderingInfo::default()
        .flags(vk::RenderingFlags::SUSPENDING)
        .color_attachments(&drawn)
        .push_next(&mut group);
    let mut group = vk::DeviceGroupRenderPassBeginInfo::default();
    let filled = plain.push_next(&mut empty);
    let filled = vk::RenderingInfo { ..filled }.push_next(&mut group);
    for info in [plain, filled] {
        let mut room = room::<32>();
        let mut copies = Copies::new(&mut room);
        // SAFETY: valid structures that outlive the copies.
        unsafe {
            let more = with_view(&info, view, &capabilities::tests::offered([8, 8]), &mut copies);
            assert_eq!((more.flags, more.color_attachment_count), (vk::RenderingFlags::SUSPENDING, 1));
            let rates = find::<Rates<'_>>(more.p_next).unwrap();
            assert_eq!(rates.image_view, view);
            let layout = vk::ImageLayout::FRAGMENT_SHADING_RATE_ATTACHMENT_OPTIMAL_KHR;
            assert_eq!(rates.image_layout, layout);
            let texel = rates.shading_rate_attachment_texel_size;
            assert_eq!((texel.width, texel.height), (8, 8));
            assert!(find::<Rates<'_>>(rates.p_next).is_none(), "not doubled");
            assert!(find::<vk::DeviceGroupRenderPassBeginInfo<'_>>(more.p_next).is_some());
        }
    }
}
