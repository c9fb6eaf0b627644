//! What is decided, drawn over the finished pictures of the eyes where the configuration asks for that.

use super::layers::{self, Projection, Shown};
use super::regions::fov;
use super::work::Work;
use crate::config::debug_view;
use crate::gpu::GpuError;
use crate::link::RatesCopyRecord;
use crate::passes::debug_view::{DebugView, DebugViewJob, DebugViewParams, DebugViewPass, MOST_PICTURES};
use crate::planning::Seen;
use crate::xr::session::{Active, Health, Session};
use crate::xr::swapchain::Swapchain;
use openxr_sys as xr;
use smallvec::SmallVec;
use std::sync::Arc;

/// What draws, made when it is first asked for.
#[derive(Default)]
pub struct DebugViews {
    pass: Option<DebugViewPass>,
    /// The maps of the eyes.
    maps: [Vec<u8>; 2],
    has_failed: bool,
    has_told: bool,
}

/// Says once of a session that a picture is not drawn over, because its swapchain is not virtual.
///
/// # Safety
///
/// `info` and what it points to are valid, as `xrEndFrame` demands.
pub unsafe fn tell_left_out(
    session: &Session,
    active: &Active,
    info: &xr::FrameEndInfo,
    swapchains: &[Arc<Swapchain>],
) {
    if debug_view(&session.instance.config.get()).is_none() {
        return;
    }
    let is_virtual = |handle| swapchains.iter().any(|swapchain| swapchain.handle == handle);
    // SAFETY: the caller vouches for `info`.
    let Some(scene) = (unsafe { first_projection(info) }) else { return };
    let mut views = active.debug_views();
    if !views.has_told && scene.views.iter().any(|view| !is_virtual(view.sub_image.swapchain)) {
        views.has_told = true;
        tracing::warn!(
            "debug.view is not drawn: the swapchain of a picture has no images of ours, because it was made before \
             they were needed, or cannot have them; where nothing above says so, start the application anew"
        );
    }
}

/// Draws over the pictures of the eyes that were written in this frame.
///
/// # Safety
///
/// As for [`tell_left_out`]; this thread may use the session's queue.
pub unsafe fn draw(session: &Session, active: &Active, info: &xr::FrameEndInfo, works: &[Work]) {
    let config = session.instance.config.get();
    let Some(view) = debug_view(&config) else {
        // What was made for it goes when it is not asked for any more.
        active.debug_views().pass = None;
        return;
    };
    let mut views = active.debug_views();
    let DebugViews { pass, maps, has_failed, .. } = &mut *views;
    if *has_failed || active.health() != Health::Works {
        return;
    }
    // SAFETY: the caller vouches for `info`.
    let Some(scene) = (unsafe { first_projection(info) }) else { return };
    let seen: [Option<Seen>; 2] = {
        let planning = active.plan.planning();
        [0, 1].map(|eye| planning.seen(&config, eye, view, &mut maps[eye]))
    };
    // SAFETY: the caller vouches for the queue.
    let drawn = unsafe { draw_eyes(active, pass, view, &scene, seen, maps, works) };
    match drawn {
        Ok(()) => {}
        // The device is behind: this frame goes without.
        Err(GpuError::Timeout) => {}
        Err(error) => {
            *has_failed = true;
            tracing::error!("debug.view is off for this session: {error}");
        }
    }
}

/// # Safety
///
/// This thread may use the session's queue.
unsafe fn draw_eyes(
    active: &Active,
    pass: &mut Option<DebugViewPass>,
    view: DebugView,
    scene: &Projection<'_>,
    seen: [Option<Seen>; 2],
    maps: &[Vec<u8>; 2],
    works: &[Work],
) -> Result<(), GpuError> {
    let Some(tools) = active.tools() else { return Ok(()) };
    let pass = match pass {
        Some(pass) => pass,
        none => none.insert(DebugViewPass::new(Arc::clone(&tools.gpu))?),
    };
    let mut jobs: SmallVec<[DebugViewJob; MOST_PICTURES]> = SmallVec::new();
    let most = maps.iter().map(Vec::len).max().unwrap_or(0) as u32;
    for (eye, (seen, shown)) in seen.iter().zip(scene.views).enumerate() {
        let work = works.iter().find(|work| work.swapchain.handle == shown.sub_image.swapchain);
        let (Some(seen), Some(work)) = (seen, work) else { continue };
        let is_same = |first: &xr::CompositionLayerProjectionView| {
            let (one, other) = (&first.sub_image, &shown.sub_image);
            one.swapchain == other.swapchain
                && one.image_array_index == other.image_array_index
                && one.image_rect == other.image_rect
        };
        // One picture for both eyes is drawn over once.
        if scene.views[..eye].iter().any(is_same) {
            continue;
        }
        let params = |rect: ash::vk::Rect2D| {
            let offset = [rect.offset.x as u32, rect.offset.y as u32];
            let extent = [rect.extent.width, rect.extent.height];
            DebugViewParams::new(view, offset, extent, fov(shown), seen.gaze, &seen.shape)
        };
        let job = work.shown_with(shown, params).filter(|job| job.params.drawn().is_some());
        let Some(job) = job else { continue };
        let (buffer, offset) = pass.place(jobs.len(), most)?;
        let (family, index) = active.device.queue;
        let copy = RatesCopyRecord {
            eye: eye as u32,
            queue: [family, index],
            tiles: seen.shape.tiles,
            buffer,
            offset,
        };
        // SAFETY: the caller vouches for the queue; the buffer has room for the map, and is kept until work that is submitted below
        // has finished.
        let is_copied =
            view == DebugView::Rates && seen.is_decided_on_gpu && unsafe { active.device.copy_rates(&copy) };
        jobs.push(DebugViewJob { map: (!is_copied).then_some(&maps[eye]), ..job });
    }
    if jobs.is_empty() { Ok(()) } else { pass.submit(&jobs) }
}

/// The projection layer that is the scene.
///
/// # Safety
///
/// As for [`tell_left_out`].
unsafe fn first_projection(info: &xr::FrameEndInfo) -> Option<Projection<'_>> {
    // SAFETY: the caller vouches for `info`.
    unsafe { layers::of(info) }.find_map(|shown| match shown {
        Shown::Projection(layer) => Some(layer),
        Shown::Flat(_) | Shown::Cube(_) => None,
    })
}
