//! Applications of few people: straight, deferred with lights as meshes, with a visibility buffer, with a spectator's camera.

use crate::frame_graphs::frame::{BYTES, DEPTH, Frame, HDR, IDENTITY, Image, LDR, NORMALS, eye_of};
use crate::frame_graphs::step::{Step, Truth, Truth::Eye as IsEye, Truth::FullScreen, Truth::Shading};
use crate::frame_graphs::textures::{Texture, draw_all, draw_all_late};
use ash::vk;

/// Straight into a swapchain for each eye.
pub(crate) fn straight(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.eye;
    let depth = frame.image("depth", 0, size, DEPTH);
    for view in 0..2 {
        let swapchain = frame.swapchain(view);
        let scene = Step::new("scene", IsEye(eye_of(view)), &[swapchain]).clears(depth);
        frame.add(scene.meshes(200, &sampled).quads(3, &sampled));
    }
    draw_all_late(frame, textures);
}

/// Deferred, with lights as meshes that read the G-buffer and load its depth, tone-mapped.
pub(crate) fn light_volumes(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    let albedo = frame.image("albedo", 0, size, BYTES);
    let normals = frame.image("normals", 0, size, NORMALS);
    let lit = frame.image("lit", 0, size, HDR);
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        frame.add(Step::new("G-buffer", is_eye, &[albedo, normals]).clears(depth).meshes(300, &sampled));
        let read = [albedo, normals, depth];
        let lights = Step::new("lights", Shading(eye_of(view)), &[lit]).loads(depth);
        frame.add(lights.full_screen(&read).small_meshes(64, 240, &read));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("tone-map", FullScreen, &[swapchain]).full_screen(&[lit]));
    }
    draw_all_late(frame, textures);
}

/// Numbers of triangles first, then a full-screen pass that shades, straight to the swapchain.
pub(crate) fn visibility(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    let identity = frame.image("identity", 0, size, IDENTITY);
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        frame.add(Step::new("identity", is_eye, &[identity]).clears(depth).meshes(300, &[]));
        let mut read = vec![identity, depth];
        read.extend(&sampled);
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("shading", Shading(eye_of(view)), &[swapchain]).full_screen(&read));
    }
    draw_all_late(frame, textures);
}

/// A second camera of the same aspect for spectators, drawn before the eyes and shown in a window.
pub(crate) fn spectator(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    let camera = frame.image("spectator", 0, size, HDR);
    frame.add(Step::new("spectator", Truth::Texture, &[camera]).clears(depth).meshes(280, &sampled));
    for view in 0..2 {
        let color = frame.image("bright", view, size, HDR);
        frame.add(Step::new("scene", IsEye(eye_of(view)), &[color]).clears(depth).meshes(300, &sampled));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("tone-map", FullScreen, &[swapchain]).full_screen(&[color]));
    }
    let window = frame.image("window", 0, [1920, 1080], LDR);
    frame.add(Step::new("window", FullScreen, &[window]).full_screen(&[camera]));
    draw_all_late(frame, textures);
}

/// Mirrors in the images that the eyes are drawn to later: a pool of render targets.
pub(crate) fn pooled_mirror(frame: &mut Frame<'_>, textures: &[Texture]) {
    draw_pooled_mirror(frame, textures, |_, step, depth| step.clears(depth));
}

/// The same with each depth cleared by a pass of its own, as DXVK clears views that the next framebuffer lacks.
pub(crate) fn pooled_mirror_with_clears(frame: &mut Frame<'_>, textures: &[Texture]) {
    draw_pooled_mirror(frame, textures, |frame, step, depth| {
        frame.add(Step::depth_only("clear", Truth::Texture, depth));
        step.loads(depth)
    });
}

/// `with_depth` gives a step the depth, cleared.
fn draw_pooled_mirror(
    frame: &mut Frame<'_>,
    textures: &[Texture],
    with_depth: impl Fn(&mut Frame<'_>, Step, Image) -> Step,
) {
    let mut sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    let color = frame.image("bright", 0, size, HDR);
    let mirror = frame.image("mirror", 90, size, LDR);
    let step = with_depth(frame, Step::new("mirror", Truth::Texture, &[color]), depth);
    frame.add(step.meshes(120, &sampled));
    frame.add(Step::new("tone-map mirror", Truth::Texture, &[mirror]).full_screen(&[color]));
    sampled.push(mirror);
    for view in 0..2 {
        let step = with_depth(frame, Step::new("scene", IsEye(eye_of(view)), &[color]), depth);
        frame.add(step.meshes(300, &sampled));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("tone-map", FullScreen, &[swapchain]).full_screen(&[color]));
    }
    draw_all_late(frame, textures);
}

/// Hands and lasers over the mapped picture, with the scene's depth.
pub(crate) fn hands_over_picture(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        let color = frame.image("bright", view, size, HDR);
        let mapped = frame.image("mapped", 0, size, LDR);
        frame.add(Step::new("scene", is_eye, &[color]).clears(depth).meshes(300, &sampled));
        frame.add(Step::new("tone-map", FullScreen, &[mapped]).full_screen(&[color]));
        frame.add(Step::new("hands", is_eye, &[mapped]).over().loads(depth).meshes(12, &[]));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("upscale", FullScreen, &[swapchain]).full_screen(&[mapped]));
    }
    draw_all_late(frame, textures);
}

/// A cockpit over the scene, with its depth cleared again.
pub(crate) fn cockpit(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        let color = frame.image("bright", view, size, HDR);
        frame.add(Step::new("scene", is_eye, &[color]).clears(depth).meshes(300, &sampled));
        frame.add(Step::new("cockpit", is_eye, &[color]).over().clears(depth).meshes(40, &sampled));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("tone-map", FullScreen, &[swapchain]).full_screen(&[color]));
    }
    draw_all_late(frame, textures);
}

/// A dome without depth, and the scene over it; a page of the picture's size is composed by the tone mapping.
pub(crate) fn dome(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    let page = frame.image("visor", 0, size, BYTES);
    frame.add(Step::new("visor", Truth::Texture, &[page]).quads(60, &[]).small_meshes(9, 200, &[]));
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        let color = frame.image("bright", view, size, HDR);
        frame.add(Step::new("sky", is_eye, &[color]).meshes(6, &[]));
        frame.add(Step::new("scene", is_eye, &[color]).over().clears(depth).meshes(300, &sampled));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("tone-map", FullScreen, &[swapchain]).full_screen(&[color, page]));
    }
    draw_all_late(frame, textures);
}

/// Numbers of objects beside the colours, for outlines.
pub(crate) fn outlines(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    let numbers = frame.image("numbers", 0, size, vk::Format::R32_UINT);
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        let color = frame.image("bright", view, size, HDR);
        frame.add(Step::new("scene", is_eye, &[color, numbers]).clears(depth).meshes(300, &sampled));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("outlines", FullScreen, &[swapchain]).full_screen(&[color, numbers]));
    }
    draw_all_late(frame, textures);
}

/// A film in each eye, and a panel for a layer of its own.
pub(crate) fn film(frame: &mut Frame<'_>, textures: &[Texture]) {
    let _ = draw_all(frame, textures);
    let side = frame.eye[0];
    let panel = frame.image("panel", 0, [side; 2], BYTES);
    frame.add(Step::new("panel", Truth::Texture, &[panel]).quads(60, &[]).small_meshes(9, 300, &[]));
    for view in 0..2 {
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("film", IsEye(eye_of(view)), &[swapchain]).quads(1, &[]));
    }
}

/// Numbers of triangles, shaded by compute; a last pass reads its picture.
pub(crate) fn visibility_compute(frame: &mut Frame<'_>, textures: &[Texture]) {
    let _ = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    let identity = frame.image("identity", 0, size, IDENTITY);
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        frame.add(Step::new("identity", is_eye, &[identity]).clears(depth).meshes(300, &[]));
        let lit = frame.image("lit", 0, size, HDR);
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("tone-map", FullScreen, &[swapchain]).full_screen(&[lit]));
    }
    draw_all_late(frame, textures);
}

/// An interface of many meshes over the mapped picture, which a last pass brings to the swapchain.
pub(crate) fn interface_over_picture(frame: &mut Frame<'_>, textures: &[Texture]) {
    draw_interface_over_picture(frame, textures, |view| view);
}

/// The same in an image that both eyes share.
pub(crate) fn interface_in_pool(frame: &mut Frame<'_>, textures: &[Texture]) {
    draw_interface_over_picture(frame, textures, |_| 0);
}

/// `number` gives the number of the mapped image of an eye.
fn draw_interface_over_picture(frame: &mut Frame<'_>, textures: &[Texture], number: impl Fn(usize) -> usize) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    for view in 0..2 {
        let color = frame.image("bright", view, size, HDR);
        let mapped = frame.image("mapped", number(view), size, LDR);
        frame.add(Step::new("scene", IsEye(eye_of(view)), &[color]).clears(depth).meshes(300, &sampled));
        frame.add(Step::new("tone-map", FullScreen, &[mapped]).full_screen(&[color]));
        frame.add(Step::new("interface", FullScreen, &[mapped]).over().quads(40, &[]).meshes(12, &[]));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("upscale", FullScreen, &[swapchain]).full_screen(&[mapped]));
    }
    draw_all_late(frame, textures);
}

/// A visor over the picture: a page without depth, composed by the tone mapping, at the size of the scene.
pub(crate) fn visor(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    let page = frame.image("visor", 0, size, BYTES);
    frame.add(Step::new("visor", Truth::Texture, &[page]).quads(60, &[]).small_meshes(9, 200, &[]));
    for view in 0..2 {
        let color = frame.image("bright", view, size, HDR);
        frame.add(Step::new("scene", IsEye(eye_of(view)), &[color]).clears(depth).meshes(300, &sampled));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("tone-map", FullScreen, &[swapchain]).full_screen(&[color, page]));
    }
    draw_all_late(frame, textures);
}
