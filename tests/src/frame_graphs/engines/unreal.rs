//! Unreal Engine 4.27 and 5: the forward renderer with multisampling, and the deferred one with temporal super-resolution
//! (`FDeferredShadingSceneRenderer::Render`, `FSceneRenderer`).

use super::multisampled;
use crate::frame_graphs::Arrangement;
use crate::frame_graphs::frame::{BYTES, DEPTH, Frame, HDR, Image, NORMALS, PACKED, VELOCITY, eye_of};
use crate::frame_graphs::step::{Step, Truth::Eye as IsEye, Truth::FullScreen, Truth::Shading};
use crate::frame_graphs::textures::{Texture, draw_all, draw_all_late};

/// Vertices of the visible-area mesh that full-screen passes draw.
const VISIBLE_AREA: u32 = 252;

fn to_swapchain(frame: &mut Frame<'_>, name: &'static str, from: &[Image]) {
    match frame.arrangement {
        Arrangement::Separate => {
            for view in 0..2 {
                let swapchain = frame.swapchain(view);
                frame.add(Step::new(name, FullScreen, &[swapchain]).small_meshes(1, VISIBLE_AREA, from));
            }
        }
        Arrangement::DoubleWide => {
            let swapchain = frame.swapchain(0);
            let [width, height] = frame.eye;
            for view in 0..2 {
                let step = Step::new(name, FullScreen, &[swapchain]).area([view * width, 0, width, height]);
                frame.add(step.small_meshes(1, VISIBLE_AREA, from));
            }
        }
        Arrangement::Array => {
            let swapchain = frame.swapchain(0);
            frame.add(Step::new(name, FullScreen, &[swapchain]).small_meshes(1, VISIBLE_AREA, from));
        }
    }
}

/// Forward, multisampled, both eyes beside each other in one target; the swapchain holds both.
pub(crate) fn forward(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let wide = frame.wide();
    let color = multisampled(frame, "SceneColorMS", 0, wide, 1, PACKED);
    let depth = multisampled(frame, "SceneDepthMS", 0, wide, 1, DEPTH);
    let resolved = frame.image("SceneColor", 0, wide, PACKED);
    frame.add(Step::depth_only("pre-pass", IsEye(None), depth).meshes(190, &[]));
    let base = Step::new("base pass", IsEye(None), &[color]).loads(depth);
    frame.add(base.meshes(640, &sampled));
    let translucent = Step::new("translucency", IsEye(None), &[color]).loads(depth).resolves(&[resolved]);
    frame.add(translucent.meshes(40, &sampled));
    let bloom = frame.image("bloom", 0, crate::frame_graphs::frame::scaled(wide, 0.5), PACKED);
    frame.add(Step::new("bloom", FullScreen, &[bloom]).full_screen(&[resolved]));
    to_swapchain(frame, "tone-map", &[resolved, bloom]);
    draw_all_late(frame, textures);
}

/// Forward with translucency in an image of its own, composed with the scene's afterwards; without multisampling.
pub(crate) fn separate_translucency(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let wide = frame.wide();
    let depth = frame.image("SceneDepthZ", 0, wide, DEPTH);
    let color = frame.image("SceneColor", 0, wide, PACKED);
    let translucency = frame.image("SeparateTranslucency", 0, wide, HDR);
    let composed = frame.image("Composed", 0, wide, HDR);
    frame.add(Step::new("base pass", IsEye(None), &[color]).clears(depth).meshes(640, &sampled));
    let translucent = Step::new("translucency", IsEye(None), &[translucency]).loads(depth);
    frame.add(translucent.meshes(40, &sampled));
    let compose = Step::new("compose", FullScreen, &[composed]);
    frame.add(compose.full_screen(&[color, translucency, depth]));
    to_swapchain(frame, "tone-map", &[composed]);
    draw_all_late(frame, textures);
}

/// Deferred with temporal super-resolution in compute, whose image no pass draws to; then tone mapping.
pub(crate) fn temporal_compute(frame: &mut Frame<'_>, textures: &[Texture]) {
    draw_temporal_compute(frame, textures, |color, _| vec![color]);
}

/// The same where the image that tone mapping reads is not followed: a copy's destination.
pub(crate) fn temporal_copied(frame: &mut Frame<'_>, textures: &[Texture]) {
    draw_temporal_compute(frame, textures, |_, _| Vec::new());
}

/// The same without draws after the G-buffer, and with two passes after the upscaler.
pub(crate) fn temporal_plain(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let (wide, shown) = (frame.wide(), [2 * frame.eye[0], frame.eye[1]]);
    let depth = frame.image("SceneDepthZ", 0, wide, DEPTH);
    let buffers = [
        frame.image("GBufferA", 0, wide, NORMALS),
        frame.image("GBufferB", 0, wide, BYTES),
        frame.image("GBufferC", 0, wide, BYTES),
    ];
    frame.add(Step::new("base pass", IsEye(None), &buffers).clears(depth).meshes(560, &sampled));
    // Written by compute, as its lighting is.
    let upscaled = frame.image("TSR.Output", 0, shown, HDR);
    let mapped = frame.image("mapped", 0, shown, BYTES);
    frame.add(Step::new("tone-map", FullScreen, &[mapped]).full_screen(&[upscaled]));
    to_swapchain(frame, "to the swapchain", &[mapped]);
    draw_all_late(frame, textures);
}

/// `read` gives the images that are followed of those which tone mapping reads.
fn draw_temporal_compute(
    frame: &mut Frame<'_>,
    textures: &[Texture],
    read: impl Fn(Image, Image) -> Vec<Image>,
) {
    let sampled = draw_all(frame, textures);
    let (wide, shown) = (frame.wide(), [2 * frame.eye[0], frame.eye[1]]);
    let depth = frame.image("SceneDepthZ", 0, wide, DEPTH);
    let color = frame.image("SceneColorDeferred", 0, wide, HDR);
    let buffers = [
        frame.image("GBufferA", 0, wide, NORMALS),
        frame.image("GBufferB", 0, wide, BYTES),
        frame.image("GBufferC", 0, wide, BYTES),
    ];
    let drawn = [color, buffers[0], buffers[1], buffers[2]];
    frame.add(Step::depth_only("pre-pass", IsEye(None), depth).meshes(200, &[]));
    frame.add(Step::new("base pass", IsEye(None), &drawn).loads(depth).meshes(560, &sampled));
    let mut lit: Vec<Image> = buffers.to_vec();
    lit.push(depth);
    frame.add(Step::new("lights", Shading(None), &[color]).over().loads(depth).small_meshes(24, 180, &lit));
    frame.add(Step::new("translucency", IsEye(None), &[color]).over().loads(depth).meshes(60, &sampled));
    // Written by compute.
    let upscaled = frame.image("TSR.Output", 0, shown, HDR);
    to_swapchain(frame, "tone-map", &read(upscaled, color));
    draw_all_late(frame, textures);
}

/// Forward for mobile headsets: multiview, tone-mapped in the shader, straight.
pub(crate) fn mobile(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let swapchain = frame.swapchain(0);
    let size = frame.eye;
    let depth = frame.array("SceneDepth", size, DEPTH);
    frame.add(Step::new("base pass", IsEye(None), &[swapchain]).clears(depth).meshes(240, &sampled));
    draw_all_late(frame, textures);
}

/// Deferred: a G-buffer for each eye beside the other, lights as meshes over it and as full-screen passes, translucency, a temporal
/// upscaler as full-screen passes that read their history, and tone mapping.
pub(crate) fn deferred(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let (wide, shown) = (frame.wide(), [2 * frame.eye[0], frame.eye[1]]);
    let depth = frame.image("SceneDepthZ", 0, wide, DEPTH);
    let color = frame.image("SceneColorDeferred", 0, wide, HDR);
    let buffers = [
        frame.image("GBufferA", 0, wide, NORMALS),
        frame.image("GBufferB", 0, wide, BYTES),
        frame.image("GBufferC", 0, wide, BYTES),
    ];
    let velocity = frame.image("Velocity", 0, wide, VELOCITY);
    let drawn = [color, buffers[0], buffers[1], buffers[2]];
    frame.add(Step::depth_only("pre-pass", IsEye(None), depth).meshes(200, &[]));
    frame.add(Step::new("base pass", IsEye(None), &drawn).loads(depth).meshes(560, &sampled));
    frame.add(Step::new("velocity", IsEye(None), &[velocity]).loads(depth).meshes(45, &[]));
    let occlusion = frame.image("ScreenSpaceAO", 0, wide, crate::frame_graphs::frame::MASK);
    frame.add(Step::new("occlusion", FullScreen, &[occlusion]).full_screen(&[depth, buffers[0]]));
    let mut lit: Vec<Image> = buffers.to_vec();
    lit.extend([depth, occlusion]);
    // Directional lights read shadow maps too.
    lit.extend(&sampled);
    frame.add(Step::new("directional light", Shading(None), &[color]).loads(depth).full_screen(&lit));
    frame.add(Step::new("lights", Shading(None), &[color]).loads(depth).small_meshes(24, 180, &lit));
    frame.add(Step::new("translucency", IsEye(None), &[color]).loads(depth).meshes(60, &sampled));
    let parity = (frame.number % 2) as usize;
    let history = frame.image("TSR.History", 1 - parity, shown, HDR);
    let upscaled = frame.image("TSR.History", parity, shown, HDR);
    let upscale = Step::new("temporal upscaling", FullScreen, &[upscaled]);
    frame.add(upscale.full_screen(&[color, velocity, depth, history]));
    to_swapchain(frame, "tone-map", &[upscaled]);
    draw_all_late(frame, textures);
}

/// Deferred with an upscaler in compute, for each eye in images that both share; copied to the swapchain.
pub(crate) fn deferred_compute(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("SceneDepthZ", 0, size, DEPTH);
    let buffers = [
        frame.image("GBufferA", 0, size, NORMALS),
        frame.image("GBufferB", 0, size, BYTES),
        frame.image("GBufferC", 0, size, BYTES),
    ];
    let color = frame.image("SceneColorDeferred", 0, size, HDR);
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        frame.add(Step::new("base pass", is_eye, &buffers).clears(depth).meshes(560, &sampled));
        // Lighting in compute, into `color`.
        frame.add(Step::new("translucency", is_eye, &[color]).loads(depth).meshes(50, &sampled));
        // Upscaled in compute, and tone-mapped.
        let extent = frame.eye;
        let mapped = frame.image("mapped", 0, extent, BYTES);
        let swapchain = frame.swapchain(view);
        frame.copy(mapped, swapchain);
    }
    draw_all_late(frame, textures);
}
