//! What the renderer draws, on whatever Vulkan device there is.

#![expect(clippy::unwrap_used, reason = "a test says where it failed")]

use glam::{Quat, vec3};
use parafovea_scene::{camera::Camera, offscreen::Offscreen, scene::lights};

const SIDE: u32 = 128;

fn visitor() -> Camera {
    Camera::new(vec3(0.0, 1.6, 0.0), Quat::IDENTITY, [-0.8, 0.8, -0.8, 0.8])
}

fn picture(format: wgpu::TextureFormat, lights: u32, frame: u64) -> Vec<u8> {
    let mut offscreen = Offscreen::new(SIDE, SIDE, format, lights).unwrap();
    offscreen.draw(frame, &[visitor()]).unwrap();
    offscreen.texels().unwrap()
}

#[test]
fn a_frame_number_means_one_picture() {
    let srgb = wgpu::TextureFormat::Rgba8UnormSrgb;
    let first = picture(srgb, lights::DEFAULT, 100);
    // Other frames before it change nothing.
    let mut offscreen = Offscreen::new(SIDE, SIDE, srgb, lights::DEFAULT).unwrap();
    for frame in [3, 50, 100] {
        offscreen.draw(frame, &[visitor()]).unwrap();
    }
    assert!(first == offscreen.texels().unwrap(), "frame 100 differs between two runs");
    offscreen.draw(145, &[visitor()]).unwrap();
    assert!(first != offscreen.texels().unwrap(), "nothing moved in half a second");
}

#[test]
fn formats_agree() {
    let srgb = picture(wgpu::TextureFormat::Rgba8UnormSrgb, lights::DEFAULT, 7);
    let unorm = picture(wgpu::TextureFormat::Rgba8Unorm, lights::DEFAULT, 7);
    let worst = srgb.iter().zip(&unorm).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(worst <= Some(1), "the shader's sRGB encoding is {worst:?} codes off the format's");
}

#[test]
fn more_lights_are_brighter() {
    let light = |count| {
        picture(wgpu::TextureFormat::Rgba8Unorm, count, 0).iter().map(|&code| u64::from(code)).sum::<u64>()
    };
    let (none, some, many) = (light(0), light(lights::DEFAULT), light(64));
    assert!(none < some && some < many, "{none} {some} {many}");
}

/// The picture has both ends: near-black in the corner, near-white in the sky.
#[test]
fn dark_corner_and_bright_sky() {
    let mut offscreen = Offscreen::new(SIDE, SIDE, wgpu::TextureFormat::Rgba8Unorm, lights::DEFAULT).unwrap();
    let mean = |texels: &[u8]| {
        texels.chunks_exact(4).flat_map(|texel| &texel[..3]).map(|&code| f64::from(code)).sum::<f64>()
            / (texels.len() / 4 * 3) as f64
    };
    let narrow = [-0.1, 0.1, -0.1, 0.1];
    let corner = Camera::new(vec3(0.0, 1.6, 0.0), Quat::from_rotation_y(0.97), narrow);
    offscreen.draw(0, &[corner]).unwrap();
    let dark = mean(&offscreen.texels().unwrap());
    let sky = Camera::new(vec3(0.0, 1.6, 0.0), Quat::from_rotation_x(0.5), narrow);
    offscreen.draw(0, &[sky]).unwrap();
    let bright = mean(&offscreen.texels().unwrap());
    assert!(dark < 24.0 && bright > 190.0, "corner {dark:.1}, sky {bright:.1}");
}
