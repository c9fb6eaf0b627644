//! Occlusion queries and conditional rendering: their results depend on the drawn samples.

use super::{Buffer, Recorded, Within, with_buffer};
use ash::vk;
use std::ffi::c_void;

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
        unsafe { begin_with(known.as_deref(), handle, pool, next) };
    });
}

/// `vkCmdBeginQueryIndexedEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn begin_indexed(
    handle: vk::CommandBuffer,
    pool: vk::QueryPool,
    query: u32,
    flags: vk::QueryControlFlags,
    index: u32,
) {
    hook!(
        "vkCmdBeginQueryIndexedEXT",
        with_buffer,
        cmd_begin_query_indexed(handle, pool, query, flags, index),
        |known, next| {
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { begin_with(known.as_deref(), handle, pool, next) };
        }
    );
}

/// A query of a pool begins, by `begin`.
///
/// # Safety
///
/// The command buffer is recording.
unsafe fn begin_with(
    known: Option<&Buffer>,
    handle: vk::CommandBuffer,
    pool: vk::QueryPool,
    begin: impl FnOnce(),
) {
    // SAFETY: the command buffer is recording, as `# Safety` demands.
    unsafe { fill_before(known, handle) };
    begin();
    if let Some(known) = known.filter(|known| known.armed.objects.counts_samples(pool)) {
        let mut recorded = known.recorded();
        recorded.queries += 1;
        set_queried(&mut recorded);
    }
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
        ends(known.as_deref(), pool);
    });
}

/// `vkCmdEndQueryIndexedEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn end_indexed(
    handle: vk::CommandBuffer,
    pool: vk::QueryPool,
    query: u32,
    index: u32,
) {
    hook!(
        "vkCmdEndQueryIndexedEXT",
        with_buffer,
        cmd_end_query_indexed(handle, pool, query, index),
        |known, next| {
            next();
            ends(known.as_deref(), pool);
        }
    );
}

/// A query of a pool has ended.
fn ends(known: Option<&Buffer>, pool: vk::QueryPool) {
    if let Some(known) = known.filter(|known| known.armed.objects.counts_samples(pool)) {
        let mut recorded = known.recorded();
        recorded.queries = recorded.queries.saturating_sub(1);
    }
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
            unsafe { begin_conditional_with(known.as_deref(), handle, next) };
        }
    );
}

/// `vkCmdBeginConditionalRendering2EXT`, with an address in place of a buffer.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn begin_conditional2(handle: vk::CommandBuffer, info: *const c_void) {
    hook!(
        "vkCmdBeginConditionalRendering2EXT",
        with_buffer,
        cmd_begin_conditional_rendering2(handle, info),
        |known, next| {
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { begin_conditional_with(known.as_deref(), handle, next) };
        }
    );
}

/// Conditional rendering begins, by `begin`.
///
/// # Safety
///
/// The command buffer is recording.
unsafe fn begin_conditional_with(known: Option<&Buffer>, handle: vk::CommandBuffer, begin: impl FnOnce()) {
    // SAFETY: the command buffer is recording, as `# Safety` demands.
    unsafe { fill_before(known, handle) };
    begin();
    if let Some(known) = known {
        let mut recorded = known.recorded();
        recorded.is_conditional = true;
        set_queried(&mut recorded);
    }
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
