//! Hooks of queues and query pools.

use crate::abi::guard;
use crate::vk::device;
use crate::vk::objects::QueueId;
use ash::vk;

/// `vkGetDeviceQueue`.
pub unsafe extern "system" fn get(device: vk::Device, family: u32, index: u32, queue: *mut vk::Queue) {
    guard(
        "vkGetDeviceQueue",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, get_device_queue(device, family, index, queue), ()) },
        |answer| {
            // SAFETY: the application's own arguments; the call writes a queue.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.get_device_queue) else { return };
                next(device, family, index, queue);
                answer.made();
                if let Some(armed) = &known.armed {
                    armed.objects.queues.insert(*queue, QueueId { family, index });
                }
            }
        },
    );
}

/// `vkGetDeviceQueue2`.
pub unsafe extern "system" fn get2(
    device: vk::Device,
    info: *const vk::DeviceQueueInfo2<'_>,
    queue: *mut vk::Queue,
) {
    guard(
        "vkGetDeviceQueue2",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, get_device_queue2(device, info, queue), ()) },
        |answer| {
            // SAFETY: the application's own arguments; the call writes a queue, or null.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.get_device_queue2) else { return };
                next(device, info, queue);
                answer.made();
                // Protected queues take protected work only.
                if let Some(armed) = &known.armed
                    && *queue != vk::Queue::null()
                    && !(*info).flags.contains(vk::DeviceQueueCreateFlags::PROTECTED)
                {
                    let id = QueueId { family: (*info).queue_family_index, index: (*info).queue_index };
                    armed.objects.queues.insert(*queue, id);
                }
            }
        },
    );
}

/// `vkCreateQueryPool`.
pub unsafe extern "system" fn create_query_pool(
    device: vk::Device,
    info: *const vk::QueryPoolCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pool: *mut vk::QueryPool,
) -> vk::Result {
    guard(
        "vkCreateQueryPool",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(
                device::with: device,
                create_query_pool(device, info, allocator, pool),
                vk::Result::ERROR_INITIALIZATION_FAILED
            )
        },
        |answer| {
            // SAFETY: the application's own arguments; on success `info` and `pool` are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_query_pool) else {
                    return vk::Result::ERROR_INITIALIZATION_FAILED;
                };
                let result = answer.record(next(device, info, allocator, pool));
                if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result)
                    && (*info).query_type == vk::QueryType::OCCLUSION
                {
                    armed.objects.occlusion_pools.insert(*pool, ());
                }
                result
            }
        },
    )
}

/// `vkDestroyQueryPool`.
pub unsafe extern "system" fn destroy_query_pool(
    device: vk::Device,
    pool: vk::QueryPool,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    guard(
        "vkDestroyQueryPool",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, destroy_query_pool(device, pool, allocator), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_query_pool) else {
                    return;
                };
                if let Some(armed) = &known.armed {
                    armed.objects.occlusion_pools.remove(pool);
                }
                next(device, pool, allocator);
                answer.made();
            }
        },
    );
}
