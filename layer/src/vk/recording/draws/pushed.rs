//! Descriptors that are pushed for drawing (VK_KHR_push_descriptor): they count as a set of the command buffer's own.

use super::{OPEN, cached_device};
use crate::vk::recording::untracked;
use ash::vk;
use ash::vk::Handle;

/// The set for pushes to a number in a command buffer. No set of an application has this handle, an address within the command buffer's
/// object.
fn pushed_set(commands: vk::CommandBuffer, number: u32) -> vk::DescriptorSet {
    vk::DescriptorSet::from_raw(commands.as_raw() + 1 + u64::from(number))
}

/// Descriptors are pushed for drawing to the set of that number: images by these views, each with its binding and array element. Other
/// descriptors of the set stay.
///
/// # Safety
///
/// `handle` is a live command buffer.
pub unsafe fn push(
    handle: vk::CommandBuffer,
    number: u32,
    views: impl Iterator<Item = ((u32, u32), vk::ImageView)>,
) {
    // SAFETY: the handle is live, as `# Safety` demands.
    let Some(armed) = (unsafe { cached_device(handle) }) else { return };
    if untracked::is_here(handle) {
        return;
    }
    let descriptors = &armed.objects.descriptors;
    let set = pushed_set(handle, number);
    let _ = OPEN.try_with(|open| {
        open.turn_to(handle.as_raw());
        let Some(bound) = open.sets.get(number as usize) else { return open.bind_unknown() };
        let before = bound.get();
        if before != set.as_raw() && descriptors.may_read(set) {
            // Pushed in an earlier recording, or before another set was bound.
            descriptors.forget(set);
        }
        let mut is_changed = false;
        for (at, view) in views {
            is_changed |= descriptors.write(set, at, descriptors.attachment(&armed.objects, view));
        }
        let now = if descriptors.may_read(set) { set.as_raw() } else { 0 };
        bound.set(now);
        if is_changed || before != now {
            open.is_bound_anew(descriptors.may_name(set));
        }
    });
}
