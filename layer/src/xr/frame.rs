//! Frames. The steps at `xrEndFrame`, from top to bottom, are in [`deliver`].

mod complete;
mod debug_view;
mod depth;
mod edit;
mod eye_buffers;
mod history;
mod late;
mod regions;
mod report;
mod work;

pub use complete::sort_ahead;
pub use debug_view::{DebugViews, draw_over_released};
pub use eye_buffers::{ShownEyes, analyze_released};

use debug_view::draws_over_released;
use eye_buffers::analyzes_released;
pub use history::{History, SortedTiles};
use late::{note_views, with_earlier_views};

use super::amended_layers::AmendedLayers;
use super::offer::placed_by_gaze;
use super::session::{self, Active, Health, Session, Tools};
use super::submission::{Layer, Projection, Submission};
use super::vulkan_device::FrameReport;
use super::{plan, swapchain};
use crate::abi::{attempt, guard};
use crate::config::ConfigSnapshot;
use crate::gpu::GpuError;
use crate::kernels::compose::ComposeJob;
use glam::Quat;
use openxr_sys as xr;
use parafovea_core::chroma::Focus;
use smallvec::SmallVec;
use std::cell::{OnceCell, RefCell};
use std::ptr;
use std::sync::Arc;
use std::time::Instant;
use work::{Regions, Work};

/// `xrWaitFrame`. Applies edits of the configuration, as no other work of the frame is urgent then.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn wait(
    handle: xr::Session,
    info: *const xr::FrameWaitInfo,
    state: *mut xr::FrameState,
) -> xr::Result {
    let Some((known, next)) = session::find_with_next(handle) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.wait_frame)(handle, info, state) };
    guard("xrWaitFrame", below, |answer| {
        if let Some(known) = &known {
            let config = &known.instance.config;
            config.watch();
            let sleep = known.active.as_ref().map(|active| &active.plan.sleep);
            if let Some(before) = config.take_edits() {
                edit::report(known, &before);
                if let Some(active) = &known.active {
                    active.plan.config_edited(&before, &config.snapshot());
                }
                if let Some(sleep) = sleep {
                    sleep.wake();
                }
            }
            if !sleep.is_some_and(|sleep| sleep.is_asleep()) {
                let config = config.snapshot();
                if known.active.is_some() || (known.offer.is_some() && config.gaze.offer) {
                    known.gaze.open(&config, known.actions.may_have_gaze(), Instant::now());
                }
            }
        }
        let result = answer.record(below());
        if let (true, Some(active)) =
            (result.into_raw() >= 0, known.as_ref().and_then(|known| known.active.as_ref()))
        {
            // SAFETY: the call succeeded, so `state` is valid.
            let (time, should_render) = unsafe { ((*state).predicted_display_time, (*state).should_render) };
            active.plan.frame_awaited(time, should_render == xr::TRUE);
        }
        result
    })
}

/// `xrBeginFrame`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn begin(handle: xr::Session, info: *const xr::FrameBeginInfo) -> xr::Result {
    let Some((known, next)) = session::find_with_next(handle) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.begin_frame)(handle, info) };
    guard("xrBeginFrame", below, |answer| {
        let active = known.as_ref().and_then(|known| Some((known, known.active.as_ref()?)));
        // Before the call: it lets the xrWaitFrame of the next frame return on another thread.
        let time = active.and_then(|(_, active)| active.plan.awaited());
        let section = known.as_ref().and_then(|known| known.runtime_section());
        let result = answer.record(below());
        drop(section);
        if let (true, Some((known, active)), Some(time)) = (result.into_raw() >= 0, active, time) {
            plan::frame_begun(known, active, time);
        }
        result
    })
}

/// `xrEndFrame`: the application's submission goes to the runtime unchanged, after the runtime's images were
/// written from the application's.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn end(handle: xr::Session, info: *const xr::FrameEndInfo) -> xr::Result {
    let Some((known, next)) = session::find_with_next(handle) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    if let Some(known) = known.as_ref().filter(|known| known.sleeps_through()) {
        // SAFETY: the next layer's function with the application's own arguments.
        let below = || unsafe { (next.end_frame)(handle, info) };
        return guard("xrEndFrame", below, |answer| {
            let _section = known.runtime_section();
            // SAFETY: in xrEndFrame this thread may use the session's queue.
            unsafe { swapchain::release_held(known, true) };
            let result = answer.record(below());
            swapchain::destroy_retired(known);
            result
        });
    }
    let mut placed = None;
    // SAFETY: valid usage: `info` and all structures that it points to are valid.
    attempt("composition layers placed by the gaze", || placed = unsafe { placed_by_gaze(info) });
    let info = placed.as_ref().map_or(info, AmendedLayers::info);
    // SAFETY: the next layer's function with the application's own arguments, or our copy of one.
    let below = |info| unsafe { (next.end_frame)(handle, info) };
    // SAFETY: as above, of a frame without layers: `info` was read, so it is valid.
    let below_empty = || unsafe {
        let empty = xr::FrameEndInfo { layer_count: 0, layers: ptr::null(), ..*info };
        (next.end_frame)(handle, &empty)
    };
    let submit = |delivered| match delivered {
        Ok(Pictures::New) => below(info),
        Ok(Pictures::Late) => {
            let mut earlier = None;
            // SAFETY: valid usage, as above.
            attempt("views of late pictures", || earlier = unsafe { with_earlier_views(handle, info) });
            below(earlier.as_ref().map_or(info, AmendedLayers::info))
        }
        Err(Undeliverable) => below_empty(),
    };
    let active = known.as_ref().and_then(|known| Some((known, known.active.as_ref()?)));
    let read = OnceCell::new();
    let frame = || {
        let (session, active) = active?;
        // SAFETY: valid usage: `info` and all structures that it points to are valid.
        let submission = read.get_or_init(|| unsafe { info.as_ref().map(|info| Submission::read(info)) });
        let (config, heads) = (active.plan.config(), RefCell::default());
        Some(FrameEnd { session, active, config, submission: submission.as_ref()?, heads })
    };
    // After a panic the runtime's images are still written, with the application's images unchanged.
    let pass_on = || {
        let _section = known.as_ref().and_then(|known| known.runtime_section());
        if let Some((session, active)) = active {
            active.worsen_to(Health::CopyOnly);
            // SAFETY: in xrEndFrame this thread may use the session's queue.
            attempt("held images", || unsafe { swapchain::release_held(session, true) });
        }
        let deliver =
            || frame().map_or(Ok(Pictures::New), |frame| deliver(&frame, &mut FrameReport::default()));
        submit(guard("the images of a frame", || Ok(Pictures::Late), |_| deliver()))
    };
    guard("xrEndFrame", pass_on, |answer| {
        let _section = known.as_ref().and_then(|known| known.runtime_section());
        if let Some((session, _)) = active {
            // SAFETY: in xrEndFrame this thread may use the session's queue.
            unsafe { swapchain::release_held(session, false) };
        }
        let result = answer.record(submit(frame().map_or(Ok(Pictures::New), |frame| frame.end())));
        if let Some((session, _)) = active {
            swapchain::destroy_retired(session);
        }
        result
    })
}

/// A frame that ends, of an active session.
struct FrameEnd<'a> {
    session: &'a Session,
    active: &'a Active,
    config: Arc<ConfigSnapshot>,
    submission: &'a Submission,
    /// Orientation of the head in the spaces of its layers, each located once: runtimes may answer in another process.
    heads: RefCell<Heads>,
}

/// Orientation of the head by space; `None` if it is unknown.
type Heads = SmallVec<[(xr::Space, Option<Quat>); 2]>;

impl FrameEnd<'_> {
    /// Orientation of the head in the layer's space at the time that the layer's eye buffers were drawn for.
    fn head_in_layer(&self, layer: &Projection<'_>) -> Option<Quat> {
        let locate = || {
            let mut heads = self.heads.borrow_mut();
            if let Some((_, head)) = heads.iter().find(|(space, _)| *space == layer.space) {
                return *head;
            }
            let head = self.session.head_in(layer.space, self.submission.time);
            heads.push((layer.space, head));
            head
        };
        plan::head_in_layer(&self.config, layer, locate)
    }

    /// Reports the frame to the Vulkan half and to the planner, and delivers its images.
    fn end(&self) -> Result<Pictures, Undeliverable> {
        let Self { session, active, submission, ref config, .. } = *self;
        let time = submission.time;
        session.actions.frame_ended(session, config, time);
        let mut report = active.report();
        report::end_frame(&active.device, submission, active.plan.sleep.take_skipped_ends(), &mut report);
        active.take_over_decisions(report.decisions);
        plan::frame_ended(session, (active, config), time, &report);
        if let Some(scene) = submission.scene() {
            plan::views_shown(session, (active, config), time, &scene, submission.nearest_m());
        }
        let delivered = deliver(self, &mut report);
        eye_buffers::notify_views(self);
        if submission.scene().is_some() {
            plan::report_unseen(session, (active, config), time, &report);
        }
        if let Some(reporter) = session.reporter.as_ref().filter(|reporter| reporter.is_asked()) {
            let mut status = plan::status(session, active, config, &report);
            status.attenuates_colour &= !swapchain::are_all_real(session.handle);
            reporter.report(status, Arc::clone(&config.source));
        }
        plan::fall_asleep(session, (active, config), time, report.untracked_frames);
        delivered
    }
}

/// The runtime's pictures in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pictures {
    /// All are of this frame.
    New,
    /// Some may be of an earlier frame.
    Late,
}

/// Failure to write the runtime's image of a virtual swapchain. The frame then ends without layers, so that the application continues.
/// Swapchains that it creates later are the runtime's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Undeliverable;

/// A frame's work, without allocation for up to eight virtual swapchains.
type Works<'a> = SmallVec<[Work<'a>; 8]>;

// Each is moved about, in every frame, on the application's thread.
const _: () = assert!(size_of::<Work<'_>>() <= 192);

/// Writes the runtime's images from the application's: after each release by the application, and if a gaze-dependent
/// picture is out of date.
///
/// # Errors
///
/// A layer shows a virtual swapchain, whose images cannot be written any more.
fn deliver(frame: &FrameEnd, report: &mut FrameReport) -> Result<Pictures, Undeliverable> {
    let FrameEnd { session, active, submission, ref config, .. } = *frame;
    let swapchains = swapchain::virtual_ones(session.handle);
    active.shown_eyes().note(submission.scene().as_ref());
    debug_view::note_frame(frame, report.frame);
    let is_drawn_over = debug_view::is_wanted(active, config);
    if swapchains.is_empty() {
        active.plan.keep_pictures(false);
        return Ok(Pictures::New);
    }
    let is_virtual = |handle| swapchains.iter().any(|swapchain| swapchain.handle == handle);
    let shows_any = || submission.shows_any(is_virtual);
    let cannot = || if shows_any() { Err(Undeliverable) } else { Ok(Pictures::New) };
    let (Some(tools), Health::Works | Health::CopyOnly) = (active.tools(), active.health()) else {
        active.plan.keep_pictures(false);
        return cannot();
    };
    let _degrade = DegradeOnPanic(active);
    let next = &session.instance.next;

    let mut history = active.plan.history();
    let mut works = Works::new();
    let mut regions = Regions::default();
    works.extend(swapchains.iter().filter_map(|swapchain| Work::begin(swapchain)));
    // Also of images that the runtime has no room for now: re-use reads them later.
    works.iter().for_each(|work| work.ask_layouts(&active.device));
    note_views(submission, &mut works);
    process(frame, tools, &mut works);
    complete::complete(frame, tools, report, &mut works, &mut history, &mut regions);
    works.retain(|work| work.is_due(is_drawn_over));
    let due = works.len();
    works.retain(|work| work.take_image(next));
    let pictures = if works.len() == due { Pictures::New } else { Pictures::Late };
    if works.is_empty() {
        return Ok(pictures);
    }
    if let Err(error) = submit(active, tools, &mut works, &regions) {
        // The device is behind, short of memory, or lost: this frame shows the last pictures, and the next one tries again.
        if error == GpuError::Timeout {
            error.log("the headset shows earlier images until the device catches up");
        } else {
            error.log("the headset shows earlier images, or none, until the device accepts work again");
            tools.gpu.give_up();
        }
        let is_empty = |work: &Work<'_>, handle| work.swapchain.handle == handle && !work.has_picture();
        let shows_empty = submission.shows_any(|handle| works.iter().any(|work| is_empty(work, handle)));
        return if shows_empty { Err(Undeliverable) } else { Ok(Pictures::Late) };
    }
    // SAFETY: in xrEndFrame this thread may use the session's queue; the works' images were just written.
    unsafe { eye_buffers::analyze_written(frame, &works) };
    if is_drawn_over {
        // SAFETY: as above. The debug view is drawn last: no pass of the layer reads it.
        unsafe { debug_view::draw(frame, &works) };
    }
    for work in &mut works {
        work.return_image(next, is_drawn_over);
    }
    Ok(pictures)
}

/// Decides which rectangles of which swapchains are processed, and how.
fn process(frame: &FrameEnd, tools: &Tools, works: &mut Works) {
    let FrameEnd { active, submission, .. } = *frame;
    let mut flat: SmallVec<[xr::SwapchainSubImage; 16]> = SmallVec::new();
    for layer in submission.layers() {
        match layer {
            Layer::Flat(image) => flat.push(image),
            Layer::Cube(_) => {}
            Layer::Projection(layer) => {
                let mut is_virtual = false;
                for work in works.iter_mut().filter(|work| layer.shows(work.swapchain.handle)) {
                    work.is_projected = true;
                    is_virtual = true;
                }
                if is_virtual && active.health() == Health::Works {
                    process_layer(frame, tools, &layer, works);
                }
            }
        }
    }
    for work in works {
        let flat = flat.iter().filter(|image| image.swapchain == work.swapchain.handle);
        regions::drop_contested(&mut work.target.regions, flat);
    }
}

/// Adds the rectangles of a projection layer in which colour is attenuated.
fn process_layer(frame: &FrameEnd, tools: &Tools, layer: &Projection<'_>, works: &mut Works) {
    let FrameEnd { active, .. } = *frame;
    let focuses = active.plan.focuses();
    if focuses.iter().all(Option::is_none) {
        return;
    }
    let Some(head) = frame.head_in_layer(layer) else { return };
    for (index, view) in layer.views.iter().enumerate() {
        let shows = |work: &&mut Work| work.swapchain.handle == view.sub_image.swapchain;
        // Of quad views, the third and fourth are insets of the first two.
        let Some((focus, chroma)) = &focuses[index % 2] else { continue };
        if let Some(work) = works.iter_mut().find(shows)
            && tools.compose().attenuates(work.format())
        {
            work.process(view, Focus { direction: head * focus.direction, ..*focus }, chroma);
        }
    }
}

/// Submits a frame's work. After a failure other than a timeout, submits plain copies, for the rest of the session.
fn submit(active: &Active, tools: &Tools, works: &mut Works, regions: &Regions) -> Result<(), GpuError> {
    let submit = |works: &Works| {
        let mut jobs: SmallVec<[ComposeJob; 8]> = SmallVec::new();
        jobs.extend(works.iter().filter_map(|work| work.job(regions)));
        tools.compose().submit(&jobs)
    };
    submit(works).or_else(|error| {
        if error == GpuError::Timeout {
            return Err(error);
        }
        error.log("re-use, chroma attenuation and debug views are off for this session");
        active.worsen_to(Health::CopyOnly);
        for work in works.iter_mut() {
            work.target.regions.clear();
            (work.reuse, work.changes) = (0..0, 0..0);
        }
        submit(works)
    })
}

/// Lowers the health of the session after a panic, so that the same panic does not recur in every frame.
struct DegradeOnPanic<'a>(&'a Active);

impl Drop for DegradeOnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.worsen_to(match self.0.health() {
                Health::Works => Health::CopyOnly,
                Health::CopyOnly | Health::Stopped => Health::Stopped,
            });
        }
    }
}

/// Whether the layer works on released images of a swapchain.
pub fn uses_released(swapchain: &swapchain::Swapchain) -> bool {
    analyzes_released(swapchain) || draws_over_released(swapchain)
}
