//! Engines with open sources: Godot 4 (`RenderForwardMobile`, `RenderForwardClustered`), Bevy 0.14 (`Core3d`), and id Tech and Source 2 as
//! captures of their games show them.

use super::multisampled;
use crate::frame_graphs::Arrangement;
use crate::frame_graphs::frame::{BYTES, DEPTH, Frame, HDR, NORMALS, VELOCITY, eye_of, scaled};
use crate::frame_graphs::step::{Step, Truth::Eye as IsEye, Truth::FullScreen};
use crate::frame_graphs::textures::{Texture, draw_all, draw_all_late};
use parafovea::pass_detection::TransferKind;

/// Godot's mobile renderer: multiview, tone mapping in a subpass.
pub(crate) fn godot_mobile(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.eye;
    let color = frame.array("internal", size, NORMALS);
    let depth = frame.array("depth", size, DEPTH);
    let swapchain = frame.swapchain(0);
    let step = Step::new("scene", IsEye(None), &[color, swapchain]).clears(depth);
    frame.add(step.meshes(180, &sampled).full_screen(&[color]));
    draw_all_late(frame, textures);
}

/// Godot's clustered renderer: a depth and normal pre-pass, multiview in high dynamic range, tone mapping in a pass of its own.
pub(crate) fn godot_forward(frame: &mut Frame<'_>, textures: &[Texture]) {
    let mut sampled = draw_all(frame, textures);
    let size = frame.size();
    let color = frame.array("color", size, HDR);
    let normals = frame.array("normal_roughness", size, BYTES);
    let depth = frame.array("depth", size, DEPTH);
    frame.add(Step::new("depth and normals", IsEye(None), &[normals]).clears(depth).meshes(150, &[]));
    sampled.push(normals);
    frame.add(Step::new("opaque", IsEye(None), &[color]).loads(depth).meshes(320, &sampled));
    let screen = frame.array("screen_texture", size, HDR);
    frame.blit(color, screen);
    sampled.push(screen);
    frame.add(Step::new("transparent", IsEye(None), &[color]).loads(depth).meshes(25, &sampled));
    let swapchain = frame.swapchain(0);
    frame.add(Step::new("tone-map", FullScreen, &[swapchain]).full_screen(&[color]));
    draw_all_late(frame, textures);
}

/// Bevy: a camera for each eye; opaque, transmissive with a copy of the view, transparent; tone mapping into the other of two
/// images, which change places from frame to frame (Bevy 0.19 does so with HDR), an upscaling pass into the swapchain.
pub(crate) fn bevy(frame: &mut Frame<'_>, textures: &[Texture]) {
    let mut sampled = draw_all(frame, textures);
    let size = frame.size();
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        let mut pair = ["main_texture_a", "main_texture_b"].map(|name| frame.image(name, view, size, HDR));
        pair.rotate_left((frame.number % 2) as usize);
        let [a, b] = pair;
        let depth = frame.image("view_depth_texture", view, size, DEPTH);
        let transmission = frame.image("view_transmission_texture", view, size, HDR);
        frame.add(Step::new("opaque", is_eye, &[a]).clears(depth).meshes(280, &sampled));
        frame.copy(a, transmission);
        sampled.push(transmission);
        frame.add(Step::new("transmissive", is_eye, &[a]).loads(depth).meshes(6, &sampled));
        sampled.pop();
        frame.add(Step::new("transparent", is_eye, &[a]).loads(depth).meshes(18, &sampled));
        frame.add(Step::new("tone-map", FullScreen, &[b]).full_screen(&[a]));
        let swapchain = frame.swapchain(view);
        let upscale = Step::new("upscale", FullScreen, &[swapchain]).full_screen(&[b]);
        let is_array = frame.arrangement == Arrangement::Array;
        frame.add(if is_array { upscale.layer(view as u32) } else { upscale });
    }
    draw_all_late(frame, textures);
}

/// id Tech 7: a depth pre-pass, opaque with velocities and normals beside the colours, multiview; deferred composition and temporal
/// anti-aliasing in compute; blitted to the swapchain from the image that compute writes.
pub(crate) fn id_tech(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.array("depth", size, DEPTH);
    let color = frame.array("lighting", size, HDR);
    let velocity = frame.array("velocity", size, VELOCITY);
    let normals = frame.array("normals", size, BYTES);
    frame.add(Step::depth_only("pre-pass", IsEye(None), depth).meshes(170, &[]));
    let opaque = Step::new("opaque", IsEye(None), &[color, velocity, normals]).loads(depth);
    frame.add(opaque.meshes(450, &sampled));
    frame.add(Step::new("particles", IsEye(None), &[color]).loads(depth).meshes(20, &sampled));
    let out = frame.array("anti-aliased", size, BYTES);
    let swapchain = frame.swapchain(0);
    frame.blit(out, swapchain);
    draw_all_late(frame, textures);
}

/// Source 2: multisampled forward rendering for each eye, resolved by the pass; the visible-area mesh maps tones.
pub(crate) fn source2(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        let color = multisampled(frame, "eye", 0, size, 1, HDR);
        let depth = multisampled(frame, "eye depth", 0, size, 1, DEPTH);
        let resolved = frame.image("resolved", view, size, HDR);
        frame.add(Step::depth_only("pre-pass", is_eye, depth).meshes(90, &[]));
        let opaque = Step::new("opaque", is_eye, &[color]).loads(depth);
        frame.add(opaque.meshes(330, &sampled));
        let translucent = Step::new("translucent", is_eye, &[color]).loads(depth).resolves(&[resolved]);
        frame.add(translucent.meshes(30, &sampled));
    }
    for view in 0..2 {
        let resolved = frame.image("resolved", view, size, HDR);
        let swapchain = frame.swapchain(view);
        let post = Step::new("post", FullScreen, &[swapchain]);
        frame.add(post.small_meshes(1, 306, &[resolved]));
    }
    draw_all_late(frame, textures);
}

/// A game on an older id Tech: both eyes in turn into one image, resolved by a transfer, blitted upscaled.
pub(crate) fn id_tech_blits(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    for view in 0..2 {
        let color = multisampled(frame, "view", 0, size, 1, BYTES);
        let depth = multisampled(frame, "view depth", 0, size, 1, DEPTH);
        let resolved = frame.image("view resolved", 0, size, BYTES);
        let scene = Step::new("scene", IsEye(eye_of(view)), &[color]).clears(depth);
        frame.add(scene.meshes(600, &sampled));
        let rect = crate::frame_graphs::frame::rect_of(size);
        frame.transfer(TransferKind::Resolve, (color, rect), (resolved, rect));
        let swapchain = frame.swapchain(view);
        frame.blit(resolved, swapchain);
    }
    let spectator = frame.image("window", 0, scaled([1920, 1080], 1.0), BYTES);
    let resolved = frame.image("view resolved", 0, size, BYTES);
    frame.add(Step::new("window", FullScreen, &[spectator]).full_screen(&[resolved]));
    draw_all_late(frame, textures);
}
