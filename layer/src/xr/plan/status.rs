//! The effect of a session on the user's game: its status, and the reason of a session without any effect.

use crate::config::{ConfigSnapshot, debug_view};
use crate::status::{Known, StatusSnapshot, all_decisions, decision_count, why_unseen};
use crate::xr::offer::SessionOffer;
use crate::xr::session::{Active, Health, Session};
use crate::xr::swapchain;
use crate::xr::vulkan_device::FrameReport;
use openxr_sys as xr;
use parafovea_core::gate::Techniques;
use std::sync::PoisonError;
use std::sync::atomic::Ordering;

/// The status at the end of a frame, for `parafovea status`.
pub fn status(
    session: &Session,
    active: &Active,
    config: &ConfigSnapshot,
    report: &FrameReport,
) -> StatusSnapshot {
    let (state, frames) = (&active.plan, report.frame);
    let mut snapshot = StatusSnapshot {
        frames,
        backend: active.device.capabilities.backend,
        passes_matched: report.passes_with_rates,
        debug_view: config.debug.view,
        debug_view_is_asked: config.is_view_asked,
        debug_view_is_drawn: debug_view(config)
            .is_some_and(|view| active.debug_views().is_drawn(view, frames)),
        ..StatusSnapshot::default()
    };
    snapshot.memory = active.made_tools().map_or(0, |tools| tools.gpu.memory_used());
    (snapshot.reuse_memory, snapshot.reuse_refused) = swapchain::history_memory(session.handle);
    state.planner().write_status(config, &mut snapshot);
    session.gaze.write_status(&mut snapshot);
    snapshot.gaze_is_given = session.offer.as_ref().is_some_and(SessionOffer::is_given);
    let benefit = state.benefit();
    let Techniques { rates, reuse } = benefit.gates().gates();
    (snapshot.rates, snapshot.reuse) = (rates.into(), reuse.into());
    snapshot
}

/// Reports once, when recognition has settled, why an active session has no visible effect, if it has none. To be called at the end of frames
/// with a scene: nothing is recognised while an application loads.
pub fn report_unseen(
    session: &Session,
    (active, config): (&Active, &ConfigSnapshot),
    time: xr::Time,
    report: &FrameReport,
) {
    let state = &active.plan;
    if state.has_reported_unseen.load(Ordering::Relaxed) {
        return;
    }
    let has_settled = {
        let mut quiet = state.quiet.lock().unwrap_or_else(PoisonError::into_inner);
        quiet.frame(time.as_nanos(), decision_count())
    };
    if !has_settled || state.has_reported_unseen.swap(true, Ordering::Relaxed) {
        return;
    }
    let known = Known {
        had_maps: state.benefit().had_maps(),
        has_own_images: !swapchain::virtual_ones(session.handle).is_empty(),
        is_healthy: active.health() == Health::Works && !state.has_failed(),
        decisions: &all_decisions(),
    };
    if let Some(why) = why_unseen(config, &status(session, active, config, report), &known) {
        tracing::info!("{why}");
        if let Some(reporter) = &session.reporter {
            reporter.report_unseen(why);
        }
    }
}
