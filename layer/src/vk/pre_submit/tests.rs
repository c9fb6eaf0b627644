use super::stand_in::{allocate, nothing, record};
use super::*;
use std::cell::{Cell, RefCell};
use std::ffi::{CStr, c_void};

thread_local! {
    static MADE: Cell<u64> = const { Cell::new(0) };
    /// Fences of submits, in their order on the queue.
    static SUBMITTED: RefCell<Vec<vk::Fence>> = const { RefCell::new(Vec::new()) };
    /// Number of submits that the GPU is done with.
    static DONE: Cell<usize> = const { Cell::new(0) };
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create(
    _: vk::Device,
    _: *const (),
    _: *const vk::AllocationCallbacks<'_>,
    handle: *mut u64,
) -> vk::Result {
    // SAFETY: a place for the handle, as the call demands.
    unsafe { *handle = MADE.replace(MADE.get() + 1) + 1 };
    vk::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn is_signaled(_: vk::Device, fence: vk::Fence) -> vk::Result {
    let is_done =
        SUBMITTED.with_borrow(|submitted| submitted.iter().take(DONE.get()).any(|done| *done == fence));
    if is_done { vk::Result::SUCCESS } else { vk::Result::NOT_READY }
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn submit(
    _: vk::Queue,
    _: u32,
    _: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    SUBMITTED.with_borrow_mut(|submitted| submitted.push(fence));
    vk::Result::SUCCESS
}

fn functions() -> Functions {
    let function = |name: &CStr| match name.to_bytes() {
        b"vkCreateCommandPool" | b"vkCreateFence" => create as *const c_void,
        b"vkAllocateCommandBuffers" => allocate as *const c_void,
        b"vkGetFenceStatus" => is_signaled as *const c_void,
        _ => nothing as *const c_void,
    };
    // SAFETY: the functions have the types of their names; `nothing` stands for functions whose arguments it ignores, and whose results
    // are a VkResult or nothing.
    unsafe {
        Functions {
            instance: ash::Instance::load_with(function, vk::Instance::null()),
            device: ash::Device::load_with(function, vk::Device::null()),
        }
    }
}

/// Runs with a ring and a submitter on a stand-in device.
fn with_ring(test: impl FnOnce(&PreSubmitRing, Submitter<'_>)) {
    let (functions, record) = (functions(), record());
    let (locks, frame, rings) = (QueueLocks::default(), Frame::default(), Table::default());
    let timing = Timing::new(vk::PhysicalDevice::null(), true);
    let own = Submitter {
        record: &record,
        functions: &functions,
        submit,
        locks: &locks,
        timing: &timing,
        frame: &frame,
        rings: &rings,
    };
    let ring = PreSubmitRing::new(0);
    test(&ring, own);
    DONE.set(usize::MAX);
    ring.destroy(&functions);
}

/// Submits a command, after `before`.
fn submit_after(ring: &PreSubmitRing, own: Submitter<'_>, before: impl FnOnce()) -> Outcome {
    let add = |submission: &mut Submission<'_>| {
        before();
        submission.commands().map(drop)
    };
    // SAFETY: the device is a stand-in, and no other thread uses its queue.
    unsafe { ring.submit((own, vk::Queue::null()), (Work::Maps, true), add) }
}

fn pending(ring: &PreSubmitRing) -> usize {
    lock(&ring.slots).iter().filter(|slot| slot.pending().is_some()).count()
}

#[test]
fn slots_keep_their_memory() {
    let ring = PreSubmitRing::new(0);
    let slots = Vec::with_capacity(4);
    let memory = slots.as_ptr();
    ring.put_back(slots);
    assert_eq!(lock(&ring.slots).as_ptr(), memory);
}

/// Two threads submit at once, and the second records faster.
#[test]
fn a_submit_that_was_begun_first_may_be_the_newest() {
    with_ring(|ring, own| {
        let outcome = submit_after(ring, own, || {
            assert_eq!(submit_after(ring, own, || {}), Outcome::Submitted);
        });
        assert_eq!((outcome, pending(ring)), (Outcome::Submitted, 2));
        DONE.set(1);
        ring.poll(own.functions);
        assert_eq!(pending(ring), 1, "the GPU still works on the submit that was begun first");
        DONE.set(2);
        ring.poll(own.functions);
        assert_eq!(pending(ring), 0);
    });
}

#[test]
fn slots_of_colliding_threads_are_destroyed_when_they_are_free() {
    with_ring(|ring, own| {
        fn nested(ring: &PreSubmitRing, own: Submitter<'_>, depth: usize) {
            submit_after(ring, own, || {
                if depth > 0 {
                    nested(ring, own, depth - 1);
                }
            });
        }
        nested(ring, own, MOST_SLOTS + 8);
        assert_eq!(lock(&ring.slots).len(), MOST_SLOTS + 9);
        DONE.set(usize::MAX);
        assert_eq!(submit_after(ring, own, || {}), Outcome::Submitted);
        assert_eq!(lock(&ring.slots).len(), MOST_SLOTS);
    });
}
