use super::*;
use openxr_sys::Handle;
use std::ptr;

type Header = xr::CompositionLayerBaseHeader;

fn sub_image(swapchain: u64) -> xr::SwapchainSubImage {
    xr::SwapchainSubImage {
        swapchain: xr::Swapchain::from_raw(swapchain),
        image_rect: xr::Rect2Di {
            offset: xr::Offset2Di { x: 1, y: 2 },
            extent: xr::Extent2Di { width: 3, height: 4 },
        },
        image_array_index: 5,
    }
}

/// A sub-image as numbers.
fn flat(image: &xr::SwapchainSubImage) -> (u64, xr::Rect2Di, u32) {
    (image.swapchain.into_raw(), image.image_rect, image.image_array_index)
}

fn view(
    swapchain: u64,
    depth: Option<&xr::CompositionLayerDepthInfoKHR>,
) -> xr::CompositionLayerProjectionView {
    xr::CompositionLayerProjectionView {
        ty: xr::CompositionLayerProjectionView::TYPE,
        next: depth.map_or(ptr::null(), |depth| ptr::from_ref(depth).cast()),
        pose: xr::Posef { position: xr::Vector3f { x: 0.1, y: 0.2, z: 0.3 }, ..xr::Posef::IDENTITY },
        fov: xr::Fovf { angle_left: -0.4, angle_right: 0.5, angle_up: 0.6, angle_down: -0.7 },
        sub_image: sub_image(swapchain),
    }
}

fn depth(swapchain: u64, near_z: f32, far_z: f32) -> xr::CompositionLayerDepthInfoKHR {
    xr::CompositionLayerDepthInfoKHR {
        ty: xr::CompositionLayerDepthInfoKHR::TYPE,
        next: ptr::null(),
        sub_image: sub_image(swapchain),
        min_depth: 0.0,
        max_depth: 1.0,
        near_z,
        far_z,
    }
}

fn projection(views: &[xr::CompositionLayerProjectionView]) -> xr::CompositionLayerProjection {
    xr::CompositionLayerProjection {
        ty: xr::CompositionLayerProjection::TYPE,
        next: ptr::null(),
        layer_flags: xr::CompositionLayerFlags::EMPTY,
        space: xr::Space::from_raw(9),
        view_count: views.len() as u32,
        views: views.as_ptr(),
    }
}

fn read(layers: &[*const Header]) -> Submission {
    let info = xr::FrameEndInfo {
        ty: xr::FrameEndInfo::TYPE,
        next: ptr::null(),
        display_time: xr::Time::from_nanos(7),
        environment_blend_mode: xr::EnvironmentBlendMode::OPAQUE,
        layer_count: layers.len() as u32,
        layers: layers.as_ptr(),
    };
    // SAFETY: the tests pass null or valid layers.
    unsafe { Submission::read(&info) }
}

/// Chromium submits its OpenGL pictures so.
#[test]
fn flipped_layers_are_upside_down() {
    let mut upside_down = view(1, None);
    (upside_down.fov.angle_up, upside_down.fov.angle_down) = (-0.7, 0.6);
    let views = [view(1, None), upside_down];
    let ups = |flags| {
        let layout = xr::CompositionLayerImageLayoutFB {
            ty: xr::CompositionLayerImageLayoutFB::TYPE,
            next: ptr::null_mut(),
            flags,
        };
        let layer =
            xr::CompositionLayerProjection { next: ptr::from_ref(&layout).cast(), ..projection(&views) };
        let submission = read(&[ptr::from_ref(&layer).cast()]);
        submission.scene().unwrap().views.iter().map(|view| (view.fov.up, view.fov.down)).collect::<Vec<_>>()
    };
    let (upright, flipped) = ((0.6, -0.7), (-0.7, 0.6));
    assert_eq!(ups(FlipFlags::EMPTY), [upright, flipped]);
    assert_eq!(ups(FlipFlags::VERTICAL_FLIP), [flipped, upright]);
}

#[test]
fn views_are_as_submitted() {
    let of_left = depth(3, 0.2, f32::INFINITY);
    let mut views = [view(1, Some(&of_left)), view(2, None)];
    views[1].pose.orientation = xr::Quaternionf { x: 0.0, y: 0.0, z: 0.0, w: 0.0 };
    let layer = projection(&views);
    let submission = read(&[ptr::from_ref(&layer).cast()]);
    assert_eq!(submission.time.as_nanos(), 7);
    let scene = submission.scene().unwrap();
    let [left, right] = scene.views else { panic!("{:?}", scene.views) };
    assert_eq!((scene.space.into_raw(), flat(&left.sub_image)), (9, flat(&sub_image(1))));
    assert_eq!(left.fov, Fov { left: -0.4, right: 0.5, up: 0.6, down: -0.7 });
    assert_eq!((left.orientation, left.position_m), (Some(Quat::IDENTITY), Vec3::new(0.1, 0.2, 0.3)));
    let of_left = left.depth.unwrap();
    assert_eq!((flat(&of_left.sub_image), of_left.range.near_z), (flat(&sub_image(3)), 0.2));
    assert!(right.depth.is_none() && right.view().is_none(), "no depth, and no rotation");
    assert!(submission.shows_any(|swapchain| swapchain.into_raw() == 2));
    assert!(!submission.shows_any(|swapchain| swapchain.into_raw() == 3), "depth is not shown");
}

#[test]
fn layers_that_the_runtime_refuses_or_that_are_unknown_are_left_out() {
    // SAFETY: the structure is plain data, for which all zero is a valid value.
    let mut quad: xr::CompositionLayerQuad = unsafe { std::mem::zeroed() };
    (quad.ty, quad.sub_image) = (xr::CompositionLayerQuad::TYPE, sub_image(4));
    let mut passthrough = quad;
    passthrough.ty = xr::CompositionLayerPassthroughFB::TYPE;
    let views = [view(1, None), view(2, None)];
    let without_views = xr::CompositionLayerProjection { views: ptr::null(), ..projection(&views) };
    let of_many = xr::CompositionLayerProjection { view_count: u32::MAX, ..projection(&views) };
    let (first, second) = (projection(&views), projection(&views[..1]));
    let layers: [*const Header; 7] = [
        ptr::from_ref(&passthrough).cast(),
        ptr::from_ref(&without_views).cast(),
        ptr::null(),
        ptr::from_ref(&first).cast(),
        ptr::from_ref(&of_many).cast(),
        ptr::from_ref(&quad).cast(),
        ptr::from_ref(&second).cast(),
    ];
    let submission = read(&layers);
    let found: Vec<_> = submission.layers().collect();
    let [Layer::Projection(one), Layer::Flat(quad), Layer::Projection(other)] = found[..] else {
        panic!("{found:?}")
    };
    assert_eq!((one.views.len(), flat(&quad), other.views.len()), (2, flat(&sub_image(4)), 1));
    assert_eq!(submission.scene().unwrap().views.len(), 2);
    assert!(submission.only_projection().is_none());
    assert!(read(&layers[..5]).only_projection().is_some());
}

#[test]
fn depth_has_a_nearest_distance_where_all_views_have_depth() {
    let nearest = |depths: [Option<xr::CompositionLayerDepthInfoKHR>; 2]| {
        let views = depths.each_ref().map(|depth| view(1, depth.as_ref()));
        read(&[ptr::from_ref(&projection(&views)).cast()]).nearest_m()
    };
    let far = depth(3, 100.0, 0.5);
    assert_eq!(nearest([Some(far), Some(depth(3, 0.3, f32::INFINITY))]), Some(0.3));
    assert_eq!(nearest([Some(far), None]), None);
    assert_eq!(nearest([Some(far), Some(depth(3, 0.0, 10.0))]), None, "no distance");
    let views = [view(1, Some(&far))];
    let layer = projection(&views);
    let alone = [ptr::from_ref(&layer).cast()];
    assert_eq!(read(&alone).nearest_m(), Some(0.5));
    assert_eq!(read(&[alone[0], ptr::null()]).nearest_m(), None, "another layer may be nearer");
    assert_eq!(read(&[]).nearest_m(), None);
}
