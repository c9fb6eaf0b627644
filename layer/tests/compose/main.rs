//! The pass `compose` on a Vulkan device, under the validation layers where they are installed, compared with
//! its CPU reference. Without a Vulkan device the tests are skipped.

#![allow(clippy::unwrap_used, reason = "a failed step is a failed test")]

mod allocations;
mod change;
mod failures;
mod free;
mod layouts;
mod left;
mod missing_barriers;
mod moved;
mod pictures;
mod repeated;
mod reuse;
mod sharing;
mod swapchain;
#[allow(dead_code, reason = "shared with the tests of mask")]
mod transfer;
#[allow(dead_code, reason = "shared with the tests of fill")]
mod vulkan;

use ash::vk;
use glam::{UVec2, Vec2, Vec3};
use parafovea::gpu::GpuError;
use parafovea::kernels::compose::{Compose, ComposeRegion, MAX_REGIONS, Parameters};
use parafovea_core::chroma::{ChromaSettings, Focus, Mode};
use parafovea_core::geometry::{ImagePlane, eccentricity};
use parafovea_trial::{Lack, skip};
use pictures::{assert_matches, luminance_change, picture, reference, region};
use swapchain::{Swapchain, shape};
use vulkan::Vulkan;

const FORMATS: [vk::Format; 4] = [
    vk::Format::R8G8B8A8_SRGB,
    vk::Format::B8G8R8A8_SRGB,
    vk::Format::R8G8B8A8_UNORM,
    vk::Format::B8G8R8A8_UNORM,
];

/// Whether a texel of a layer is one that no region may change: outside of all, or well inside the plateau.
fn is_untouched(index: usize, width: u32, layer: u32, regions: &[ComposeRegion]) -> bool {
    let texel = UVec2::new(index as u32 % width, index as u32 / width);
    let changes = |region: &ComposeRegion| {
        let params = &region.params;
        let offset = UVec2::from(params.rect_offset);
        let inside = texel.cmpge(offset).all()
            && texel.cmplt(offset + UVec2::from(params.rect_extent)).all()
            && region.array_layer == layer;
        let plane =
            ImagePlane { origin: Vec2::from(params.plane_origin), step: Vec2::from(params.plane_step) };
        let point = plane.direction((texel.as_vec2() - offset.as_vec2()) + 0.5);
        // 1e-5: where exactly the edge of the plateau lies is up to the rounding of the device.
        inside && eccentricity(point, params.gaze.into()) - params.radius > params.plateau - 1e-5
    };
    !regions.iter().any(changes)
}

#[test]
fn matches_the_reference() {
    let vulkan = Vulkan::new();
    for parameters in [Parameters::OfVertices, Parameters::OfPixels] {
        assert_matches_the_reference(&vulkan, parameters);
    }
    vulkan.assert_valid();
}

fn assert_matches_the_reference(vulkan: &Vulkan, parameters: Parameters) {
    let mut compose = Compose::with_parameters(vulkan.gpu.clone(), parameters).unwrap();
    let paper = ChromaSettings { mode: Mode::Paper, ..ChromaSettings::default() };
    for format in FORMATS {
        assert!(compose.supports(format), "{format:?}");
        for (width, height) in [(37, 53), (256, 192), (1, 1)] {
            let swapchain = Swapchain::new(vulkan, &shape(format, width, height, 2));
            for (frame, settings) in [ChromaSettings::default(), paper].iter().enumerate() {
                let layers = [picture(width, height, 1), picture(width, height, 2)];
                let gaze = Vec3::new(0.2, -0.1, -1.0);
                let half = width / 2;
                let regions = [
                    region(1, [0, 0, half, height], gaze, format, settings),
                    region(1, [half, 0, width - half, height], Vec3::NEG_Z, format, settings),
                ];
                let index = frame as u32 % 2;
                let result = swapchain.frame(vulkan, &mut compose, index, &layers, &regions).unwrap();
                assert_eq!(result[0], layers[0], "the layer without a region");
                let reference = |before: &[u8]| reference(before, width, format, 1, &regions);
                assert_matches(vulkan, &layers[1], reference, &result[1], |index| {
                    is_untouched(index, width, 1, &regions)
                });
                if width > 1 {
                    assert_ne!(result[1], layers[1], "nothing was done");
                }
            }
        }
    }
}

/// A focus that is wide, far aside or nearly all around, and attenuation in part.
#[test]
fn a_focus_matches_the_reference() {
    let vulkan = Vulkan::new();
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let (width, height, format) = (256, 192, vk::Format::R8G8B8A8_SRGB);
    let swapchain = Swapchain::new(&vulkan, &shape(format, width, height, 1));
    let layers = [picture(width, height, 5)];
    let straight = Focus::at(Vec3::NEG_Z);
    let mut pictures = Vec::new();
    for focus in [
        straight,
        Focus { radius: 0.3, ..straight },
        Focus { strength: 0.4, ..straight },
        Focus { direction: Vec3::new(0.9, 0.1, -1.0), radius: 0.2, strength: 0.7 },
        // All but a hole in the middle of the image.
        Focus { direction: Vec3::Z, radius: 2.8, strength: 1.0 },
    ] {
        let mut whole = [region(0, [0, 0, width, height], Vec3::NEG_Z, format, &ChromaSettings::default())];
        whole[0].params = whole[0].params.following(focus);
        let result = swapchain.frame(&vulkan, &mut compose, 0, &layers, &whole).unwrap();
        let reference = |before: &[u8]| reference(before, width, format, 0, &whole);
        let is_untouched = |index| is_untouched(index, width, 0, &whole);
        assert_matches(&vulkan, &layers[0], reference, &result[0], is_untouched);
        assert_ne!(result[0], layers[0], "nothing was done with {focus:?}");
        pictures.push(result);
    }
    pictures.dedup();
    assert_eq!(pictures.len(), 5, "each focus makes a picture of its own");
    vulkan.assert_valid();
}

#[test]
fn luminance_is_kept_to_one_code_value() {
    let vulkan = Vulkan::new();
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let (width, height) = (256, 192);
    for format in FORMATS {
        let swapchain = Swapchain::new(&vulkan, &shape(format, width, height, 1));
        let layers = [picture(width, height, 3)];
        let whole = [region(0, [0, 0, width, height], Vec3::NEG_Z, format, &ChromaSettings::default())];
        let result = swapchain.frame(&vulkan, &mut compose, 0, &layers, &whole).unwrap();
        let change = luminance_change(&layers[0], &result[0], format);
        assert!(change <= 1.0, "{change} code values of {format:?}");
    }
    vulkan.assert_valid();
}

/// Gains of 1, drawn on every pixel, and regions without work: neither may change a bit.
#[test]
fn full_gain_and_no_work_change_nothing() {
    let vulkan = Vulkan::new();
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let (width, height) = (64, 48);
    for format in FORMATS {
        let swapchain = Swapchain::new(&vulkan, &shape(format, width, height, 1));
        let layers = [picture(width, height, 4)];
        let paper = ChromaSettings { mode: Mode::Paper, ..ChromaSettings::default() };
        let mut full_gain = region(0, [0, 0, width, height], Vec3::NEG_Z, format, &paper);
        full_gain.params.range_scale = 0.0;
        let no_gaze = region(0, [0, 0, width, height], Vec3::ZERO, format, &paper);
        for (what, regions) in
            [("full gain", &[full_gain][..]), ("no gaze", &[no_gaze][..]), ("no region", &[][..])]
        {
            let result = swapchain.frame(&vulkan, &mut compose, 0, &layers, regions).unwrap();
            assert_eq!(result, layers, "{what}, {format:?}");
        }
    }
    vulkan.assert_valid();
}

/// Formats without an 8-bit reference: the picture changes, alpha and the plateau do not.
#[test]
fn deep_formats_keep_alpha_and_plateau() {
    let vulkan = Vulkan::new();
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let (width, height) = (64, 48);
    // Texels of the same saturated orange, alpha 1/3 and 0.5.
    let cases: [(vk::Format, Vec<u8>, &[usize]); 2] = [
        (vk::Format::A2B10G10R10_UNORM_PACK32, (1u32 << 30 | 200 << 10 | 1000).to_le_bytes().to_vec(), &[]),
        (
            vk::Format::R16G16B16A16_SFLOAT,
            [0x3c00u16, 0x3400, 0, 0x3800].iter().flat_map(|half| half.to_le_bytes()).collect(),
            &[6, 7],
        ),
    ];
    for (format, texel, alpha_bytes) in cases {
        if !compose.supports(format) {
            println!("skipped: the device cannot draw to {format:?}");
            continue;
        }
        let swapchain = Swapchain::new(&vulkan, &shape(format, width, height, 1));
        let layers = [texel.repeat((width * height) as usize)];
        let regions = [region(0, [0, 0, width, height], Vec3::NEG_Z, format, &ChromaSettings::default())];
        let result = swapchain.frame(&vulkan, &mut compose, 0, &layers, &regions).unwrap();
        let mut changed = 0;
        for (index, after) in result[0].chunks(texel.len()).enumerate() {
            if is_untouched(index, width, 0, &regions) {
                assert_eq!(after, texel, "texel {index} of {format:?}");
            }
            if format == vk::Format::A2B10G10R10_UNORM_PACK32 {
                assert_eq!(after[3] >> 6, texel[3] >> 6, "alpha of texel {index}");
            }
            assert!(alpha_bytes.iter().all(|&byte| after[byte] == texel[byte]), "alpha of texel {index}");
            changed += usize::from(after != texel);
        }
        assert!(changed > 2000, "{changed} texels of {format:?} changed");
    }
    vulkan.assert_valid();
}

/// Only half floats can encode it.
#[test]
fn a_pixel_that_is_no_number_stays_as_it_is() {
    let vulkan = Vulkan::new();
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let (width, height, format) = (64, 48, vk::Format::R16G16B16A16_SFLOAT);
    if !compose.supports(format) {
        skip(&Lack::machine(format_args!("a device that draws to {format:?}")));
    }
    let swapchain = Swapchain::new(&vulkan, &shape(format, width, height, 1));
    // In turn: infinite green, a NaN as blue, and an orange as both should leave it alone.
    const TEXELS: [[u16; 4]; 3] =
        [[0x3c00, 0x7c00, 0, 0x3c00], [0x3c00, 0x3400, 0x7e00, 0x3c00], [0x3c00, 0x3400, 0, 0x3c00]];
    let texel = |index: u32| TEXELS[index as usize % 3].into_iter().flat_map(u16::to_le_bytes);
    let layers = [(0..width * height).flat_map(texel).collect::<Vec<u8>>()];
    let regions = [region(0, [0, 0, width, height], Vec3::NEG_Z, format, &ChromaSettings::default())];
    let result = swapchain.frame(&vulkan, &mut compose, 0, &layers, &regions).unwrap();
    let half = |bytes: &[u8]| u16::from_le_bytes([bytes[0], bytes[1]]);
    let mut oranges = std::collections::BTreeSet::new();
    for (index, after) in result[0].chunks(8).enumerate() {
        let after: Vec<u16> = after.chunks(2).map(half).collect();
        match index % 3 {
            0 => assert_eq!(after, TEXELS[0], "texel {index}"),
            1 => assert!(
                after[2] & 0x7fff > 0x7c00 && after[..2] == TEXELS[1][..2],
                "texel {index}: {after:x?}"
            ),
            _ => {
                assert!(after.iter().all(|half| half & 0x7c00 != 0x7c00), "texel {index}: {after:x?}");
                oranges.insert(after);
            }
        }
    }
    assert!(oranges.len() > 10, "{} different oranges", oranges.len());
    vulkan.assert_valid();
}

/// More frames than command buffers, both images in turn, nothing waited for in between, nothing allocated.
#[test]
fn steady_frames_do_not_allocate() {
    let vulkan = Vulkan::new();
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let format = vk::Format::R8G8B8A8_SRGB;
    let (left, right) = (
        Swapchain::new(&vulkan, &shape(format, 64, 64, 1)),
        Swapchain::new(&vulkan, &shape(format, 64, 64, 1)),
    );
    let regions = [region(0, [0, 0, 64, 64], Vec3::NEG_Z, format, &ChromaSettings::default())];
    let mut submit = |frame: u32| {
        compose.submit(&[left.job(frame % 2, &regions), right.job(frame % 2, &regions)]).unwrap();
    };
    // Until each pair of images was in each slot.
    (0..6).for_each(&mut submit);
    let allocations = allocations::count(|| (6..18).for_each(submit));
    assert_eq!(allocations, 0);
    vulkan.assert_valid();
}

#[test]
fn senseless_jobs_are_refused() {
    let vulkan = Vulkan::new();
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let format = vk::Format::R8G8B8A8_SRGB;
    let swapchain = Swapchain::new(&vulkan, &shape(format, 64, 64, 1));
    let smaller = Swapchain::new(&vulkan, &shape(format, 32, 64, 1));
    let settings = ChromaSettings::default();
    let good = region(0, [0, 0, 64, 64], Vec3::NEG_Z, format, &settings);
    let mut other_image = swapchain.job(0, &[]);
    other_image.app_index = 2;
    let mut other_shape = swapchain.job(0, &[]);
    other_shape.runtime = &smaller.runtime;
    let beyond = [region(1, [0, 0, 64, 64], Vec3::NEG_Z, format, &settings)];
    let too_many = [good; MAX_REGIONS + 1];
    for (what, jobs) in [
        ("an index out of range", &[other_image][..]),
        ("two shapes", &[other_shape][..]),
        ("a layer out of range", &[swapchain.job(0, &beyond)][..]),
        ("an image twice", &[swapchain.job(0, &[]), swapchain.job(0, &[])][..]),
        ("too many regions", &[swapchain.job(0, &too_many)][..]),
    ] {
        let result = compose.submit(jobs);
        assert!(matches!(result, Err(GpuError::Invalid(_))), "{what}: {result:?}");
    }
    compose.submit(&[swapchain.job(0, &[good])]).unwrap();
    vulkan.assert_valid();
}

#[test]
fn unsupported_images_are_refused_without_a_call() {
    let vulkan = Vulkan::new();
    let compose = Compose::new(vulkan.gpu.clone()).unwrap();
    assert!(!compose.supports(vk::Format::D32_SFLOAT));
    assert!(!compose.supports(vk::Format::R8G8B8A8_UINT));
    for (width, height, layers) in [(0, 8, 1), (8, 8, 0), (u32::MAX, 8, 1), (8, 8, u32::MAX)] {
        let shape = shape(vk::Format::R8G8B8A8_SRGB, width, height, layers);
        let result = parafovea::kernels::compose::AppImages::new(&vulkan.gpu, &shape, 2);
        assert!(matches!(result, Err(GpuError::Unsupported(_))), "{width}x{height}, {layers} layers");
    }
    vulkan.assert_valid();
}
