//! Occlusion queries and conditional rendering: their results depend on the drawn samples.

use super::{Buffer, Recorded, Within, with_buffer};
use ash::vk;

/// `vkCmdBeginQuery`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn begin(
    handle: vk::CommandBuffer,
    pool: vk::QueryPool,
    query: u32,
    flags: vk::QueryControlFlags,
) {
    hook!("vkCmdBeginQuery", with_buffer, cmd_begin_query(handle, pool, query, flags), |known, next| {
        // SAFETY: the command buffer is recording, by valid usage.
        unsafe { fill_before(known.as_deref(), handle) };
        next();
        if let Some(known) = known.filter(|known| known.armed.objects.counts_samples(pool)) {
            let mut recorded = known.recorded();
            recorded.queries += 1;
            set_queried(&mut recorded);
        }
    });
}

/// Records pending fills, which must be neither counted nor left out.
///
/// # Safety
///
/// The command buffer is recording.
unsafe fn fill_before(known: Option<&Buffer>, handle: vk::CommandBuffer) {
    if let Some(known) = known.filter(|known| !known.recorded().is_within_pass()) {
        // SAFETY: the command buffer is recording, as `# Safety` demands; before a pass that is not known nothing waits.
        unsafe { known.fill_all(handle) };
    }
}

/// `vkCmdEndQuery`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn end(handle: vk::CommandBuffer, pool: vk::QueryPool, query: u32) {
    hook!("vkCmdEndQuery", with_buffer, cmd_end_query(handle, pool, query), |known, next| {
        next();
        if let Some(known) = known.filter(|known| known.armed.objects.counts_samples(pool)) {
            let mut recorded = known.recorded();
            recorded.queries = recorded.queries.saturating_sub(1);
        }
    });
}

/// `vkCmdBeginConditionalRenderingEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn begin_conditional(
    handle: vk::CommandBuffer,
    info: *const vk::ConditionalRenderingBeginInfoEXT<'_>,
) {
    hook!(
        "vkCmdBeginConditionalRenderingEXT",
        with_buffer,
        cmd_begin_conditional_rendering(handle, info),
        |known, next| {
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { fill_before(known.as_deref(), handle) };
            next();
            if let Some(known) = known {
                let mut recorded = known.recorded();
                recorded.is_conditional = true;
                set_queried(&mut recorded);
            }
        }
    );
}

/// `vkCmdEndConditionalRenderingEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn end_conditional(handle: vk::CommandBuffer) {
    hook!(
        "vkCmdEndConditionalRenderingEXT",
        with_buffer,
        cmd_end_conditional_rendering(handle),
        |known, next| {
            next();
            if let Some(known) = known {
                known.recorded().is_conditional = false;
            }
        }
    );
}

fn set_queried(recorded: &mut Recorded) {
    recorded.add(Within { is_queried: true, ..Within::default() });
}
