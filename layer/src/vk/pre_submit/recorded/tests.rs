//! On a device that does nothing but hand out command buffers.

use super::super::stand_in::{allocate, allocated, nothing, record};
use super::*;
use std::cell::Cell;
use std::ffi::{CStr, c_void};

thread_local! {
    /// Number of begun command buffers.
    static BEGUN: Cell<u64> = const { Cell::new(0) };
    /// Number of destroyed pools.
    static DESTROYED: Cell<u64> = const { Cell::new(0) };
}

/// # Safety
///
/// None.
unsafe extern "system" fn begin(
    _: vk::CommandBuffer,
    _: *const vk::CommandBufferBeginInfo<'_>,
) -> vk::Result {
    BEGUN.set(BEGUN.get() + 1);
    vk::Result::SUCCESS
}

/// # Safety
///
/// None.
unsafe extern "system" fn destroy_pool(
    _: vk::Device,
    _: vk::CommandPool,
    _: *const vk::AllocationCallbacks<'_>,
) {
    DESTROYED.set(DESTROYED.get() + 1);
}

fn device() -> (ash::Device, DeviceRecord) {
    let function = |name: &CStr| match name {
        name if name == c"vkAllocateCommandBuffers" => allocate as *const c_void,
        name if name == c"vkBeginCommandBuffer" => begin as *const c_void,
        name if name == c"vkDestroyCommandPool" => destroy_pool as *const c_void,
        _ => nothing as *const c_void,
    };
    // SAFETY: called with any arguments, `nothing` ignores them, and returns success; the others are of their names.
    (unsafe { ash::Device::load_with(function, vk::Device::null()) }, record())
}

/// The command buffer with a key, and whether it was recorded.
fn find(commands: &mut RecordedCommands, key: u64) -> (Option<Found>, bool) {
    let (device, record) = device();
    let recorded = Cell::new(0);
    let count = |_| recorded.set(recorded.get() + 1);
    let key = RecordingKey::from_slice(&[key, 0]);
    let before = BEGUN.get();
    // SAFETY: the device takes any call.
    let found = unsafe { commands.find((&device, &record), 0, &key, count) }.unwrap();
    assert_eq!(BEGUN.get() - before, recorded.get());
    (found, recorded.get() == 1)
}

#[test]
fn commands_with_a_known_key_are_not_recorded() {
    let mut commands = RecordedCommands::default();
    let first = find(&mut commands, 1);
    let other = find(&mut commands, 2);
    assert!(first.1 && other.1);
    let again = find(&mut commands, 1);
    let handle = |found: &(Option<Found>, bool)| found.0.as_ref().unwrap().commands;
    assert_eq!((handle(&again), again.1), (handle(&first), false), "pending, and submitted again");
    assert_ne!(handle(&again), handle(&other));
}

#[test]
fn the_commands_of_the_oldest_finished_submit_make_room() {
    let mut commands = RecordedCommands::default();
    let mut found: Vec<_> = (0..MOST as u64).map(|key| find(&mut commands, key).0.unwrap()).collect();
    assert!(find(&mut commands, 100).0.is_none(), "all are pending");
    let (last, third) = (found.pop().unwrap().commands, found.remove(3).commands);
    // Both have finished, and the third is submitted once more.
    assert_eq!(find(&mut commands, 3).0.unwrap().commands, third);
    let (new, is_recorded) = find(&mut commands, 100);
    assert_eq!((new.unwrap().commands, is_recorded), (last, true));
    assert!(!find(&mut commands, 3).1);
    assert!(find(&mut commands, MOST as u64 - 1).1, "its command buffer has another key");
}

/// Destroying the pool of a pending command buffer is undefined.
#[test]
fn pending_commands_are_left_and_finished_ones_destroyed() {
    let (device, _) = device();
    let mut commands = RecordedCommands::default();
    let pending = find(&mut commands, 1);
    commands.destroy(&device);
    drop(pending);
    assert_eq!(DESTROYED.get(), 0);
    let mut commands = RecordedCommands::default();
    drop(find(&mut commands, 1));
    commands.destroy(&device);
    assert_eq!(DESTROYED.get(), 1);
}

#[test]
fn a_failed_recording_is_repeated() {
    unsafe extern "system" fn fail(_: vk::CommandBuffer) -> vk::Result {
        vk::Result::ERROR_OUT_OF_HOST_MEMORY
    }
    let function = |name: &CStr| match name {
        name if name == c"vkAllocateCommandBuffers" => allocate as *const c_void,
        name if name == c"vkEndCommandBuffer" => fail as *const c_void,
        _ => nothing as *const c_void,
    };
    let mut commands = RecordedCommands::default();
    let key = RecordingKey::from_slice(&[7, 0]);
    // SAFETY: as in `device`.
    let device = unsafe { ash::Device::load_with(function, vk::Device::null()) };
    // SAFETY: the device takes any call.
    assert!(unsafe { commands.find((&device, &record()), 0, &key, |_| ()) }.is_err());
    assert!(find(&mut commands, 7).1);
    assert_eq!(allocated(), 1, "in the same command buffer");
}
