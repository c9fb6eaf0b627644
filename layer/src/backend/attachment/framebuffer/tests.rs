use super::*;
use crate::abi::copies::room;
use ash::vk::Handle;

fn view(number: u64) -> vk::ImageView {
    vk::ImageView::from_raw(number)
}

#[test]
fn a_framebuffer_has_one_view_more() {
    let views = [view(1), view(2)];
    let info = vk::FramebufferCreateInfo::default().attachments(&views).width(640).height(480).layers(1);
    let mut room = room::<8>();
    let mut copies = Copies::new(&mut room);
    // SAFETY: valid structures that outlive the copies.
    unsafe {
        let more = with_view(&info, view(9), &mut copies);
        assert_eq!(slice(more.p_attachments, more.attachment_count), [view(1), view(2), view(9)]);
        assert_eq!((more.width, more.height, more.layers, more.flags), (640, 480, 1, info.flags));
    }
}

#[test]
fn an_imageless_framebuffer_promises_one_image_more() {
    let formats = [vk::Format::R8G8B8A8_SRGB];
    let images = [vk::FramebufferAttachmentImageInfo::default().width(640).view_formats(&formats)];
    let mut attachments = vk::FramebufferAttachmentsCreateInfo::default().attachment_image_infos(&images);
    let info = vk::FramebufferCreateInfo::default()
        .flags(vk::FramebufferCreateFlags::IMAGELESS)
        .attachment_count(1)
        .push_next(&mut attachments);
    assert!(is_imageless(&info));
    let usage = vk::ImageUsageFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR | vk::ImageUsageFlags::TRANSFER_DST;
    let promise = ImagelessRateAttachment { texels: [40, 30], layers: 2, usage };
    let mut room = room::<8>();
    let mut copies = Copies::new(&mut room);
    // SAFETY: valid structures that outlive the copies.
    unsafe {
        let more = with_promise(&info, &promise, &mut copies);
        assert_eq!(more.attachment_count, 2);
        let attachments = find::<vk::FramebufferAttachmentsCreateInfo<'_>>(more.p_next).unwrap();
        let images = slice(attachments.p_attachment_image_infos, attachments.attachment_image_info_count);
        assert_eq!(images.len(), 2);
        assert_eq!(images[0].width, 640);
        let own = &images[1];
        assert_eq!((own.width, own.height, own.layer_count, own.usage), (40, 30, 2, usage));
        assert_eq!(slice(own.p_view_formats, own.view_format_count), [vk::Format::R8_UINT]);
    }
}

#[test]
fn a_render_pass_begins_with_one_view_more() {
    let views = [view(1)];
    let mut begin = vk::RenderPassAttachmentBeginInfo::default().attachments(&views);
    let mut group = vk::DeviceGroupRenderPassBeginInfo::default().device_mask(1);
    let info = vk::RenderPassBeginInfo::default().push_next(&mut begin).push_next(&mut group);
    let mut room = room::<32>();
    let mut copies = Copies::new(&mut room);
    // SAFETY: valid structures that outlive the copies.
    unsafe {
        let more = begin_with_view(&info, view(9), &mut copies);
        let begin = find::<vk::RenderPassAttachmentBeginInfo<'_>>(more.p_next).unwrap();
        assert_eq!(slice(begin.p_attachments, begin.attachment_count), [view(1), view(9)]);
        let group = find::<vk::DeviceGroupRenderPassBeginInfo<'_>>(more.p_next).unwrap();
        assert_eq!(group.device_mask, 1);
    }
}
