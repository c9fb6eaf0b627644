//! The layer's decisions, drawn over the finished eye buffers if the configuration, or `parafovea status`, asks for that.
//!
//! Pictures of virtual swapchains are drawn over at the end of the frame, once they are written. Pictures of other swapchains are drawn over
//! in the call that returns their image, because the image is the runtime's after it: the places of the eye buffers in it are known from
//! the frame before.

use super::FrameEnd;
use super::eye_buffers::{ShownEye, eyes_of};
use super::regions::{Images, rect_within};
use super::work::Work;
use crate::config::{Config, debug_view};
use crate::gpu::GpuError;
use crate::kernels::compose::RuntimeImages;
use crate::kernels::debug_view::{DebugView, DebugViewJob, DebugViewParams, DebugViewPass, MOST_PICTURES};
use crate::link::RatesCopyRecord;
use crate::planner::DebugOverlay;
use crate::xr::session::{Active, Health};
use crate::xr::swapchain::Swapchain;
use crate::xr::vulkan_device::RatesCopy;
use ash::vk;
use smallvec::SmallVec;
use std::sync::Arc;

/// State of the debug view; its pass is made when it is first asked for.
#[derive(Default)]
pub struct DebugViews {
    pass: Option<DebugViewPass>,
    /// The maps of the eyes.
    maps: [Vec<u8>; 2],
    /// Number of the last frame that showed a scene.
    frame: u64,
    /// The view that was drawn last, and the number of the last frame at that time.
    drawn: Option<(DebugView, u64)>,
    has_failed: bool,
}

/// An eye buffer that is drawn over.
struct EyePicture<'a> {
    eye: usize,
    shown: ShownEye,
    runtime: &'a RuntimeImages,
    runtime_index: u32,
    layout: vk::ImageLayout,
    rect: vk::Rect2D,
}

/// Number of frames that may end without a drawing: an application may draw ahead.
const MISSED_FRAMES: u64 = 2;

impl DebugViews {
    /// Whether `view` was drawn over the last pictures; `frames`: number of ended frames.
    pub fn is_drawn(&self, view: DebugView, frames: u64) -> bool {
        self.drawn.is_some_and(|(drawn, by)| drawn == view && frames.saturating_sub(by) <= MISSED_FRAMES)
    }
}

/// Whether anything is to be drawn over pictures. Frees the objects for it once it is no longer asked for.
pub fn is_wanted(active: &Active, config: &Config) -> bool {
    let is_asked = debug_view(config).is_some();
    let mut views = active.debug_views();
    if !is_asked && (views.pass.is_some() || views.drawn.is_some()) {
        let pass = views.pass.take();
        views.drawn = None;
        drop(views);
        drop(pass);
        return false;
    }
    is_asked && !views.has_failed && active.health() == Health::Works
}

/// Notes the number of a frame that shows a scene.
pub fn note_frame(frame: &FrameEnd, number: u64) {
    let FrameEnd { active, submission, ref config, .. } = *frame;
    if debug_view(config).is_some() && submission.scene().is_some() {
        active.debug_views().frame = number;
    }
}

/// Draws over the eye buffers that were written in this frame.
///
/// # Safety
///
/// This thread may use the session's queue.
pub unsafe fn draw(frame: &FrameEnd, works: &[Work]) {
    let FrameEnd { session, active, submission, ref config, .. } = *frame;
    let Some(scene) = submission.scene() else { return };
    let pictures = eyes_of(&scene).into_iter().enumerate().filter_map(|(eye, shown)| {
        let shown = shown?;
        let work = works.iter().find(|work| work.swapchain.handle == shown.sub_image.swapchain)?;
        let (runtime, runtime_index, rect) = work.written(&shown.sub_image)?;
        let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
        Some(EyePicture { eye, shown, runtime, runtime_index, layout, rect })
    });
    // SAFETY: this thread may use the live queue, as `# Safety` demands.
    unsafe { draw_over(active, config, session.gaze.dot_deg(), pictures.collect()) };
}

/// Whether a debug view is drawn over released images of a swapchain.
pub fn draws_over_released(swapchain: &Swapchain) -> bool {
    let Some(active) = &swapchain.session().active else { return false };
    let config = active.plan.config();
    debug_view(&config).is_some()
        && is_wanted(active, &config)
        && active.shown_eyes().of(swapchain.handle).iter().any(Option::is_some)
}

/// Draws over the eye buffers in the image of that number, which is about to be returned to the runtime.
///
/// # Safety
///
/// This thread may use the session's queue; the application's draws to the image are submitted.
pub unsafe fn draw_over_released(swapchain: &Swapchain, index: u32) {
    let session = swapchain.session();
    let Some(active) = session.active.as_ref().filter(|_| draws_over_released(swapchain)) else { return };
    let config = active.plan.config();
    let shown = active.shown_eyes().of(swapchain.handle);
    let Some(tools) = active.tools() else { return };
    let _degrade = super::DegradeOnPanic(active);
    let (extent, array_layers) = swapchain.extent_and_layers();
    swapchain.draw_over(&tools.gpu, |runtime| {
        let pictures = shown.into_iter().enumerate().filter_map(|(eye, shown)| {
            let shown = shown?;
            let rect = rect_within(&shown.sub_image, &Images { extent, array_layers, is_unit_range: true })?;
            // Direct3D's are left as they were used last.
            let layout = active.device.layout(*runtime.images().get(index as usize)?);
            Some(EyePicture { eye, shown, runtime, runtime_index: index, layout, rect })
        });
        // SAFETY: this thread may use the queue, and work that draws to the image is submitted, as `# Safety` demands.
        unsafe { draw_over(active, &config, session.gaze.dot_deg(), pictures.collect()) };
    });
}

/// Draws over pictures; the dot of debug view "ahead" is `dot_deg` to the left of and above the forward direction.
///
/// # Safety
///
/// This thread may use the session's queue.
unsafe fn draw_over(
    active: &Active,
    config: &Config,
    dot_deg: [f32; 2],
    mut pictures: SmallVec<[EyePicture<'_>; MOST_PICTURES]>,
) {
    let Some(view) = debug_view(config) else { return };
    let is_same = |one: &EyePicture, other: &EyePicture| {
        let (one, other) = (&one.shown.sub_image, &other.shown.sub_image);
        one.swapchain == other.swapchain
            && one.image_array_index == other.image_array_index
            && one.image_rect == other.image_rect
    };
    // One picture for both eyes is drawn over once.
    pictures.dedup_by(|other, one| is_same(one, other));
    let mut views = active.debug_views();
    let DebugViews { pass, maps, frame, drawn, has_failed, .. } = &mut *views;
    let seen: [Option<DebugOverlay>; 2] = {
        let planner = active.plan.planner();
        [0, 1].map(|eye| planner.seen(config, eye, view, dot_deg, &mut maps[eye]))
    };
    // SAFETY: this thread may use the live queue, as `# Safety` demands.
    match unsafe { draw_eyes(active, pass, view, &pictures, seen, maps) } {
        Ok(true) => *drawn = Some((view, *frame)),
        // The device is behind: this frame has no overlay.
        Ok(false) | Err(GpuError::Timeout) => {}
        Err(error) => {
            *has_failed = true;
            error.log("debug.view is off for this session");
        }
    }
}

/// Whether anything was drawn.
///
/// # Safety
///
/// This thread may use the session's queue.
unsafe fn draw_eyes(
    active: &Active,
    pass: &mut Option<DebugViewPass>,
    view: DebugView,
    pictures: &[EyePicture<'_>],
    seen: [Option<DebugOverlay>; 2],
    maps: &[Vec<u8>; 2],
) -> Result<bool, GpuError> {
    let Some(tools) = active.tools() else { return Ok(false) };
    let pass = match pass {
        Some(pass) => pass,
        none => none.insert(DebugViewPass::new(Arc::clone(&tools.gpu))?),
    };
    let mut jobs: SmallVec<[DebugViewJob; MOST_PICTURES]> = SmallVec::new();
    let most = maps.iter().map(Vec::len).max().unwrap_or(0) as u32;
    for picture in pictures {
        let EyePicture { eye, shown, runtime, runtime_index, layout, rect } = *picture;
        let Some(seen) = seen[eye] else { continue };
        let offset = [rect.offset.x as u32, rect.offset.y as u32];
        let extent = [rect.extent.width, rect.extent.height];
        let params = DebugViewParams::new(view, offset, extent, shown.fov, seen.gaze, &seen.shape);
        if params.drawn().is_none() {
            continue;
        }
        let (buffer, offset) = pass.place(eye, most)?;
        let (family, index) = active.device.queue;
        let copy = RatesCopyRecord {
            eye: eye as u32,
            queue: [family, index],
            tiles: seen.shape.tiles,
            buffer,
            offset,
        };
        let is_decided = view == DebugView::Rates && seen.is_decided_on_gpu;
        // SAFETY: this thread may use the live queue, as `# Safety` demands; the buffer has room for the map, and is kept until work that is submitted below
        // has finished.
        let made = if is_decided { unsafe { active.device.copy_rates(&copy) } } else { RatesCopy::OfPlan };
        let map = match made {
            RatesCopy::OfPlan => Some(&*maps[eye]),
            RatesCopy::Submitted => {
                pass.copied(eye, seen.shape.tiles);
                None
            }
            // The last copy has the rates that were decided shortly before.
            RatesCopy::LeftOut if pass.has_copy(eye, seen.shape.tiles) => None,
            RatesCopy::LeftOut => continue,
        };
        let array_layer = shown.sub_image.image_array_index;
        jobs.push(DebugViewJob { eye, runtime, runtime_index, array_layer, layout, params, map });
    }
    Ok(!jobs.is_empty() && pass.submit(&jobs)?)
}
