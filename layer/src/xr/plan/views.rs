//! Planning at the views that the application locates and shows.

use super::work::{FrameTask, PlanInputs, follow};
use super::{LaterViews, SessionPlan};
use crate::abi::guard;
use crate::config::{Config, ConfigSnapshot, GazeSource, wants_reuse};
use crate::inputs::gaze::rotation;
use crate::planner::{ShownView, View, head_of};
use crate::xr::offer::GazeSpace;
use crate::xr::session::{self, Active, Health, Session, Tools};
use crate::xr::spaces::{Precedence, rests};
use crate::xr::submission::{self, Projection};
use glam::{Quat, Vec3};
use openxr_sys as xr;
use openxr_sys::Handle;
use smallvec::SmallVec;
use std::ptr;
use std::sync::Arc;

/// `xrLocateViews`: the views that the application will draw, and with them the newest gaze.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn locate_views(
    handle: xr::Session,
    info: *const xr::ViewLocateInfo,
    state: *mut xr::ViewState,
    capacity: u32,
    count: *mut u32,
    views: *mut xr::View,
) -> xr::Result {
    let Some((known, next)) = session::find_with_next(handle) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own arguments, or our copy of one.
    let below = |info| unsafe { (next.locate_views)(handle, info, state, capacity, count, views) };
    let pass_through = || below(info);
    guard("xrLocateViews", pass_through, |answer| {
        if known.as_ref().is_some_and(|known| known.is_asleep()) {
            return answer.record(below(info));
        }
        // SAFETY: valid usage: `info` is valid.
        let asked = unsafe { info.as_ref() };
        // An application that locates its views in the space of the gaze.
        let base = asked.and_then(|asked| GazeSpace::find(asked.space));
        let in_head =
            asked.zip(base.as_ref()).map(|(asked, base)| xr::ViewLocateInfo { space: base.head(), ..*asked });
        let info = in_head.as_ref().map_or(info, ptr::from_ref);
        let result = answer.record(below(info));
        let active = known.as_ref().and_then(|known| Some((known, known.active.as_ref()?)));
        if let (true, Some((known, active))) = (result.into_raw() >= 0, active) {
            // SAFETY: the call succeeded: its arguments are valid, and as many views were written as `count` states.
            unsafe {
                if let (Some(info), Some(state), Some(count)) =
                    (info.as_ref(), state.as_ref(), count.as_ref())
                {
                    let is_valid = state.view_state_flags.contains(xr::ViewStateFlags::ORIENTATION_VALID);
                    if is_valid && !views.is_null() && *count <= capacity {
                        let views = std::slice::from_raw_parts(views, *count as usize);
                        views_located(known, active, info, views);
                    }
                }
            }
        }
        if let (true, Some(base)) = (result.into_raw() >= 0, &base) {
            // SAFETY: as above.
            unsafe {
                if let (Some(info), Some(state), Some(count)) =
                    (info.as_ref(), state.as_mut(), count.as_ref())
                    && !views.is_null()
                    && *count <= capacity
                {
                    let views = std::slice::from_raw_parts_mut(views, *count as usize);
                    base.turn_views(info.display_time, state, views);
                }
            }
        }
        result
    })
}

/// The application located its views. Of several calls for one frame the first plans it, where the plan waits for it; calls for other
/// times, of a thread that prepares the next frame, plan nothing.
fn views_located(session: &Session, active: &Active, info: &xr::ViewLocateInfo, views: &[xr::View]) {
    let is_of_eyes = matches!(
        info.view_configuration_type,
        xr::ViewConfigurationType::PRIMARY_MONO
            | xr::ViewConfigurationType::PRIMARY_STEREO
            | xr::ViewConfigurationType::PRIMARY_STEREO_WITH_FOVEATED_INSET
    );
    // Of a spectator's camera, for example.
    if !is_of_eyes {
        return;
    }
    let time = info.display_time;
    let views: SmallVec<[View; 4]> = views.iter().filter_map(|view| of_pose(&view.pose, &view.fov)).collect();
    let state = &active.plan;
    let head = |precedence| {
        let orientations = views.iter().map(|view| view.orientation);
        session.head.views_located(info.space, time, orientations, precedence);
    };
    let config = {
        let mut frame = state.frame();
        if frame.time != Some(time) || frame.is_located {
            head(Precedence::EarlierCall);
            frame.later = Some(LaterViews { time, views });
            return;
        }
        frame.is_located = true;
        Arc::clone(&frame.config)
    };
    head(Precedence::ThisCall);
    let is_planned = {
        let mut planner = state.planner();
        planner.views.located(&views);
        planner.is_planned()
    };
    let expected = expected(active, &config, Some(views));
    if is_planned {
        state.thread.begin(FrameTask { config, time_ns: time.as_nanos(), inputs: None, expected });
    } else {
        watch(session, (active, &config), time);
        plan(session, (active, &config), time, expected);
    }
}

/// The views of the frame's pictures, for re-use: the located ones, as an application should draw them; else none.
pub(super) fn expected(
    active: &Active,
    config: &Config,
    located: Option<SmallVec<[View; 4]>>,
) -> SmallVec<[View; 4]> {
    let may_reuse = active.health() == Health::Works && wants_reuse(config);
    located.filter(|_| may_reuse).unwrap_or_default()
}

/// A projection layer is shown at `time`: the frame is planned now if that was not possible before. No shown object is
/// nearer than `nearest_m`, where that is known.
pub fn views_shown(
    session: &Session,
    (active, config): (&Active, &Arc<ConfigSnapshot>),
    time: xr::Time,
    scene: &Projection<'_>,
    nearest_m: Option<f32>,
) {
    let space = rests(scene.space).then(|| scene.space.into_raw());
    let shown = scene.views.iter().map(|view| {
        let extent = view.sub_image.image_rect.extent;
        let extent = [extent.width.max(0) as u32, extent.height.max(0) as u32];
        Some(ShownView { view: view.view()?, extent })
    });
    let Some(shown) = shown.collect::<Option<SmallVec<[ShownView; 4]>>>() else { return };
    let later = active.plan.frame().later.take_if(|later| later.time == time);
    let is_planned = {
        let mut planner = active.plan.planner();
        if let Some(later) = later {
            planner.views.located(&later.views);
        }
        planner.views.shown(space, &shown);
        planner.views.set_nearest(nearest_m);
        planner.is_planned()
    };
    if !is_planned {
        plan(session, (active, config), time, SmallVec::new());
    }
}

/// A pose and a field of view, if the pose makes sense.
fn of_pose(pose: &xr::Posef, fov: &xr::Fovf) -> Option<View> {
    let xr::Quaternionf { x, y, z, w } = pose.orientation;
    let xr::Vector3f { x: right, y: up, z: back } = pose.position;
    Some(View {
        orientation: rotation(x, y, z, w)?,
        position: Vec3::new(right, up, back),
        fov: submission::fov(fov),
    })
}

/// Plans the frame that is shown at `time`, and hands its rates to the Vulkan half: on the session's thread where the frame has maps, which
/// sorts the tiles of `expected` views too.
pub(super) fn plan(
    session: &Session,
    (active, config): (&Active, &Arc<ConfigSnapshot>),
    time: xr::Time,
    expected: SmallVec<[View; 4]>,
) {
    let state = &active.plan;
    if state.has_failed() {
        return;
    }
    let _stop = StopPlanningOnPanic(state);
    let can_attenuate = active.health() == Health::Works;
    let has_work = {
        let mut planner = state.planner();
        let has_work = planner.has_work(config, can_attenuate);
        if !has_work {
            planner.idle();
        }
        has_work
    };
    if !has_work {
        state.audio_input().rest();
        return;
    }
    let look = session.gaze.look(session, config, time);
    let head = session.head_in_world(time);
    let sound = state.sound(config, time);
    let has_maps = {
        let mut planner = state.planner();
        if let Some(mut compose) = active.made_tools().and_then(Tools::free_compose) {
            compose.changes(|view, tiles, changes| planner.content_changed(view, tiles, changes));
        }
        planner.listen(sound);
        planner.has_maps(config)
    };
    let inputs = Some(PlanInputs { can_attenuate, head, look });
    let task = FrameTask { config: Arc::clone(config), time_ns: time.as_nanos(), inputs, expected };
    if has_maps {
        state.thread.begin(task);
    } else {
        // Chroma alone takes less time than to wake a thread.
        state.thread.work().plan(&task);
    }
}

/// Asks the eye tracker, where the frame is not planned but a gate waits for a saccade or a blink, or the gaze is recorded or shown by
/// `parafovea gaze`.
pub(super) fn watch(session: &Session, (active, config): (&Active, &ConfigSnapshot), time: xr::Time) {
    let state = &active.plan;
    let can_attenuate = active.health() == Health::Works;
    let is_asked = config.is_gaze_watched || config.gaze.record.path().is_some();
    let is_watched = {
        let planner = state.planner();
        planner.only_watches(config, can_attenuate) || is_asked && !planner.has_work(config, can_attenuate)
    };
    if is_watched {
        let look = session.gaze.look(session, config, time);
        let head = session.head_in_world(time);
        follow(&mut state.planner(), config, look, head, time.as_nanos());
    }
}

/// Orientation of the head in the layer's space at the time that a projection layer's eye buffers were drawn for: the direction of the
/// gaze is known relative to the head. By `locate`, else by the views; by the views alone for [`GazeSource::Centre`].
pub fn head_in_layer(
    config: &Config,
    layer: &Projection<'_>,
    locate: impl FnOnce() -> Option<Quat>,
) -> Option<Quat> {
    let of_views = || head_of(layer.views.iter().take(2).filter_map(|view| view.orientation));
    match config.gaze.source {
        // The centre of the eye buffer's view, whenever the eye buffer was drawn.
        GazeSource::Centre => of_views(),
        GazeSource::Auto | GazeSource::Eyes | GazeSource::Osc | GazeSource::File => {
            locate().or_else(of_views)
        }
    }
}

/// Turns planning off after a panic, so that it does not recur in every frame.
struct StopPlanningOnPanic<'a>(&'a SessionPlan);

impl Drop for StopPlanningOnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.thread.work_in_progress().fail();
        }
    }
}
