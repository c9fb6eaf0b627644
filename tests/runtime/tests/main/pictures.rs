//! Images: submitted images come out code by code, and eyes see layers at their places.

use crate::application::{
    Application, IDENTITY, SIZE, header, projection, structure, swapchain_info, views, whole,
};
use crate::case::{Case, Output, Run};
use ash::vk;
use openxr_sys as xr;

const SUCCESS: xr::Result = xr::Result::SUCCESS;

pub fn cases() -> Vec<Case> {
    let case = |name: &str, output: &str, run: fn(), check: fn(&Output)| Case {
        name: format!("pictures::{name}"),
        scenario: format!(
            "[[view]]\nwidth={SIZE}\nheight={SIZE}\n[[view]]\nwidth={SIZE}\nheight={SIZE}\n[output]\n{output}\n"
        ),
        run: Run::Good { run, check },
    };
    let both = "save=['eye','submitted']\nsave_frames=[0]";
    vec![
        case(
            "rgba_srgb_codes",
            both,
            || show_codes(vk::Format::R8G8B8A8_SRGB),
            |output| {
                check_codes(output, false);
                check_eye(output);
            },
        ),
        case(
            "bgra_srgb_codes",
            both,
            || show_codes(vk::Format::B8G8R8A8_SRGB),
            |output| check_codes(output, true),
        ),
        case(
            "rgba_unorm_codes",
            both,
            || show_codes(vk::Format::R8G8B8A8_UNORM),
            |output| check_codes(output, false),
        ),
        case(
            "bgra_unorm_codes",
            both,
            || show_codes(vk::Format::B8G8R8A8_UNORM),
            |output| check_codes(output, true),
        ),
        case("half_float_and_10_bit", both, deep_formats, deep_formats_seen),
        case("parts_of_an_array", both, parts_of_an_array, parts_of_an_array_seen),
        case("turned_views", "save_frames=[0,1]", turned_views, turned_views_seen),
        case("quads", both, quads, quads_seen),
        case("only_the_frames_asked_for", "composite=false\nsave_frames=[1]", three_frames, |output| {
            assert_eq!(pictures_in(output), ["eye0_1.png", "eye1_1.png"]);
        }),
        case("composite_without_pictures", "", three_frames, |output| {
            assert_eq!(pictures_in(output), Vec::<String>::new());
        }),
    ]
}

fn pictures_in(output: &Output) -> Vec<String> {
    let files = std::fs::read_dir(&output.folder).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = names.filter(|name| name.ends_with(".png")).collect();
    names.sort();
    names
}

/// Texels in which every channel takes every code, each at its own pace.
fn codes() -> Vec<u8> {
    (0..SIZE * SIZE)
        .flat_map(|i| [i, i * 3 + 1, 255_u32.wrapping_sub(i), i * 7].map(|code| code as u8))
        .collect()
}

fn painted(app: &Application, format: vk::Format, texels: &[u8]) -> xr::Swapchain {
    let info = xr::SwapchainCreateInfo { format: i64::from(format.as_raw()), ..swapchain_info() };
    let swapchain = app.create_swapchain(&info).unwrap();
    app.show(swapchain, 0, texels);
    swapchain
}

fn filled(colour: [u8; 4]) -> Vec<u8> {
    colour.repeat((SIZE * SIZE) as usize)
}

fn end(app: &Application, time: xr::Time, views: &[xr::CompositionLayerProjectionView]) {
    // The views' poses are the head's own: eyes differ by a position only, which a picture does not show.
    let layer = projection(app.space(xr::ReferenceSpaceType::VIEW), views);
    assert_eq!(app.end_frame(time, &[header(&layer)]), SUCCESS);
}

fn show_codes(format: vk::Format) {
    let app = Application::running();
    let time = app.begin_frame().predicted_display_time;
    let swapchain = painted(&app, format, &codes());
    end(&app, time, &views(swapchain));
}

fn check_codes(output: &Output, swapped: bool) {
    for name in ["submitted_0_0_0.png", "submitted_0_1_0.png"] {
        let (width, height, mut pixels) = output.picture(name);
        assert_eq!((width, height), (SIZE, SIZE));
        if swapped {
            pixels.chunks_exact_mut(4).for_each(|pixel| pixel.swap(0, 2));
        }
        assert!(pixels == codes(), "{name}");
    }
}

/// The eye has the codes too, opaque.
fn check_eye(output: &Output) {
    for name in ["eye0_0.png", "eye1_0.png"] {
        let mut expected = codes();
        expected.chunks_exact_mut(4).for_each(|pixel| pixel[3] = 255);
        assert!(output.picture(name).2 == expected, "{name}");
    }
}

fn deep_formats() {
    let app = Application::running();
    let time = app.begin_frame().predicted_display_time;
    // Half floats: 0.5, 1.0, 0.0, 1.0. Ten bits: 512, 1023, 0, and 3 of 2 bits.
    let half = [0x3800_u16, 0x3c00, 0, 0x3c00].map(u16::to_le_bytes).concat();
    let ten = (512_u32 | 1023 << 10 | 3 << 30).to_le_bytes();
    let texels = |texel: &[u8]| texel.repeat((SIZE * SIZE) as usize);
    let first = painted(&app, vk::Format::R16G16B16A16_SFLOAT, &texels(&half));
    let second = painted(&app, vk::Format::A2B10G10R10_UNORM_PACK32, &texels(&ten));
    end(&app, time, &[views(first)[0], views(second)[1]]);
}

fn deep_formats_seen(output: &Output) {
    // Linear 0.5 is code 188 of sRGB; 512 of 1023 is code 128 of 255.
    assert_eq!(output.picture("submitted_0_0_0.png").2[..4], [188, 255, 0, 255]);
    assert_eq!(output.picture("submitted_0_1_0.png").2[..4], [128, 255, 0, 255]);
}

fn parts_of_an_array() {
    let app = Application::running();
    let time = app.begin_frame().predicted_display_time;
    let swapchain =
        app.create_swapchain(&xr::SwapchainCreateInfo { array_size: 2, ..swapchain_info() }).unwrap();
    let index = app.acquire(swapchain).unwrap() as usize;
    assert_eq!(app.wait(swapchain), SUCCESS);
    let image = app.images(swapchain)[index];
    let gpu = app.gpu.as_ref().unwrap();
    gpu.paint(image, 0, SIZE, SIZE, &filled([255, 0, 0, 255]));
    gpu.paint(image, 1, SIZE, SIZE, &codes());
    assert_eq!(app.release(swapchain), SUCCESS);
    let mut views = views(swapchain);
    views[1].sub_image.image_array_index = 1;
    views[1].sub_image.image_rect = xr::Rect2Di {
        offset: xr::Offset2Di { x: 16, y: 8 },
        extent: xr::Extent2Di { width: 32, height: 24 },
    };
    end(&app, time, &views);
}

fn parts_of_an_array_seen(output: &Output) {
    assert!(output.picture("submitted_0_0_0.png").2 == filled([255, 0, 0, 255]));
    let (width, height, pixels) = output.picture("submitted_0_1_0.png");
    assert_eq!((width, height), (32, 24));
    let codes = codes();
    for (y, row) in pixels.chunks_exact(32 * 4).enumerate() {
        let start = ((y + 8) * SIZE as usize + 16) * 4;
        assert!(row == &codes[start..start + row.len()], "row {y}");
    }
}

/// Red in the left half, blue in the right one.
fn halves() -> Vec<u8> {
    let half = SIZE / 2;
    (0..SIZE * SIZE).flat_map(|i| if i % SIZE < half { [255, 0, 0, 255] } else { [0, 0, 255, 255] }).collect()
}

fn turned_views() {
    let app = Application::running();
    for yaw in [0.3_f32, -0.3] {
        let time = app.begin_frame().predicted_display_time;
        let mut views = views(painted(&app, vk::Format::R8G8B8A8_SRGB, &halves()));
        for view in &mut views {
            (view.pose.orientation.y, view.pose.orientation.w) = ((yaw / 2.0).sin(), (yaw / 2.0).cos());
        }
        end(&app, time, &views);
    }
}

fn turned_views_seen(output: &Output) {
    let middle = ((SIZE / 2 * SIZE + SIZE / 2) * 4) as usize;
    let left_edge = (SIZE / 2 * SIZE * 4) as usize;
    let seen = |name: &str, at: usize| output.picture(name).2[at..at + 4].to_vec();
    // Submitted for a view to the left, in which the forward direction was right of the middle. At the right edge nothing was rendered.
    assert_eq!(seen("eye0_0.png", middle), [0, 0, 255, 255]);
    assert_eq!(seen("eye0_0.png", left_edge + SIZE as usize * 4 - 4), [0, 0, 0, 255]);
    assert_eq!(seen("eye0_1.png", middle), [255, 0, 0, 255]);
    assert_eq!(seen("eye0_1.png", left_edge), [0, 0, 0, 255]);
}

fn quads() {
    let app = Application::running();
    let time = app.begin_frame().predicted_display_time;
    let background = views(painted(&app, vk::Format::R8G8B8A8_SRGB, &filled([0, 0, 255, 255])));
    let space = app.space(xr::ReferenceSpaceType::VIEW);
    let quad = |texels: &[u8], flags, eyes, x| {
        structure!(CompositionLayerQuad {
            layer_flags: flags,
            space: space,
            eye_visibility: eyes,
            sub_image: whole(painted(&app, vk::Format::R8G8B8A8_SRGB, texels)),
            pose: xr::Posef { position: xr::Vector3f { x, y: 0.0, z: -2.0 }, ..IDENTITY },
            size: xr::Extent2Df { width: 0.5, height: 0.5 },
        })
    };
    let (none, alpha) =
        (xr::CompositionLayerFlags::EMPTY, xr::CompositionLayerFlags::BLEND_TEXTURE_SOURCE_ALPHA);
    let straight = alpha | xr::CompositionLayerFlags::UNPREMULTIPLIED_ALPHA;
    let (both, left) = (xr::EyeVisibility::BOTH, xr::EyeVisibility::LEFT);
    // In the middle: opaque despite an alpha of 0. To the left: half opaque, once premultiplied and once not. To the right: for one eye.
    let middle = quad(&filled([255, 0, 0, 0]), none, both, 0.0);
    let half = quad(&filled([188, 0, 0, 128]), alpha, both, -1.0);
    let same = quad(&filled([255, 0, 0, 128]), straight, both, -1.0);
    let one = quad(&filled([0, 255, 0, 255]), none, left, 1.0);
    let projection = projection(space, &background);
    let layers = [header(&projection), header(&middle), header(&half), header(&same), header(&one)];
    assert_eq!(app.end_frame(time, &layers), SUCCESS);
}

fn quads_seen(output: &Output) {
    // A metre aside at two metres is a quarter of the picture's width; the eyes are 32 mm aside.
    let column = |x: f32| (SIZE as f32 * (0.5 + x / 4.0)) as u32;
    let at = |name: &str, x: f32| {
        let place = ((SIZE / 2 * SIZE + column(x)) * 4) as usize;
        output.picture(name).2[place..place + 4].to_vec()
    };
    for name in ["eye0_0.png", "eye1_0.png"] {
        assert_eq!(at(name, 0.0), [255, 0, 0, 255], "{name}");
        assert_eq!(at(name, 0.5), [0, 0, 255, 255], "{name}");
        // Red 0.5 over blue, then again: red 0.75 and blue 0.25 in linear light.
        let blended = at(name, -1.0);
        let near = |a: u8, b: u8| a.abs_diff(b) <= 1;
        assert!(near(blended[0], 225) && blended[1] == 0 && near(blended[2], 137), "{name}: {blended:?}");
    }
    assert_eq!(at("eye0_0.png", 1.0), [0, 255, 0, 255]);
    assert_eq!(at("eye1_0.png", 1.0), [0, 0, 255, 255]);
    assert_eq!(output.picture("submitted_2_0_0.png").2[..4], [188, 0, 0, 128]);
}

fn three_frames() {
    let app = Application::running();
    for _ in 0..3 {
        let time = app.begin_frame().predicted_display_time;
        end(&app, time, &views(painted(&app, vk::Format::R8G8B8A8_SRGB, &codes())));
    }
}
