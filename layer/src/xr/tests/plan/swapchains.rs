//! Messages to the Vulkan half about swapchains and submissions.

use super::*;

#[test]
fn images_are_told_once_and_their_end_before_it_comes() {
    let application = Application::new();
    crossings();
    let swapchain = application.swapchain;
    let mut count = 0;
    // SAFETY: valid arguments, to count.
    unsafe { swapchain::enumerate_images(swapchain, 0, &mut count, ptr::null_mut()) };
    assert_eq!(crossings(), [], "only counted");
    // As xrgears leaves it: neither the type nor the next structure is one.
    let next = ptr::without_provenance_mut(usize::MAX);
    let mut images = [xr::SwapchainImageVulkanKHR { ty: xr::StructureType::UNKNOWN, next, image: 0 }; 3];
    for expected in [true, false] {
        // SAFETY: valid arguments: as many structures as the capacity states.
        unsafe { swapchain::enumerate_images(swapchain, 3, &mut count, images.as_mut_ptr().cast()) };
        let received = crossings();
        assert_eq!(!received.is_empty(), expected, "{received:?}");
        let record = Crossing::Swapchain {
            swapchain: swapchain.into_raw(),
            images: IMAGES.to_vec(),
            extent: [SIDE as u32 * 2, SIDE as u32],
            usage: vk::ImageUsageFlags::COLOR_ATTACHMENT,
        };
        assert!(received.iter().all(|received| *received == record), "{received:?}");
    }
    // SAFETY: a live swapchain, not used after this.
    assert_eq!(unsafe { swapchain::destroy(swapchain) }, xr::Result::SUCCESS);
    let received = crossings();
    let [Crossing::Swapchain { images, .. }] = &received[..] else { panic!("{received:?}") };
    assert!(images.is_empty());
}

#[test]
fn submissions_name_the_image_released_last() {
    let application = Application::new();
    let ui = create_swapchain(application.session, xr::SwapchainUsageFlags::COLOR_ATTACHMENT, 64);
    let depth_usage = xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT;
    let depth = create_swapchain(application.session, depth_usage, SIDE as u32);
    let mut depth_info = xr::CompositionLayerDepthInfoKHR {
        ty: xr::CompositionLayerDepthInfoKHR::TYPE,
        next: ptr::null(),
        sub_image: application.view(0).sub_image,
        min_depth: 0.0,
        max_depth: 1.0,
        near_z: 0.1,
        far_z: 100.0,
    };
    depth_info.sub_image.swapchain = depth;
    let mut views: Vec<_> = (0..4).map(|index| application.view(index % 2)).collect();
    views[1].next = ptr::from_ref(&depth_info).cast();
    views[1].fov = xr::Fovf { angle_up: -EDGE, angle_down: EDGE, ..fov() };
    let shown = || {
        crossings().into_iter().find_map(|received| match received {
            Crossing::Shown { views, flat, depth } => Some((views, flat, depth)),
            _ => None,
        })
    };
    application.begin();
    application.end(&views, Some(ui));
    let (told_views, flat, depths) = shown().unwrap();
    assert_eq!((flat, depths), (vec![ui.into_raw()], vec![depth.into_raw()]));
    let side = SIDE as u32;
    let expected = |eye, x, is_upside_down| ShownViewRecord {
        eye,
        swapchain: application.swapchain.into_raw(),
        image_index: NO_IMAGE,
        layer: 0,
        rect: [x, 0, side, side],
        is_upside_down,
    };
    let eyes = [expected(0, 0, 0), expected(1, side, 1), expected(NO_EYE, 0, 0), expected(NO_EYE, side, 0)];
    assert_eq!(told_views, eyes);

    let swapchain = application.swapchain;
    let mut index = 0;
    // SAFETY: valid arguments.
    unsafe {
        for _ in 0..2 {
            swapchain::acquire_image(swapchain, ptr::null(), &mut index);
        }
        swapchain::release_image(swapchain, ptr::null());
    }
    application.begin();
    application.end(&views[..2], None);
    assert_eq!(shown().unwrap().0[0].image_index, 0, "acquired first, released first");
    // SAFETY: valid arguments.
    unsafe { swapchain::release_image(swapchain, ptr::null()) };
    application.begin();
    application.end(&views[..2], None);
    assert_eq!(shown().unwrap().0[0].image_index, 1);
}

#[test]
fn a_session_that_ends_takes_its_images_along() {
    let application = Application::new();
    // SAFETY: valid arguments; the structures are plain data, for which all zero is a valid value.
    unsafe {
        let mut count = 0;
        let mut images: [xr::SwapchainImageVulkanKHR; 3] = std::mem::zeroed();
        images.iter_mut().for_each(|image| image.ty = xr::SwapchainImageVulkanKHR::TYPE);
        swapchain::enumerate_images(application.swapchain, 3, &mut count, images.as_mut_ptr().cast());
        crossings();
        assert_eq!(session::destroy(application.session), xr::Result::SUCCESS);
    }
    let received = crossings();
    assert!(
        matches!(&received[..], [Crossing::Swapchain { images, .. }, Crossing::Active(false)] if images.is_empty())
    );
}
