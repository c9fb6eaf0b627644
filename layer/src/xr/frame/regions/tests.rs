use super::*;
use crate::inputs::gaze::FORWARD;
use glam::{Quat, Vec3};
use openxr_sys::Handle;
use parafovea_core::geometry::Fov;

const IMAGES: Images =
    Images { extent: vk::Extent2D { width: 200, height: 100 }, array_layers: 2, is_unit_range: true };

fn image(x: i32, y: i32, width: i32, height: i32, array_layer: u32) -> xr::SwapchainSubImage {
    xr::SwapchainSubImage {
        swapchain: xr::Swapchain::from_raw(1),
        image_rect: xr::Rect2Di { offset: xr::Offset2Di { x, y }, extent: xr::Extent2Di { width, height } },
        image_array_index: array_layer,
    }
}

fn view(sub_image: xr::SwapchainSubImage) -> ProjectionView {
    ProjectionView {
        orientation: Some(Quat::IDENTITY),
        position_m: Vec3::ZERO,
        fov: Fov { left: -0.7, right: 0.7, up: 0.7, down: -0.7 },
        sub_image,
        depth: None,
    }
}

fn region_of(sub_image: xr::SwapchainSubImage) -> Option<ComposeRegion> {
    region(&view(sub_image), &IMAGES, Focus::at(FORWARD), &ChromaSettings::default())
}

#[test]
fn only_what_lies_within_the_image_is_processed() {
    assert!(region_of(image(100, 0, 100, 100, 1)).is_some());
    assert!(region_of(image(101, 0, 100, 100, 1)).is_none(), "beyond the right edge");
    assert!(region_of(image(-1, 0, 100, 100, 0)).is_none());
    assert!(region_of(image(0, 0, 0, 100, 0)).is_none(), "empty");
    assert!(region_of(image(0, 0, -5, 100, 0)).is_none());
    assert!(region_of(image(i32::MAX, 0, i32::MAX, 100, 0)).is_none());
    assert!(region_of(image(0, 0, 100, 100, 2)).is_none(), "no such layer");
}

#[test]
fn the_gaze_is_seen_from_the_view() {
    let mut turned = view(image(0, 0, 100, 100, 0));
    turned.orientation = Some(Quat::from_rotation_y(0.3));
    let region = region(&turned, &IMAGES, Focus::at(FORWARD), &ChromaSettings::default()).unwrap();
    assert!(region.params.gaze[0] > 0.29, "a view turned left has straight ahead to its right");
}

#[test]
fn the_eyes_of_a_double_wide_image_do_not_contest_each_other() {
    let mut regions = vec![region_of(image(0, 0, 100, 100, 0)).unwrap()];
    regions.push(region_of(image(100, 0, 100, 100, 0)).unwrap());
    regions.push(region_of(image(0, 0, 100, 100, 1)).unwrap());
    drop_contested(&mut regions, [].iter());
    assert_eq!(regions.len(), 3);
}

#[test]
fn a_rectangle_that_a_quad_shows_too_stays_as_it_is() {
    let mut regions =
        vec![region_of(image(0, 0, 100, 100, 0)).unwrap(), region_of(image(100, 0, 100, 100, 0)).unwrap()];
    drop_contested(&mut regions, [image(99, 99, 1, 1, 0), image(0, 0, 200, 100, 1)].iter());
    assert_eq!(regions.len(), 1);
    assert_eq!(regions[0].rect.offset.x, 100);
}

#[test]
fn equal_views_are_one_region_and_differing_ones_none() {
    let sub_image = image(0, 0, 100, 100, 0);
    let mut equal = vec![region_of(sub_image).unwrap(); 2];
    drop_contested(&mut equal, [].iter());
    assert_eq!(equal.len(), 1);
    let other_gaze = Focus::at(Vec3::new(0.5, 0.0, -1.0).normalize());
    let differing = region(&view(sub_image), &IMAGES, other_gaze, &ChromaSettings::default()).unwrap();
    let mut regions = vec![region_of(sub_image).unwrap(), differing];
    drop_contested(&mut regions, [].iter());
    assert!(regions.is_empty());
}
