//! Direct3D titles by DXVK and vkd3d-proton, and OpenVR titles by xrizer and OpenComposite: the swapchain is written by copies, and
//! all descriptors of vkd3d-proton and most of DXVK are unknown.

use crate::frame_graphs::Arrangement;
use crate::frame_graphs::frame::{
    BYTES, DEPTH, Frame, HDR, Image, LDR, MASK, NORMALS, VELOCITY, eye_of, rect_of,
};
use crate::frame_graphs::step::{Step, Truth::Eye as IsEye, Truth::FullScreen, Truth::Shading};
use crate::frame_graphs::textures::{Texture, draw_all, draw_all_late};
use parafovea::pass_detection::TransferKind;

/// Copies or blits the eye's image to its place in the swapchain.
fn submit(frame: &mut Frame<'_>, view: usize, from: Image) {
    let swapchain = frame.swapchain(view);
    let (x, rect) = match frame.arrangement {
        Arrangement::DoubleWide => (frame.eye[0] as i32 * view as i32, rect_of(frame.eye)),
        _ => (0, rect_of(frame.eye)),
    };
    let to = [x, 0, rect[2], rect[3]];
    let kind = if from.extent == frame.eye { TransferKind::Copy } else { TransferKind::Blit };
    frame.transfer(kind, (from, rect_of(from.extent)), (swapchain, to));
}

/// A Direct3D 11 title with forward rendering: high dynamic range, tone mapping into an image of the game, copied.
pub(crate) fn dxvk_forward(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    for view in 0..2 {
        let color = frame.image("bright", view, size, HDR);
        let extent = frame.eye;
        let mapped = frame.image("eye texture", view, extent, LDR);
        let scene = Step::new("scene", IsEye(eye_of(view)), &[color]).clears(depth);
        frame.add(scene.meshes(700, &sampled));
        frame.add(Step::new("tone-map", FullScreen, &[mapped]).full_screen(&[color]));
        submit(frame, view, mapped);
    }
    draw_all_late(frame, textures);
}

/// A Direct3D 11 title with deferred rendering: a G-buffer, lighting as a full-screen pass without depth, fog, FXAA.
pub(crate) fn dxvk_deferred(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    let buffers = [
        frame.image("albedo", 0, size, BYTES),
        frame.image("normals", 0, size, NORMALS),
        frame.image("material", 0, size, BYTES),
    ];
    let lit = frame.image("lit", 0, size, HDR);
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        let extent = frame.eye;
        let mapped = frame.image("mapped", 0, extent, LDR);
        let smooth = frame.image("eye texture", view, extent, LDR);
        frame.add(Step::new("G-buffer", is_eye, &buffers).clears(depth).meshes(620, &sampled));
        let mut read = buffers.to_vec();
        read.push(depth);
        read.extend(&sampled);
        frame.add(Step::new("lighting", Shading(eye_of(view)), &[lit]).full_screen(&read));
        frame.add(Step::new("forward", is_eye, &[lit]).loads(depth).meshes(40, &sampled));
        frame.add(Step::new("tone-map", FullScreen, &[mapped]).full_screen(&[lit]));
        frame.add(Step::new("FXAA", FullScreen, &[smooth]).full_screen(&[mapped]));
        submit(frame, view, smooth);
    }
    draw_all_late(frame, textures);
}

/// The same with normals of two components and occlusion before lighting.
pub(crate) fn dxvk_deferred_thin(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    let buffers = [frame.image("albedo", 0, size, BYTES), frame.image("octahedral", 0, size, VELOCITY)];
    let occlusion = frame.image("occlusion", 0, size, MASK);
    let lit = frame.image("lit", 0, size, HDR);
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        let extent = frame.eye;
        let mapped = frame.image("eye texture", view, extent, LDR);
        frame.add(Step::new("G-buffer", is_eye, &buffers).clears(depth).meshes(620, &sampled));
        frame.add(Step::new("occlusion", FullScreen, &[occlusion]).full_screen(&[buffers[1], depth]));
        let mut read = buffers.to_vec();
        read.extend([occlusion, depth]);
        frame.add(Step::new("lighting", Shading(eye_of(view)), &[lit]).full_screen(&read));
        frame.add(Step::new("forward", is_eye, &[lit]).over().loads(depth).meshes(40, &sampled));
        frame.add(Step::new("tone-map", FullScreen, &[mapped]).full_screen(&[lit]));
        submit(frame, view, mapped);
    }
    draw_all_late(frame, textures);
}

/// A title that takes its images from a pool in each frame.
pub(crate) fn dxvk_pooled(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    for view in 0..2 {
        let [color, depth] = [HDR, DEPTH].map(|format| frame.fresh(size, format));
        let extent = frame.eye;
        let mapped = frame.fresh(extent, LDR);
        let scene = Step::new("scene", IsEye(eye_of(view)), &[color]).clears(depth);
        frame.add(scene.meshes(700, &sampled));
        frame.add(Step::new("tone-map", FullScreen, &[mapped]).full_screen(&[color]));
        submit(frame, view, mapped);
    }
    draw_all_late(frame, textures);
}

/// An OpenVR title by xrizer: resolved within the pass, its texture copied beside the other eye's.
pub(crate) fn open_vr(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    for view in 0..2 {
        let color = super::multisampled(frame, "eye", 0, size, 1, LDR);
        let depth = super::multisampled(frame, "eye depth", 0, size, 1, DEPTH);
        let texture = frame.image("submitted", view, size, LDR);
        let scene = Step::new("scene", IsEye(eye_of(view)), &[color]).resolves(&[texture]).clears(depth);
        frame.add(scene.meshes(380, &sampled));
        submit(frame, view, texture);
    }
    draw_all_late(frame, textures);
}

/// A title that draws the interface over the mapped picture, in the pass that maps tones; a window shows the left eye.
pub(crate) fn overlay(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.image("depth", 0, size, DEPTH);
    for view in 0..2 {
        let color = frame.image("bright", view, size, HDR);
        let scene = Step::new("scene", IsEye(eye_of(view)), &[color]).clears(depth);
        frame.add(scene.meshes(520, &sampled));
        let swapchain = frame.swapchain(view);
        let step = Step::new("tone-map and interface", FullScreen, &[swapchain]).full_screen(&[color]);
        frame.add(step.quads(30, &[]).small_meshes(4, 120, &[]));
    }
    let window = frame.image("window", 0, [1920, 1080], LDR);
    let left = frame.image("bright", 0, size, HDR);
    frame.add(Step::new("window", FullScreen, &[window]).full_screen(&[left]));
    draw_all_late(frame, textures);
}
