//! Completion of a frame's pictures from earlier ones.

use super::history::{CompletionSettings, Expected, History, ShownEyeBuffer};
use super::work::{Regions, Work};
use super::{FrameEnd, Works, depth};
use crate::config::{Config, longest_period, wants_reuse};
use crate::pass_detection::Feedback;
use crate::planner::{SessionPlanner, View, Watched};
use crate::xr::plan::PlanWork;
use crate::xr::session::{Health, Tools};
use crate::xr::submission::Projection;
use crate::xr::vulkan_device::FrameReport;
use openxr_sys as xr;
use parafovea_core::reuse::StaleTiles;
use smallvec::SmallVec;
use std::ops::Range;

/// Notes the pictures that a frame shows, completes partly rendered ones, and passes the planner the eyes whose next pictures can re-use
/// them.
pub fn complete<'a>(
    frame: &FrameEnd,
    tools: &Tools,
    report: &mut FrameReport,
    works: &mut Works<'_>,
    history: &'a mut History,
    regions: &mut Regions<'a>,
) {
    let FrameEnd { active, submission, ref config, .. } = *frame;
    let wants_reuse = wants_reuse(config);
    if active.health() != Health::Works || !(wants_reuse || (0..2).any(|eye| history.has_pictures(eye))) {
        active.plan.keep_pictures(false);
        return;
    }
    let settings = CompletionSettings::of(config);
    // With a second layer, passes cannot be assigned to layers. Eye buffers with stale tiles of the plan before are still completed.
    let only = submission.only_projection();
    let is_only = only.is_some();
    let scene = only.or_else(|| {
        let is_known = |layer: &Projection<'_>| {
            let shown = picture(layer, 0, submission.time, works);
            shown.is_some_and(|(shown, _)| history.is_of(0, shown.substitute))
        };
        submission.projections().find(is_known)
    });
    // An application that is paused may copy its last picture for each frame.
    let is_copied = report.feedback == Feedback::Ahead && report.eye_passes == 0;
    let watched = watched(&active.plan.planner(), config);
    let mut kept = [false; 2];
    let mut sorted = active.plan.sorted();
    for eye in 0..2 {
        let shown = scene.as_ref().and_then(|scene| picture(scene, eye, submission.time, works));
        let is_others = |(other, _): (ShownEyeBuffer, &Work)| {
            shown.is_some_and(|(shown, _)| {
                (shown.substitute, shown.array_layer, shown.rect)
                    == (other.substitute, other.array_layer, other.rect)
            })
        };
        // One picture for both eyes is completed once.
        let is_both = eye == 1
            && scene
                .as_ref()
                .and_then(|scene| picture(scene, 0, submission.time, works))
                .is_some_and(is_others);
        kept[eye] = if is_both {
            history.show(eye, None, |_| false, |_| {});
            kept[0]
        } else {
            let is_intact = |release| shown.is_some_and(|(_, work)| work.is_intact(release));
            let view = scene.as_ref().and_then(|scene| scene.views.get(eye));
            let depth = view.and_then(depth::of);
            let picture = shown.as_ref().map(|(picture, _)| ShownEyeBuffer { is_copied, ..*picture });
            let picture = picture.as_ref().map(|picture| (picture, depth));
            let goes_on = history.show(eye, picture, is_intact, |stale| {
                std::mem::swap(stale, &mut report.stale[eye]);
            });
            goes_on
                && is_only
                && shown.is_some_and(|(_, work)| {
                    work.keeps(longest_period(config))
                        && (!wants_reuse || tools.compose().completes(work.format()))
                })
        };
        if !(wants_reuse && is_only) && history.region(eye, settings).is_none() {
            history.show(eye, None, |_| false, |_| {});
        }
        history.complete(eye, settings, watched[eye].as_ref(), Some(&mut sorted));
    }
    drop(sorted);
    let follows = |eye: usize| history.has_depth(eye) || (eye == 1 && !history.has_pictures(eye));
    {
        let mut planner = active.plan.planner();
        let may_reuse = wants_reuse && report.feedback.allows_reuse();
        (0..2).filter(|eye| kept[*eye] && may_reuse).for_each(|eye| planner.history_kept(eye));
        planner.views.set_followed((0..2).all(follows));
        active.plan.keep_pictures(may_reuse && kept.contains(&true));
    }
    let history: &'a History = history;
    for eye in 0..2 {
        let view = scene.as_ref().and_then(|scene| scene.views.get(eye));
        let work = view
            .and_then(|view| works.iter_mut().find(|work| work.swapchain.handle == view.sub_image.swapchain));
        if let Some(work) = work
            && tools.compose().completes(work.format())
        {
            add(&mut regions.reuse, &mut work.reuse, history.region(eye, settings));
            let changes =
                watched[eye].as_ref().map(|watched| history.changes(eye, settings, watched.orientation()));
            add(&mut regions.changes, &mut work.changes, changes.flatten());
        }
    }
}

/// Adds an eye's region to the frame's regions, and to a work's `part` of these. Regions of one swapchain are neighbours.
fn add<T>(regions: &mut SmallVec<[T; 2]>, part: &mut Range<usize>, region: Option<T>) {
    let Some(region) = region else { return };
    if part.start == part.end {
        *part = regions.len()..regions.len();
    }
    regions.push(region);
    part.end = regions.len();
}

/// Sorts the tiles that completing the frame's pictures takes, if it shows these views.
pub fn sort_ahead(work: &PlanWork, config: &Config, views: &[View]) {
    // A frame that another thread is ending has pictures that this one needs.
    let Some(history) = work.free_history() else { return };
    let planner = work.planner();
    let watched = watched(&planner, config);
    if !planner.is_planned() {
        return;
    }
    work.sorted().update(move |sorted| {
        for ((eye, view), watched) in views.iter().take(2).enumerate().zip(watched) {
            let stale = |tiles: &mut StaleTiles| planner.stale(eye, tiles);
            let settings = CompletionSettings::of(config);
            history.expect(eye, sorted, Expected { settings, watched, view: *view, stale: &stale });
        }
    });
}

/// The directions that are compared with earlier pictures, of both eyes.
fn watched(planner: &SessionPlanner, config: &Config) -> [Option<Watched>; 2] {
    let is_watched = wants_reuse(config) && config.reuse.refresh;
    [0, 1].map(|eye| planner.watched(eye).filter(|_| is_watched))
}

/// The eye buffer of a view, where it is in a virtual swapchain.
fn picture<'a, 'b>(
    scene: &Projection<'_>,
    eye: usize,
    time: xr::Time,
    works: &'b Works<'a>,
) -> Option<(ShownEyeBuffer, &'b Work<'a>)> {
    let view = scene.views.get(eye)?;
    let work = works.iter().find(|work| work.swapchain.handle == view.sub_image.swapchain)?;
    Some((work.picture(view, scene.space, time)?, work))
}
