//! The finished eye buffers of a frame: the Vulkan half measures their contrast.

use super::FrameEnd;
use super::work::Work;
use crate::config::{Config, RatesMode, wants_contrast};
use crate::link::EyeBufferRecord;
use crate::xr::session::{Active, Health};
use crate::xr::submission::{Projection, ProjectionView};
use glam::Quat;
use openxr_sys::Handle;

/// Passes the Vulkan half the new eye buffers of this frame, which our work has written on the session's queue, before their image is the
/// runtime's again; none if their contrast does not count, or no pass gets rates.
///
/// # Safety
///
/// This thread may use the session's queue.
pub unsafe fn notify(frame: &FrameEnd, works: &[Work]) {
    let FrameEnd { active, submission, ref config, .. } = *frame;
    let counts = wants_contrast(config, active.device.is_cpu()) && active.plan.has_rates();
    if !counts || active.health() != Health::Works {
        return;
    }
    let Some(scene) = submission.only_projection() else { return };
    let Some(to_world) = to_world(frame, &scene) else { return };
    for (eye, view) in (0..2).zip(scene.views) {
        let work = works.iter().find(|work| work.swapchain.handle == view.sub_image.swapchain);
        if let Some(record) = work.and_then(|work| record(active, config, eye, view, work, to_world)) {
            // SAFETY: the image lives until its swapchain ends, which is said; it was just written, and is in that layout.
            unsafe { active.device.notify_eye_buffer(&record) };
        }
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

fn record(
    active: &Active,
    config: &Config,
    eye: u32,
    view: &ProjectionView,
    work: &Work,
    to_world: Quat,
) -> Option<EyeBufferRecord> {
    let (image, format, rect) = work.finished(view)?;
    let tangents = view.fov.tangents();
    // The plan's first row is the top.
    if tangents.up < tangents.down {
        return None;
    }
    let plane = tangents.plane([rect.extent.width, rect.extent.height]);
    let (family, index) = active.device.queue;
    Some(EyeBufferRecord {
        eye,
        queue: [family, index],
        swapchain: work.swapchain.handle.into_raw(),
        image,
        format,
        layer: view.sub_image.image_array_index,
        rect: [rect.offset.x as u32, rect.offset.y as u32, rect.extent.width, rect.extent.height],
        plane: [plane.origin.into(), plane.step.into()],
        orientation: (to_world * view.orientation?).into(),
        white_cd_m2: config.rates.white_cd_m2,
        is_mean: u32::from(config.rates.mode == RatesMode::Paper),
    })
}
