//! Occlusion queries and conditional rendering: their results depend on the drawn samples.

use super::{Buffer, Recorded, Within, with_buffer};
use crate::abi::guard;
use ash::vk;

/// `vkCmdBeginQuery`.
pub unsafe extern "system" fn begin(
    handle: vk::CommandBuffer,
    pool: vk::QueryPool,
    query: u32,
    flags: vk::QueryControlFlags,
) {
    // SAFETY: the application's own arguments.
    guard(
        "vkCmdBeginQuery",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(with_buffer: handle, cmd_begin_query(handle, pool, query, flags), ()) },
        |answer| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_begin_query) else { return };
            fill_before(known.as_deref(), handle);
            next(handle, pool, query, flags);
            answer.made();
            if let Some(known) = known.filter(|known| known.armed.objects.counts_samples(pool)) {
                let mut recorded = known.recorded();
                recorded.queries += 1;
                set_queried(&mut recorded);
            }
        },
    );
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
pub unsafe extern "system" fn end(handle: vk::CommandBuffer, pool: vk::QueryPool, query: u32) {
    // SAFETY: the application's own arguments.
    guard(
        "vkCmdEndQuery",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(with_buffer: handle, cmd_end_query(handle, pool, query), ()) },
        |answer| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_end_query) else { return };
            next(handle, pool, query);
            answer.made();
            if let Some(known) = known.filter(|known| known.armed.objects.counts_samples(pool)) {
                let mut recorded = known.recorded();
                recorded.queries = recorded.queries.saturating_sub(1);
            }
        },
    );
}

/// `vkCmdBeginConditionalRenderingEXT`.
pub unsafe extern "system" fn begin_conditional(
    handle: vk::CommandBuffer,
    info: *const vk::ConditionalRenderingBeginInfoEXT<'_>,
) {
    // SAFETY: the application's own arguments.
    guard(
        "vkCmdBeginConditionalRenderingEXT",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(with_buffer: handle, cmd_begin_conditional_rendering(handle, info), ()) },
        |answer| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_begin_conditional_rendering) else {
                return;
            };
            fill_before(known.as_deref(), handle);
            next(handle, info);
            answer.made();
            if let Some(known) = known {
                let mut recorded = known.recorded();
                recorded.is_conditional = true;
                set_queried(&mut recorded);
            }
        },
    );
}

/// `vkCmdEndConditionalRenderingEXT`.
pub unsafe extern "system" fn end_conditional(handle: vk::CommandBuffer) {
    // SAFETY: the application's own argument.
    guard(
        "vkCmdEndConditionalRenderingEXT",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(with_buffer: handle, cmd_end_conditional_rendering(handle), ()) },
        |answer| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_end_conditional_rendering) else {
                return;
            };
            next(handle);
            answer.made();
            if let Some(known) = known {
                known.recorded().is_conditional = false;
            }
        },
    );
}

fn set_queried(recorded: &mut Recorded) {
    recorded.add(Within { is_queried: true, ..Within::default() });
}
