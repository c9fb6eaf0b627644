use super::*;
use ash::vk::Handle;
use std::cell::Cell;
use std::ffi::{CStr, c_void};

const QUEUE: u64 = 1;

thread_local! {
    /// Number of times that query results were asked for.
    static READS: Cell<u64> = const { Cell::new(0) };
    /// Number of query pools that were made, and destroyed.
    static POOLS: Cell<[u64; 2]> = const { Cell::new([0; 2]) };
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

/// # Safety
///
/// As the call.
unsafe extern "system" fn create(
    _: vk::Device,
    _: *const vk::QueryPoolCreateInfo<'_>,
    _: *const vk::AllocationCallbacks<'_>,
    pool: *mut vk::QueryPool,
) -> vk::Result {
    let [made, destroyed] = POOLS.get();
    POOLS.set([made + 1, destroyed]);
    // SAFETY: the caller has room for the handle.
    unsafe { *pool = vk::QueryPool::from_raw(made + 1) };
    vk::Result::SUCCESS
}

/// # Safety
///
/// None.
unsafe extern "system" fn destroy(_: vk::Device, _: vk::QueryPool, _: *const vk::AllocationCallbacks<'_>) {
    let [made, destroyed] = POOLS.get();
    POOLS.set([made, destroyed + 1]);
}

/// A device that does nothing but answer queries.
fn device() -> ash::Device {
    let function = |name: &CStr| match name {
        name if name == c"vkGetQueryPoolResults" => results as *const c_void,
        name if name == c"vkCreateQueryPool" => create as *const c_void,
        name if name == c"vkDestroyQueryPool" => destroy as *const c_void,
        _ => nothing as *const c_void,
    };
    // SAFETY: called with any arguments, `nothing` ignores them, and returns success; the others are of their names.
    unsafe { ash::Device::load_with(function, vk::Device::null()) }
}

/// A timer that is recorded.
fn timer(device: &ash::Device, timing: &Timing) -> Timer {
    // SAFETY: the device is never destroyed.
    let mut timer = unsafe { Timer::of_tests(device, timing) };
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
    let timers = [timer(&device, &timing), timer(&device, &timing)];
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

/// Many applications allocate their command buffers anew in each frame, and drivers make each pool with memory of its own.
#[test]
fn the_pools_of_freed_command_buffers_are_used_again() {
    let timing = Timing::new(vk::PhysicalDevice::null(), false);
    let (queue, device) = (vk::Queue::from_raw(QUEUE), device());
    let submit = |timer: &Timer, frame| {
        timing.submits(timer, frame, queue);
        timing.returned(queue, vk::Result::SUCCESS);
    };
    for frame in 1..100 {
        let timers = [timer(&device, &timing), timer(&device, &timing)];
        timers.iter().for_each(|timer| submit(timer, frame));
        timing.read();
        assert_eq!(complete(&timing), Some(frame));
    }
    assert_eq!(POOLS.get(), [2, 0]);
    let unread = timer(&device, &timing);
    submit(&unread, 100);
    lock(&timing.unread).clear();
    drop(unread);
    assert_eq!(POOLS.get(), [2, 1], "its timestamps are later than the timestamps read before");
    let last = timer(&device, &timing);
    timing.clear();
    drop(last);
    assert_eq!(POOLS.get(), [2, 2], "none outlives the device");
}
