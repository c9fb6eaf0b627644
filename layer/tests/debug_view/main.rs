//! The pass `debug_view` on a Vulkan device, under the validation layers where they are installed, compared with its CPU
//! reference. Without a Vulkan device the tests are skipped.

#![allow(clippy::unwrap_used, reason = "a failed step is a failed test")]

#[path = "../compose/allocations.rs"]
mod allocations;
#[path = "../compose/pictures.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod pictures;
#[path = "../compose/swapchain.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod swapchain;
#[path = "../compose/transfer.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod transfer;
#[path = "../compose/vulkan.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod vulkan;

use ash::vk;
use glam::Vec3;
use parafovea::gpu::GpuError;
use parafovea::kernels::compose::Compose;
use parafovea::kernels::debug_view::{DebugView, DebugViewJob, DebugViewParams, DebugViewPass, MapShape};
use parafovea_core::kernels::debug_view::{debug_view_image, map_row_bytes};
use pictures::{FOV, picture, pixel_format};
use swapchain::{Swapchain, shape};
use vulkan::Vulkan;

const MAP: MapShape = MapShape { extent: [150, 100], texel: [16, 16], tiles: [10, 7] };

/// Every rate, every age up to the oldest that differs, and more.
fn map() -> Vec<u8> {
    (0..map_row_bytes(MAP.tiles[0]) * MAP.tiles[1]).map(|index| (index * 7 % 13) as u8).collect()
}

fn params(view: DebugView, offset: [u32; 2], extent: [u32; 2]) -> DebugViewParams {
    DebugViewParams::new(view, offset, extent, FOV, Vec3::new(0.2, -0.1, -1.0), &MAP)
}

fn job<'a>(swapchain: &'a Swapchain, layer: u32, params: DebugViewParams, map: &'a [u8]) -> DebugViewJob<'a> {
    DebugViewJob {
        eye: layer as usize,
        runtime: &swapchain.runtime,
        runtime_index: 1,
        array_layer: layer,
        layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        params,
        map: Some(map),
    }
}

/// Whether the colour changes at an angle within the rounding error of this pixel's angle.
fn is_on_edge(params: &DebugViewParams, x: u32, y: u32) -> bool {
    const ROUNDING_DEG: f32 = 0.02;
    let Some(angle) = params.degrees(x, y) else { return false };
    let ring = (angle / 10.0).round() * 10.0;
    let edges = [1.0, 1.3, ring - 0.2, ring + 0.2];
    edges.into_iter().any(|edge| (angle - edge).abs() < ROUNDING_DEG)
}

#[test]
fn matches_the_reference() {
    let vulkan = Vulkan::new();
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let mut pass = DebugViewPass::new(vulkan.gpu.clone()).unwrap();
    let (width, height) = (150, 100);
    let map = map();
    for format in [vk::Format::R8G8B8A8_SRGB, vk::Format::B8G8R8A8_UNORM] {
        let swapchain = Swapchain::new(&vulkan, &shape(format, width, height, 2));
        let layers = [picture(width, height, 1), picture(width, height, 2)];
        for view in DebugView::ALL {
            swapchain.render(&vulkan, 0, &layers);
            compose.submit(&[swapchain.job(0, &[])]).unwrap();
            // Two eyes beside each other in one layer.
            let eyes = [params(view, [0, 0], [75, 100]), params(view, [75, 10], [75, 90])];
            let jobs = [0, 1].map(|eye| DebugViewJob { eye, ..job(&swapchain, 1, eyes[eye], &map) });
            pass.submit(&jobs).unwrap();
            let result = swapchain.shown(&vulkan, 1, 2, 4);
            assert_eq!(result[0], layers[0], "the layer that is not drawn over");
            let mut expected = layers[1].clone();
            for eye in &eyes {
                debug_view_image(&mut expected, width, pixel_format(format), eye, &map);
            }
            let mut changed = 0;
            let texels = expected.chunks(4).zip(result[1].chunks(4)).zip(layers[1].chunks(4)).enumerate();
            for (index, ((expected, result), before)) in texels {
                let (x, y) = (index as u32 % width, index as u32 / width);
                let eye = &eyes[usize::from(x >= 75)];
                let is_inside = y >= eye.rect_offset[1];
                let is_angle = !view.shows_tiles();
                let at = [x - eye.rect_offset[0], y.saturating_sub(eye.rect_offset[1])];
                assert_eq!(before[3], result[3], "alpha at {x}, {y}");
                if is_inside && is_angle && is_on_edge(eye, at[0], at[1]) {
                    continue;
                }
                let is_drawn = is_inside && eye.pixel(at[0], at[1], &map).is_some();
                if !is_drawn {
                    assert_eq!(result, before, "{view:?} at {x}, {y}");
                }
                changed += u32::from(result != before);
                let most = expected.iter().zip(result).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
                assert!(most <= 1, "{view:?} of {format:?} at {x}, {y}: {result:?}, not {expected:?}");
            }
            assert!(changed > 1, "{view:?} changes {changed} texels");
        }
    }
    vulkan.assert_valid();
}

/// Larger maps take the place of smaller ones while those are in use.
#[test]
fn maps_may_grow() {
    let vulkan = Vulkan::new();
    let mut pass = DebugViewPass::new(vulkan.gpu.clone()).unwrap();
    let swapchain = Swapchain::new(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 64, 48, 1));
    let plain = [127u8; 64 * 48 * 4].to_vec();
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    for side in [8, 200, 400] {
        swapchain.render(&vulkan, 0, std::slice::from_ref(&plain));
        compose.submit(&[swapchain.job(0, &[])]).unwrap();
        let shape = MapShape { extent: [side; 2], texel: [1; 2], tiles: [side; 2] };
        let map = vec![10; shape.bytes() as usize];
        let params = DebugViewParams::new(DebugView::Rates, [0, 0], [64, 48], FOV, Vec3::NEG_Z, &shape);
        pass.submit(&[job(&swapchain, 0, params, &map)]).unwrap();
        let result = swapchain.shown(&vulkan, 1, 1, 4);
        assert!(result[0].chunks(4).all(|texel| texel == &result[0][..4] && texel[..3] != plain[..3]));
    }
    vulkan.assert_valid();
}

#[test]
fn steady_frames_do_not_allocate() {
    let vulkan = Vulkan::new();
    let mut pass = DebugViewPass::new(vulkan.gpu.clone()).unwrap();
    let swapchain = Swapchain::new(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 64, 64, 1));
    let (params, map) = (params(DebugView::Rates, [0, 0], [64, 64]), map());
    pass.submit(&[job(&swapchain, 0, params, &map)]).unwrap();
    let allocations = allocations::count(|| {
        for _ in 0..10 {
            pass.submit(&[job(&swapchain, 0, params, &map)]).unwrap();
        }
    });
    assert_eq!(allocations, 0);
    vulkan.assert_valid();
}

/// A copy stays until a map is written in its place, or one of another size is asked for.
#[test]
fn a_copy_is_there_until_it_is_written_over() {
    let vulkan = Vulkan::new();
    let mut pass = DebugViewPass::new(vulkan.gpu.clone()).unwrap();
    let swapchain = Swapchain::new(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 64, 64, 2));
    let (params, map) = (params(DebugView::Rates, [0, 0], [64, 64]), map());
    let of_plan = |layer| job(&swapchain, layer, params, &map);
    pass.place(0, map.len() as u32).unwrap();
    [0, 1].into_iter().for_each(|eye| pass.copied(eye, MAP.tiles));
    pass.submit(&[DebugViewJob { map: None, ..of_plan(0) }, of_plan(1)]).unwrap();
    assert!(pass.has_copy(0, MAP.tiles) && !pass.has_copy(1, MAP.tiles));
    assert!(!pass.has_copy(0, [MAP.tiles[0], MAP.tiles[1] - 1]));
    pass.place(0, 2 * map.len() as u32).unwrap();
    assert!(!pass.has_copy(0, MAP.tiles), "a larger buffer has nothing in it");
}

/// The other half's copy into a map may still be in progress when the pass fails, and is dropped.
#[test]
fn a_submit_that_fails_leaves_what_a_copy_writes() {
    let vulkan = Vulkan::new();
    let mut pass = DebugViewPass::new(vulkan.gpu.clone()).unwrap();
    let swapchain = Swapchain::new(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 64, 64, 1));
    let map = map();
    let from = vulkan.staging(&map);
    let (buffer, dst_offset) = pass.place(0, map.len() as u32).unwrap();
    let region = vk::BufferCopy { src_offset: 0, dst_offset, size: map.len() as u64 };
    // SAFETY: plain use of Vulkan with live handles.
    vulkan.run(|commands| unsafe { vulkan.device.cmd_copy_buffer(commands, from, buffer, &[region]) });
    pass.copied(0, MAP.tiles);
    let beyond = params(DebugView::Rates, [1, 0], [64, 64]);
    let failed = DebugViewJob { map: None, ..job(&swapchain, 0, beyond, &map) };
    assert!(pass.submit(&[failed]).is_err());
    // Validation reports a buffer that is destroyed while a copy writes to it.
    drop(pass);
    vulkan.idle();
    vulkan.assert_valid();
}

#[test]
fn senseless_jobs_are_refused() {
    let vulkan = Vulkan::new();
    let mut pass = DebugViewPass::new(vulkan.gpu.clone()).unwrap();
    let swapchain = Swapchain::new(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 64, 64, 1));
    let map = map();
    let good = job(&swapchain, 0, params(DebugView::Gaze, [0, 0], [64, 64]), &map);
    let beyond = DebugViewJob { params: params(DebugView::Gaze, [1, 0], [64, 64]), ..good };
    let rates = params(DebugView::Rates, [0, 0], [64, 64]);
    let uncounted = DebugViewParams { map_extent: [u32::MAX; 2], ..good.params };
    for (what, job) in [
        ("a rectangle beyond the image", beyond),
        ("a map that is too short", DebugViewJob { params: rates, map: Some(&map[4..]), ..good }),
        ("a map without measure", DebugViewJob { params: uncounted, ..good }),
        ("a layer out of range", DebugViewJob { array_layer: 1, ..good }),
        ("an image out of range", DebugViewJob { runtime_index: 2, ..good }),
        ("an eye that nobody has", DebugViewJob { eye: 2, ..good }),
    ] {
        let result = pass.submit(&[job]);
        assert!(matches!(result, Err(GpuError::Invalid(_))), "{what}: {result:?}");
    }
    assert!(matches!(pass.submit(&[good, good]), Err(GpuError::Invalid(_))), "two images for one eye");
    pass.submit(&[good]).unwrap();
    vulkan.assert_valid();
}
