//! A driver's queue, which detects calls that come at once.

use ash::vk;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::Duration;

static IS_IN_CALL: AtomicBool = AtomicBool::new(false);
static CALLS: AtomicU32 = AtomicU32::new(0);
static OVERLAPS: AtomicU32 = AtomicU32::new(0);

/// Number of calls, and number of overlaps with an earlier call.
pub fn seen() -> [u32; 2] {
    [&CALLS, &OVERLAPS].map(|count| count.load(Ordering::Relaxed))
}

/// # Safety
///
/// As the call.
pub unsafe extern "system" fn submit(
    _: vk::Queue,
    _: u32,
    _: *const vk::SubmitInfo<'_>,
    _: vk::Fence,
) -> vk::Result {
    CALLS.fetch_add(1, Ordering::Relaxed);
    if IS_IN_CALL.swap(true, Ordering::Relaxed) {
        OVERLAPS.fetch_add(1, Ordering::Relaxed);
    }
    std::thread::sleep(Duration::from_micros(50));
    IS_IN_CALL.store(false, Ordering::Relaxed);
    vk::Result::SUCCESS
}
