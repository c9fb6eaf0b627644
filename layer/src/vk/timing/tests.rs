use super::*;
use ash::vk::Handle;
use std::cell::Cell;
use std::ffi::{CStr, c_void};

const QUEUE: u64 = 1;

thread_local! {
    /// Number of times that query results were asked for.
    static READS: Cell<u64> = const { Cell::new(0) };
}

/// # Safety
///
/// None.
unsafe extern "system" fn nothing() -> vk::Result {
    vk::Result::SUCCESS
}

/// Timestamps that rise with each call.
///
/// # Safety
///
/// As the call, of two results of 64 bits.
unsafe extern "system" fn results(
    _: vk::Device,
    _: vk::QueryPool,
    _: u32,
    _: u32,
    _: usize,
    data: *mut c_void,
    _: vk::DeviceSize,
    _: vk::QueryResultFlags,
) -> vk::Result {
    let read = READS.get() + 1;
    READS.set(read);
    // SAFETY: room for two results, as `# Safety` demands.
    unsafe { data.cast::<[u64; 2]>().write([10 * read, 10 * read + 3]) };
    vk::Result::SUCCESS
}

/// A device that does nothing but answer queries.
fn device() -> ash::Device {
    let function = |name: &CStr| match name {
        name if name == c"vkGetQueryPoolResults" => results as *const c_void,
        _ => nothing as *const c_void,
    };
    // SAFETY: called with any arguments, `nothing` ignores them, and returns success; the other is of its name.
    unsafe { ash::Device::load_with(function, vk::Device::null()) }
}

/// A timer that is recorded.
fn timer(device: &ash::Device) -> Timer {
    // SAFETY: the device is never destroyed.
    let mut timer = unsafe { Timer::of_tests(device) };
    // SAFETY: the device takes any command buffer.
    unsafe {
        timer.begin(|| None, vk::CommandBuffer::null());
        timer.end(vk::CommandBuffer::null());
    }
    timer
}

/// Frame numbers with all of their timestamps read.
fn complete(timing: &Timing) -> Option<u64> {
    let time = lock(&timing.frames).take(u64::MAX, 1.0);
    time.map(|time| time.frame)
}

/// Before that they were never reset.
#[test]
fn timestamps_are_read_after_their_submit_has_returned() {
    let timing = Timing::new(vk::PhysicalDevice::null(), false);
    let [queue, other] = [QUEUE, QUEUE + 1].map(vk::Queue::from_raw);
    let device = device();
    let timers = [timer(&device), timer(&device)];
    timing.submits(&timers[0], 1, queue);
    timing.read();
    timing.returned(other, vk::Result::SUCCESS);
    timing.read();
    assert_eq!((READS.get(), complete(&timing)), (0, None));
    timing.returned(queue, vk::Result::SUCCESS);
    timing.read();
    assert_eq!((READS.get(), complete(&timing)), (1, Some(1)));
    timing.submits(&timers[0], 2, queue);
    timing.returned(queue, vk::Result::ERROR_OUT_OF_HOST_MEMORY);
    timing.submits(&timers[1], 3, queue);
    timing.returned(queue, vk::Result::SUCCESS);
    timing.read();
    assert_eq!((READS.get(), complete(&timing)), (2, Some(3)), "a failed submit is not waited for");
}
