//! A pass whose fragment shaders return early in skipped blocks: those are not shaded, and are filled as predicted; all else is as
//! without, bit for bit.

use super::*;
use parafovea_core::mask::{DepthFormat, EarlyReturnParams};

/// By a template that only shaders read, and by one that is a depth template too.
#[test]
fn fragments_of_skipped_blocks_return_early() {
    for (device, versions) in
        [(vk::API_VERSION_1_1, &[(1, 0), (1, 3)][..]), (vk::API_VERSION_1_2, &[(1, 4), (1, 5)][..])]
    {
        let vulkan = Vulkan::at(device);
        for version in versions {
            let area = vk::Rect2D {
                offset: vk::Offset2D { x: 22, y: 7 },
                extent: vk::Extent2D { width: 90, height: 71 },
            };
            let depths = TemplateDepths { shaded: 1.0, skipped: 0.0 };
            let of_depth = Eligible { depths, format: DepthFormat::Float32, ..MaskMethod::RETURN };
            check(&vulkan, *version, MaskMethod::RETURN, whole());
            check(&vulkan, *version, MaskMethod::RETURN, area);
            check(&vulkan, *version, of_depth, area);
            check(&vulkan, *version, Eligible { format: DepthFormat::Unorm16, ..of_depth }, whole());
        }
        vulkan.assert_valid();
    }
}

fn check(vulkan: &Vulkan, version: (u8, u8), eligible: Eligible, area: vk::Rect2D) {
    let setup = Setup { depth: vk::Format::D32_SFLOAT, compare: vk::CompareOp::LESS, clear: 1.0, area };
    let plain = Application::of_version(vulkan, setup, EXTENT, version, None);
    let (off, off_count) = plain.frame(vulkan, |commands, draw| draw(commands, false));
    // SAFETY: the device is never destroyed.
    let gpu = &unsafe { Gpu::without_queue(&vulkan.record) }.unwrap();
    let kernels = Arc::new(MaskKernels::new(gpu).unwrap());
    let map = MaskMap::new(gpu, &kernels, eligible, EXTENT, 1).unwrap();
    map.prepare(COLOR).unwrap();
    let params = EarlyReturnParams::new(EXTENT, eligible.format, eligible.depths).unwrap();
    let (buffer, memory) = vulkan.buffer_of(64, vk::BufferUsageFlags::UNIFORM_BUFFER);
    vulkan.write_memory(memory, bytemuck::bytes_of(&params));
    let buffers = [map.template().unwrap(), buffer];
    let application = Application::of_version(vulkan, setup, EXTENT, version, Some(buffers));
    let all = application.frame(vulkan, |commands, draw| draw(commands, false));
    assert!(all == (off.clone(), off_count), "{version:?}: everything is shaded at first");

    let (mask, image, rates) = mask(area);
    let mut staging = vec![0xff; map.staging_len()];
    map.stage(&parts(), &image, &rates, &mut staging);
    let staged = vulkan.staging(&staging);
    vulkan.run(|commands| {
        // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
        map.upload(&unsafe { AppCommands::new(gpu, commands) }, staged, 0);
    });
    let (early, early_count) = application.frame(vulkan, |commands, draw| draw(commands, false));
    let passed = |application: &Application| samples_passed(vulkan, application);
    assert!(passed(&plain) > 0);
    assert_eq!(passed(&application), passed(&plain), "{version:?}: an occlusion query counts as without");
    let texel = |pixels: &[u8], [x, y]: [u32; 2]| {
        let at = (y * EXTENT[0] + x) as usize * 4;
        [pixels[at], pixels[at + 1], pixels[at + 2], pixels[at + 3]]
    };
    for index in 0..EXTENT[0] * EXTENT[1] {
        let pixel = [index % EXTENT[0], index / EXTENT[0]];
        let expected = if mask.skips(0, pixel) { [0; 4] } else { texel(&off, pixel) };
        assert_eq!(texel(&early, pixel), expected, "{version:?} {eligible:?} {pixel:?}");
    }
    assert_eq!(off_count, LAYERS_DRAWN * area.extent.width * area.extent.height);
    assert_eq!(early_count, LAYERS_DRAWN * shaded(&mask, area), "{version:?} {eligible:?}");

    let (filled, _) = application.frame(vulkan, |commands, draw| {
        draw(commands, false);
        // SAFETY: as above.
        let ours = unsafe { AppCommands::new(gpu, commands) };
        map.end(&ours, application.color_part(), COLOR, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL);
    });
    let mut expected = off.clone();
    predict(&mut expected, FillFormat::Srgb8, &mask, 0);
    assert_matches(FillFormat::Srgb8, &expected, &filled, |pixel| mask.skips(0, pixel), EXTENT);
}

/// The count of an occlusion query around the pass.
fn samples_passed(vulkan: &Vulkan, application: &Application) -> u32 {
    let device = &vulkan.device;
    let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::OCCLUSION).query_count(1);
    // SAFETY: plain use of Vulkan; the pool is never destroyed.
    let pool = unsafe { device.create_query_pool(&info, None) }.unwrap();
    application.frame(vulkan, |commands, draw| {
        // SAFETY: the command buffer is being recorded, outside of a render pass.
        unsafe {
            device.cmd_reset_query_pool(commands, pool, 0, 1);
            device.cmd_begin_query(commands, pool, 0, vk::QueryControlFlags::empty());
            draw(commands, false);
            device.cmd_end_query(commands, pool, 0);
        }
    });
    let mut passed = [0u32];
    // SAFETY: the frame has finished.
    unsafe { device.get_query_pool_results(pool, 0, &mut passed, vk::QueryResultFlags::WAIT) }.unwrap();
    passed[0]
}
