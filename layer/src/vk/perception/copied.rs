//! Copies of decisions, for people to look at.

use super::Perception;
use crate::gpu::{AppCommands, Scope};
use crate::kernels::analyze::rate_row_bytes;
use crate::link::{RATES_COPIED, RATES_COPY_LEFT_OUT, RATES_OF_PLAN, RatesCopyRecord};
use crate::vk::pre_submit::{Outcome, Submission, Submitter};
use crate::vk::timing::Work;
use ash::vk;
use std::any::Any;
use std::sync::Arc;

/// The overlay's reads of the last copy.
const OVERLAY_READS: Scope =
    Scope { stages: vk::PipelineStageFlags::FRAGMENT_SHADER, access: vk::AccessFlags::empty() };

/// The decision's writes, and the copies from it and to the overlay.
const DECIDES: Scope =
    Scope { stages: vk::PipelineStageFlags::COMPUTE_SHADER, access: vk::AccessFlags::SHADER_WRITE };
const COPIES: Scope = Scope {
    stages: vk::PipelineStageFlags::TRANSFER,
    access: vk::AccessFlags::from_raw(
        vk::AccessFlags::TRANSFER_READ.as_raw() | vk::AccessFlags::TRANSFER_WRITE.as_raw(),
    ),
};

impl Perception {
    /// Copies the last decided rates of an eye, if any; returns the outcome, as numbered by [`crate::link`]. The caller orders reads of the
    /// copy.
    ///
    /// # Safety
    ///
    /// As [`RatesCopyRecord`] demands: this thread may use the queue, and the buffer is live and large enough.
    pub unsafe fn copy_rates(&self, own: Option<Submitter<'_>>, record: &RatesCopyRecord) -> u32 {
        let found = {
            let state = self.state();
            let queue = state.queue.filter(|(id, _)| *id == record.queue && state.decided.is_some());
            let eye = state.eyes.get(record.eye as usize).and_then(Option::as_ref);
            queue.zip(eye.map(|eye| Arc::clone(&eye.tiles)))
        };
        let Some(((_, queue), tiles)) = found.filter(|(_, tiles)| tiles.view.tiles() == record.tiles) else {
            return RATES_OF_PLAN;
        };
        let (Some(tools), Some(own)) = (self.made(), own) else { return RATES_COPY_LEFT_OUT };
        let Some(ring) = own.rings.get(queue) else { return RATES_COPY_LEFT_OUT };
        let [columns, rows] = record.tiles;
        let size = u64::from(rate_row_bytes(columns)) * u64::from(rows);
        let rates = tiles.view.rates();
        let copy = |submission: &mut Submission<'_>| {
            submission.kept.push(tiles as Arc<dyn Any + Send + Sync>);
            let commands = submission.commands()?;
            // SAFETY: the command buffer is recording for that queue; the rates are kept, and the buffer is live and large enough, as `# Safety` demands.
            let commands = unsafe { AppCommands::new(&tools.gpu, commands) };
            commands.memory_barrier(OVERLAY_READS, COPIES);
            commands.memory_barrier(DECIDES, COPIES);
            commands.copy_buffer((rates, 0), (record.buffer, record.offset), size);
            Ok(())
        };
        // SAFETY: this thread may use the live queue, as `# Safety` demands, and the objects of the commands are kept.
        let outcome = unsafe { ring.submit((own, queue), (Work::Analysis, false), copy) };
        if outcome == Outcome::Submitted { RATES_COPIED } else { RATES_COPY_LEFT_OUT }
    }
}
