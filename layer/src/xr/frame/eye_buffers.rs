//! The finished eye buffers of a frame: the Vulkan half measures their contrast.
//!
//! Pictures of virtual swapchains are analysed at the end of the frame, once they are written. Pictures of other swapchains are analysed in
//! the call that returns their image, because the image is the runtime's after it: their places are known from the frames before.

use super::FrameEnd;
use super::regions::{Images, rect_within};
use super::work::Work;
use crate::config::{Config, RatesMode, wants_contrast};
use crate::link::{EyeBufferRecord, EyeViewRecord};
use crate::xr::session::{Active, Health};
use crate::xr::submission::Projection;
use crate::xr::swapchain::Swapchain;
use ash::vk;
use glam::Quat;
use openxr_sys as xr;
use openxr_sys::Handle;
use parafovea_core::geometry::Fov;
use std::mem;

/// The eye buffers of the last two frames: an application may draw to two swapchains in turn.
#[derive(Default)]
pub struct ShownEyes {
    last: [Option<ShownEye>; 2],
    before: [Option<ShownEye>; 2],
}

/// Place of an eye buffer, and its field of view.
#[derive(Clone, Copy)]
pub struct ShownEye {
    /// Swapchain, rectangle and array layer.
    pub sub_image: xr::SwapchainSubImage,
    /// Field of view.
    pub fov: Fov,
}

impl ShownEyes {
    /// A frame ended with this layer.
    pub fn note(&mut self, scene: &Projection<'_>) {
        self.before = mem::replace(&mut self.last, eyes_of(scene));
    }

    /// The eye buffers that a swapchain had in the newest of these frames that showed it.
    pub fn of(&self, swapchain: xr::Swapchain) -> [Option<ShownEye>; 2] {
        let of = |eyes: [Option<ShownEye>; 2]| {
            eyes.map(|eye| eye.filter(|eye| eye.sub_image.swapchain == swapchain))
        };
        let last = of(self.last);
        if last.iter().any(Option::is_some) { last } else { of(self.before) }
    }
}

/// The eye buffers of a projection layer.
pub fn eyes_of(scene: &Projection<'_>) -> [Option<ShownEye>; 2] {
    [0, 1].map(|eye| {
        let view = scene.views.get(eye)?;
        Some(ShownEye { sub_image: view.sub_image, fov: view.fov })
    })
}

/// Whether the contrast of pictures counts: the configuration asks for it, and passes get rates.
fn counts(active: &Active, config: &Config) -> bool {
    wants_contrast(config, active.device.is_cpu())
        && active.plan.has_rates()
        && active.health() == Health::Works
}

/// Has the eye buffers analysed that our work of this frame has written on the session's queue, before their image is the runtime's again.
///
/// # Safety
///
/// This thread may use the session's queue.
pub unsafe fn analyze_written(frame: &FrameEnd, works: &[Work]) {
    let FrameEnd { active, submission, ref config, .. } = *frame;
    let Some(scene) = submission.only_projection().filter(|_| counts(active, config)) else { return };
    for (eye, view) in (0..2).zip(scene.views) {
        let work = works.iter().find(|work| work.swapchain.handle == view.sub_image.swapchain);
        if let Some((image, format, rect)) = work.and_then(|work| work.finished(view)) {
            // SAFETY: the image lives until its swapchain ends, which is said; it was just written, and is in that layout.
            unsafe { analyze(active, config, eye, &view.sub_image, (image, format, rect)) };
        }
    }
}

/// Has the eye buffers analysed that are in the image that the application is about to return to the runtime.
///
/// # Safety
///
/// This thread may use the session's queue; the application's draws to the image that `swapchain` returns next are submitted.
pub unsafe fn analyze_released(swapchain: &Swapchain) {
    let Some(active) = &swapchain.session().active else { return };
    let config = active.plan.config();
    if !counts(active, &config) {
        return;
    }
    let _degrade = super::DegradeOnPanic(active);
    let shown = active.shown_eyes().of(swapchain.handle);
    let Some((image, format)) = swapchain.readable_image().filter(|_| shown.iter().any(Option::is_some))
    else {
        return;
    };
    let (extent, array_layers) = swapchain.extent_and_layers();
    for (eye, shown) in (0..2).zip(shown) {
        let Some(ShownEye { sub_image, .. }) = shown else { continue };
        if let Some(rect) = rect_within(&sub_image, &Images { extent, array_layers, is_unit_range: true }) {
            // SAFETY: the image lives until its swapchain ends, which is said; this thread may use the queue, to which the draws to the
            // image were submitted, as `# Safety` demands.
            unsafe { analyze(active, &config, eye, &sub_image, (image, format, rect)) };
        }
    }
}

/// # Safety
///
/// This thread may use the session's queue, on which the image was written; the image lives until its swapchain ends.
unsafe fn analyze(
    active: &Active,
    config: &Config,
    eye: u32,
    sub_image: &xr::SwapchainSubImage,
    (image, format, rect): (vk::Image, vk::Format, vk::Rect2D),
) {
    let (family, index) = active.device.queue;
    let record = EyeBufferRecord {
        eye,
        queue: [family, index],
        swapchain: sub_image.swapchain.into_raw(),
        image,
        format,
        layer: sub_image.image_array_index,
        rect: pixels(rect),
        white_cd_m2: config.rates.white_cd_m2,
        is_mean: u32::from(config.rates.mode == RatesMode::Paper),
    };
    // SAFETY: as `# Safety` demands.
    unsafe { active.device.analyze_eye_buffer(&record) };
}

/// Sends the views in which this frame shows eye buffers: the contrast of their pictures counts from now on.
pub fn notify_views(frame: &FrameEnd) {
    let FrameEnd { active, submission, ref config, .. } = *frame;
    let Some(scene) = submission.only_projection().filter(|_| counts(active, config)) else { return };
    let Some(to_world) = to_world(frame, &scene) else { return };
    for (eye, view) in (0..2).zip(scene.views) {
        let tangents = view.fov.tangents();
        let xr::Rect2Di { offset, extent } = view.sub_image.image_rect;
        let rect = [offset.x, offset.y, extent.width, extent.height].map(u32::try_from);
        let ([Ok(x), Ok(y), Ok(width), Ok(height)], Some(orientation)) = (rect, view.orientation) else {
            continue;
        };
        // The plan's first row is the top.
        if tangents.up < tangents.down {
            continue;
        }
        let plane = tangents.plane([width, height]);
        active.device.notify_eye_view(&EyeViewRecord {
            eye,
            swapchain: view.sub_image.swapchain.into_raw(),
            layer: view.sub_image.image_array_index,
            rect: [x, y, width, height],
            plane: [plane.origin.into(), plane.step.into()],
            orientation: (to_world * orientation).into(),
        });
    }
}

/// From the space of a layer to one that rests in the world: as the head is turned in both. The plan of the frame has located it in the
/// world.
fn to_world(frame: &FrameEnd, scene: &Projection<'_>) -> Option<Quat> {
    let time = frame.submission.time;
    let in_layer = frame.head_in_layer(scene)?;
    let planned = frame.active.plan.planner().head_at(time.as_nanos());
    Some(planned.unwrap_or_else(|| frame.session.head_in_world(time)) * in_layer.inverse())
}

fn pixels(rect: vk::Rect2D) -> [u32; 4] {
    [rect.offset.x as u32, rect.offset.y as u32, rect.extent.width, rect.extent.height]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xr::submission::ProjectionView;
    use glam::Vec3;
    use parafovea_core::geometry::Fov;

    fn view(swapchain: u64, layer: u32) -> ProjectionView {
        let extent = xr::Extent2Di { width: 8, height: 8 };
        let image_rect = xr::Rect2Di { offset: xr::Offset2Di { x: 0, y: 0 }, extent };
        let swapchain = xr::Swapchain::from_raw(swapchain);
        ProjectionView {
            orientation: Some(Quat::IDENTITY),
            position_m: Vec3::ZERO,
            fov: Fov { left: -0.7, right: 0.7, up: 0.7, down: -0.7 },
            sub_image: xr::SwapchainSubImage { swapchain, image_rect, image_array_index: layer },
            depth: None,
        }
    }

    fn layers_of(shown: &ShownEyes, swapchain: u64) -> [Option<u32>; 2] {
        let eyes = shown.of(xr::Swapchain::from_raw(swapchain));
        eyes.map(|eye| Some(eye?.sub_image.image_array_index))
    }

    #[test]
    fn eye_buffers_of_swapchains_in_turn_are_known() {
        let mut shown = ShownEyes::default();
        let mut show = |views: &[ProjectionView]| {
            shown.note(&Projection { space: xr::Space::NULL, views });
            [1, 2].map(|swapchain| layers_of(&shown, swapchain))
        };
        let nothing = [None; 2];
        assert_eq!(show(&[view(1, 0), view(1, 1)]), [[Some(0), Some(1)], nothing]);
        assert_eq!(show(&[view(2, 2), view(2, 3)]), [[Some(0), Some(1)], [Some(2), Some(3)]]);
        // The newest frame counts.
        assert_eq!(show(&[view(1, 4), view(2, 5)]), [[Some(4), None], [None, Some(5)]]);
        // A swapchain that is not shown any more is not analysed any more.
        assert_eq!(show(&[view(1, 0), view(1, 1)])[1], [None, Some(5)]);
        assert_eq!(show(&[view(1, 0), view(1, 1)]), [[Some(0), Some(1)], nothing]);
        assert_eq!(show(&[]), [[Some(0), Some(1)], nothing]);
    }
}
