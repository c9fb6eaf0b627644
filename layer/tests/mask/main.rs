//! A pass of an application with a mask, end to end on a Vulkan device: template, load, fill. Shaded pixels are bit-identical to the pass
//! without a mask; skipped pixels are as predicted, and are not shaded. Without a Vulkan device the tests are skipped.

#![allow(clippy::unwrap_used, reason = "a failed step is a failed test")]

mod application;
mod early_return;
mod nearest;
#[path = "../fill/picture.rs"]
#[allow(dead_code, reason = "shared with the tests of fill")]
mod picture;
mod samples;
#[path = "../compose/transfer.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod transfer;
#[path = "../compose/vulkan.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod vulkan;

use application::{Application, COLOR, LAYERS_DRAWN, Setup};
use ash::vk;
use parafovea::backend::mask::{
    ColorFacts, DepthFacts, DepthTemplate, DepthWork, Eligible, MaskFacts, MaskKernels, MaskMap, MaskMethod,
    PipelineFacts, depth_format,
};
use parafovea::gpu::{AppCommands, Gpu};
use parafovea::pass_detection::{Eyes, Orientation, Part, PassFacts};
use parafovea::rate_map::RateImage;
use parafovea_core::kernels::fill::FillFormat;
use parafovea_core::mask::{Mask, MaskView, TemplateDepths, TileRates, predict};
use parafovea_core::rate::VULKAN_RATES;
use picture::assert_matches;
use std::sync::Arc;
use vulkan::Vulkan;

const EXTENT: [u32; 2] = [132, 98];

/// One picture, as large as the render area.
fn parts() -> [Part; 1] {
    let (eyes, orientation) = (Eyes::Left, Orientation::Upright);
    [Part { eyes, layer: 0, rect: [0.0, 0.0, 1.0, 1.0], orientation }]
}

/// Every rate, finest in the middle, within a view that is the render area.
fn mask(area: vk::Rect2D) -> (Mask, RateImage, Vec<u8>) {
    let rates: Vec<u8> = (0..18 * 18)
        .map(|tile: u32| {
            let away = (tile % 18).abs_diff(8) + (tile / 18).abs_diff(6);
            VULKAN_RATES[6usize.saturating_sub(away as usize / 2)].texel()
        })
        .collect();
    let offset = [area.offset.x as u32, area.offset.y as u32];
    let tiles = TileRates { texel: [8; 2], first: [0; 2], columns: 18, rates: &rates };
    let extent = [area.extent.width, area.extent.height];
    let mut mask = Mask::new(EXTENT, 1);
    mask.resolve(&[MaskView { layer: 0, offset, extent, tiles }]);
    assert!((0.2..0.8).contains(&mask.shaded()), "{}", mask.shaded());
    let area = [offset[0], offset[1], extent[0], extent[1]];
    (mask, RateImage { area, texel: [8; 2], tiles: [18; 2], layers: 1 }, rates)
}

/// The layer's findings about the pass.
fn eligible(application: &Application) -> Eligible {
    let setup = application.setup;
    let mut pipelines = PipelineFacts::default();
    pipelines.directions.see(setup.compare);
    let samples = vk::SampleCountFlags::TYPE_1;
    let depth = DepthFacts {
        format: setup.depth,
        samples,
        usage: vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT,
        clear: setup.clear,
        is_loaded: false,
        is_loadable: true,
        is_covered: false,
        is_read_within: false,
        stores_stencil: false,
        is_loaded_later: false,
        is_submitted: false,
        is_separate: false,
        is_writable: true,
        is_readable: true,
    };
    let color = ColorFacts { format: COLOR, samples, is_stored: true, is_fillable: true };
    let pass = PassFacts { clears_depth: true, ..PassFacts::default() };
    parafovea::backend::mask::eligible(&MaskFacts {
        pass,
        depth: Some(depth),
        colors: &[color],
        pipelines,
        prefers_return: false,
    })
    .unwrap()
}

/// Pixels of the render area that are shaded.
fn shaded(mask: &Mask, area: vk::Rect2D) -> u32 {
    let skipped = mask.list().len() as u32 * 16;
    area.extent.width * area.extent.height - skipped
}

fn check(vulkan: &Vulkan, setup: Setup) {
    let application = Application::new(vulkan, setup, EXTENT);
    let (off, off_count) = application.frame(vulkan, |commands, draw| draw(commands, false));
    // SAFETY: the device is never destroyed.
    let gpu = &unsafe { Gpu::without_queue(&vulkan.record) }.unwrap();
    let kernels = Arc::new(MaskKernels::new(gpu).unwrap());
    let map = MaskMap::new(gpu, &kernels, eligible(&application), EXTENT, 1).unwrap();
    map.prepare(COLOR).unwrap();
    assert!(map.takes(setup.area));
    let color = application.color_part();
    let masked = |commands: vk::CommandBuffer, draw: &dyn Fn(vk::CommandBuffer, bool)| {
        // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
        let ours = unsafe { AppCommands::new(gpu, commands) };
        map.begin(&ours, application.depth_part(), setup.area, application.depth_layouts());
        draw(commands, true);
        map.end(&ours, color, COLOR, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL);
    };
    let (new, new_count) = application.frame(vulkan, masked);
    assert!(new == off && new_count == off_count, "{setup:?}: everything is shaded at first");

    let (mask, image, rates) = mask(setup.area);
    let mut staging = vec![0xff; map.staging_len()];
    map.stage(&parts(), &image, &rates, &mut staging);
    let buffer = vulkan.staging(&staging);
    vulkan.run(|commands| {
        // SAFETY: as above.
        map.upload(&unsafe { AppCommands::new(gpu, commands) }, buffer, 0);
    });
    let (on, on_count) = application.frame(vulkan, masked);
    let mut expected = off.clone();
    predict(&mut expected, FillFormat::Srgb8, &mask, 0);
    assert_matches(FillFormat::Srgb8, &expected, &on, |pixel| mask.skips(0, pixel), EXTENT);
    assert_ne!(off, on, "{setup:?}: nothing was done");
    let area = setup.area.extent.width * setup.area.extent.height;
    assert_eq!(off_count, LAYERS_DRAWN * area, "{setup:?}");
    assert_eq!(on_count, LAYERS_DRAWN * shaded(&mask, setup.area), "{setup:?}");
}

fn whole() -> vk::Rect2D {
    let [width, height] = EXTENT;
    vk::Rect2D { offset: vk::Offset2D::default(), extent: vk::Extent2D { width, height } }
}

#[test]
fn skipped_pixels_are_not_shaded_and_look_as_predicted() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let all = [
        vk::Format::D16_UNORM,
        vk::Format::X8_D24_UNORM_PACK32,
        vk::Format::D32_SFLOAT,
        vk::Format::D24_UNORM_S8_UINT,
        vk::Format::D32_SFLOAT_S8_UINT,
    ];
    let there: Vec<_> = all.into_iter().filter(|format| vulkan.draws_depth(*format)).collect();
    assert!(there.len() >= 2, "every device has D16 and one of D32 and X8_D24: {there:?}");
    for depth in there {
        for (compare, clear) in [
            (vk::CompareOp::LESS, 1.0),
            (vk::CompareOp::LESS_OR_EQUAL, 1.0),
            (vk::CompareOp::GREATER, 0.0),
            (vk::CompareOp::GREATER_OR_EQUAL, 0.0),
        ] {
            check(&vulkan, Setup { depth, compare, clear, area: whole() });
        }
    }
    vulkan.assert_valid();
}

#[test]
fn render_areas_are_kept_to() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let area =
        vk::Rect2D { offset: vk::Offset2D { x: 22, y: 7 }, extent: vk::Extent2D { width: 90, height: 71 } };
    for depth in [vk::Format::D16_UNORM, vk::Format::D32_SFLOAT] {
        check(&vulkan, Setup { depth, compare: vk::CompareOp::LESS, clear: 1.0, area });
    }
    vulkan.assert_valid();
}

#[test]
fn templates_take_areas_that_can_be_copied() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let depths = TemplateDepths { shaded: 1.0, skipped: 0.0 };
    let of = |format, extent| {
        let format = depth_format(format).unwrap();
        DepthTemplate::new(
            &vulkan.gpu,
            Eligible { format, depths, drawn: None, work: DepthWork::default() },
            extent,
            2,
        )
        .unwrap()
    };
    let at =
        |x, y| vk::Rect2D { offset: vk::Offset2D { x, y }, extent: vk::Extent2D { width: 8, height: 8 } };
    let (two_bytes, four_bytes) = (of(vk::Format::D16_UNORM, [32, 32]), of(vk::Format::D32_SFLOAT, [31, 31]));
    assert!(two_bytes.takes(at(2, 1)) && !two_bytes.takes(at(1, 0)));
    assert!(four_bytes.takes(at(1, 1)) && four_bytes.takes(at(23, 23)));
    assert!(!four_bytes.takes(at(24, 0)) && !four_bytes.takes(at(-1, 0)));
    vulkan.assert_valid();
}
