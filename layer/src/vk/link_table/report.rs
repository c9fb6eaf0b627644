//! The report on a frame, written to the record of the OpenXR half.

use crate::link::{FrameReportRecord, FrameTimeRecord, StaleRecord};
use crate::status;
use crate::vk::armed::Armed;
use crate::vk::frame::Log;
use crate::vk::timing::FrameTime;

/// Writes the report on the frame that ended last.
///
/// # Safety
///
/// The words of each stale record are null, or have room for its `capacity`.
pub unsafe fn write_report(armed: &Armed, report: &mut FrameReportRecord) {
    let frame = {
        let log = armed.frame.log();
        report.frame = log.frame();
        report.passes_with_rates = log.with_rates();
        report.eye_passes = log.eye_passes();
        report.eye_pixels = log.eye_pixels();
        report.untracked_frames = log.untracked_frames();
        report.feedback = log.feedback().number();
        for (eye, stale) in report.stale.iter_mut().enumerate() {
            // SAFETY: there is room for the words, as `# Safety` demands.
            unsafe { write_stale(&log, eye, stale) };
        }
        log.frame()
    };
    report.decisions = status::decision_count() as u32;
    let times = std::iter::from_fn(|| armed.timing.next(frame));
    report.time_count = 0;
    for (record, FrameTime { frame, ns, maps_ns, analysis_ns }) in report.times.iter_mut().zip(times) {
        // Frames are numbered from 0 here.
        *record = FrameTimeRecord { frame: frame + 1, ns, maps_ns, analysis_ns };
        report.time_count += 1;
    }
}

/// Writes the stale tiles of an eye buffer in the frame that ended last.
///
/// # Safety
///
/// `record.words` is null, or has room for `record.capacity` words.
pub unsafe fn write_stale(log: &Log, eye: usize, record: &mut StaleRecord) {
    record.count = 0;
    let Some(stale) = log.stale(eye).filter(|stale| !stale.is_empty()) else { return };
    let words = stale.words();
    record.extent = stale.extent();
    record.texel = stale.texel();
    record.count = words.len() as u32;
    if record.count <= record.capacity && !record.words.is_null() {
        // SAFETY: there is room for the words, as `# Safety` demands; the other half's words are not ours.
        unsafe { record.words.copy_from_nonoverlapping(words.as_ptr(), words.len()) };
    }
}
