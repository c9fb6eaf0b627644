//! Unity: the Universal and the High Definition Render Pipeline (packages com.unity.render-pipelines.universal 14 and
//! .high-definition 14, `ScriptableRenderer` and `HDRenderPipeline`).

use super::multisampled;
use crate::frame_graphs::frame::{BYTES, DEPTH, Frame, HDR, NORMALS, PACKED, VELOCITY, eye_of, scaled};
use crate::frame_graphs::step::{Step, Truth::Eye as IsEye, Truth::FullScreen};
use crate::frame_graphs::textures::{Texture, draw_all, draw_all_late};
use parafovea::pass_detection::TransferKind;

/// URP, multi-pass: the whole of the pipeline for each eye, in images of a pool that both eyes share. An opaque copy for refraction.
pub(crate) fn urp_multi_pass(frame: &mut Frame<'_>, textures: &[Texture]) {
    let mut sampled = draw_all(frame, textures);
    let size = frame.size();
    let color = frame.image("_CameraColorAttachmentA", 0, size, PACKED);
    let depth = frame.image("_CameraDepthAttachment", 0, size, DEPTH);
    let opaque = frame.image("_CameraOpaqueTexture", 0, scaled(size, 0.5), PACKED);
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        frame.add(Step::new("opaque", is_eye, &[color]).clears(depth).meshes(420, &sampled));
        frame.add(Step::new("copy colour", FullScreen, &[opaque]).full_screen(&[color]));
        sampled.push(opaque);
        frame.add(Step::new("transparent", is_eye, &[color]).loads(depth).meshes(35, &sampled));
        sampled.pop();
        let swapchain = frame.swapchain(view);
        let post = Step::new("uber post", FullScreen, &[swapchain]).full_screen(&[color]);
        frame.add(if frame.arrangement == crate::frame_graphs::Arrangement::Array {
            post.layer(view as u32)
        } else {
            post
        });
    }
    draw_all_late(frame, textures);
}

/// URP, multi-pass, where the opaque copy is a copy, made and read by both eyes, and bound in opaque draws too.
pub(crate) fn urp_copied(frame: &mut Frame<'_>, textures: &[Texture]) {
    let mut sampled = draw_all(frame, textures);
    let size = frame.size();
    let color = frame.image("_CameraColorAttachmentA", 0, size, PACKED);
    let depth = frame.image("_CameraDepthAttachment", 0, size, DEPTH);
    let opaque = frame.image("_CameraOpaqueTexture", 0, size, PACKED);
    sampled.push(opaque);
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        frame.add(Step::new("opaque", is_eye, &[color]).clears(depth).meshes(420, &sampled));
        frame.copy(color, opaque);
        frame.add(Step::new("transparent", is_eye, &[color]).over().loads(depth).meshes(35, &sampled));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("uber post", FullScreen, &[swapchain]).full_screen(&[color]));
    }
    draw_all_late(frame, textures);
}

/// URP, single-pass instanced: arrays of two, with bloom.
pub(crate) fn urp_instanced(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let color = frame.array("_CameraColorAttachmentA", size, PACKED);
    let depth = frame.array("_CameraDepthAttachment", size, DEPTH);
    frame.add(Step::new("opaque", IsEye(None), &[color]).clears(depth).meshes(420, &sampled));
    frame.add(Step::new("transparent", IsEye(None), &[color]).loads(depth).meshes(30, &sampled));
    let mut from = color;
    for (level, name) in ["bloom 0", "bloom 1", "bloom 2"].into_iter().enumerate() {
        let to = frame.array(name, scaled(size, 0.5 / (1 << level) as f32), PACKED);
        frame.add(Step::new("bloom", FullScreen, &[to]).full_screen(&[from]));
        from = to;
    }
    let swapchain = frame.swapchain(0);
    frame.add(Step::new("uber post", FullScreen, &[swapchain]).full_screen(&[color, from]));
    draw_all_late(frame, textures);
}

/// URP with multisampling, straight into an array swapchain without post-processing.
pub(crate) fn urp_direct(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.eye;
    let color = multisampled(frame, "multisampled", 0, size, 2, BYTES);
    let depth = multisampled(frame, "multisampled depth", 0, size, 2, DEPTH);
    let swapchain = frame.swapchain(0);
    let scene = Step::new("scene", IsEye(None), &[color]).resolves(&[swapchain]);
    frame.add(scene.clears(depth).meshes(260, &sampled));
    draw_all_late(frame, textures);
}

/// HDRP, deferred, single-pass instanced: a depth pre-pass, a G-buffer of four, lighting in compute, transparents, a colour pyramid,
/// post-processing in compute, and a final pass.
pub(crate) fn hdrp(frame: &mut Frame<'_>, textures: &[Texture]) {
    let mut sampled = draw_all(frame, textures);
    let size = frame.size();
    let depth = frame.array("CameraDepthStencil", size, DEPTH);
    let velocity = frame.array("Motion Vectors", size, VELOCITY);
    let buffers = [
        frame.array("GBuffer0", size, BYTES),
        frame.array("GBuffer1", size, NORMALS),
        frame.array("GBuffer2", size, BYTES),
        frame.array("GBuffer3", size, PACKED),
    ];
    // Written by compute: lighting.
    let color = frame.array("CameraColor", size, PACKED);
    frame.add(Step::depth_only("depth pre-pass", IsEye(None), depth).meshes(130, &[]));
    frame.add(Step::new("G-buffer", IsEye(None), &buffers).loads(depth).meshes(380, &sampled));
    frame.add(Step::new("motion vectors", IsEye(None), &[velocity]).loads(depth).meshes(40, &[]));
    frame.add(Step::new("forward opaque", IsEye(None), &[color]).loads(depth).meshes(45, &sampled));
    let pyramid = frame.array("ColorPyramid", size, PACKED);
    frame.copy(color, pyramid);
    sampled.push(pyramid);
    frame.add(Step::new("transparent", IsEye(None), &[color]).loads(depth).meshes(28, &sampled));
    // Written by compute: post-processing.
    let graded = frame.array("Post", size, HDR);
    let swapchain = frame.swapchain(0);
    frame.add(Step::new("final", FullScreen, &[swapchain]).full_screen(&[graded]));
    draw_all_late(frame, textures);
}

/// The built-in pipeline with an image effect between opaque and transparent draws, blitted back; in images that both eyes share.
pub(crate) fn effects_between(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    let color = frame.image("eye", 0, size, HDR);
    let depth = frame.image("eye depth", 0, size, DEPTH);
    let effect = frame.image("effect", 0, size, HDR);
    for view in 0..2 {
        let is_eye = IsEye(eye_of(view));
        frame.add(Step::new("opaque", is_eye, &[color]).clears(depth).meshes(510, &sampled));
        frame.add(Step::new("fog", FullScreen, &[effect]).full_screen(&[color, depth]));
        frame.add(Step::new("blit", FullScreen, &[color]).full_screen(&[effect]));
        frame.add(Step::new("transparent", is_eye, &[color]).over().loads(depth).meshes(30, &sampled));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("grading", FullScreen, &[swapchain]).full_screen(&[color]));
    }
    draw_all_late(frame, textures);
}

/// The built-in pipeline, multi-pass with multisampling: resolved by vkCmdResolveImage, then image effects in full-screen passes.
pub(crate) fn built_in(frame: &mut Frame<'_>, textures: &[Texture]) {
    let sampled = draw_all(frame, textures);
    let size = frame.size();
    for view in 0..2 {
        let color = multisampled(frame, "eye", 0, size, 1, HDR);
        let depth = multisampled(frame, "eye depth", 0, size, 1, DEPTH);
        let resolved = frame.image("resolved", 0, size, HDR);
        let graded = frame.image("graded", 0, size, BYTES);
        let scene = Step::new("scene", IsEye(eye_of(view)), &[color]).clears(depth);
        frame.add(scene.meshes(510, &sampled));
        let rect = crate::frame_graphs::frame::rect_of(size);
        frame.transfer(TransferKind::Resolve, (color, rect), (resolved, rect));
        frame.add(Step::new("grading", FullScreen, &[graded]).full_screen(&[resolved]));
        let swapchain = frame.swapchain(view);
        frame.add(Step::new("blit", FullScreen, &[swapchain]).full_screen(&[graded]));
    }
    draw_all_late(frame, textures);
}
