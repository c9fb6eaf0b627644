//! Hooks of queues and query pools.

use crate::vk::device;
use crate::vk::objects::QueueId;
use ash::vk;

/// `vkGetDeviceQueue`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn get(device: vk::Device, family: u32, index: u32, queue: *mut vk::Queue) {
    hook!("vkGetDeviceQueue", device::with, get_device_queue(device, family, index, queue), |known, next| {
        next();
        if let Some(armed) = &known.armed {
            // SAFETY: the pointer is valid, by valid usage, and the call has written the queue.
            armed.objects.queues.insert(unsafe { *queue }, QueueId { family, index });
        }
    });
}

/// `vkGetDeviceQueue2`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn get2(
    device: vk::Device,
    info: *const vk::DeviceQueueInfo2<'_>,
    queue: *mut vk::Queue,
) {
    hook!("vkGetDeviceQueue2", device::with, get_device_queue2(device, info, queue), |known, next| {
        next();
        // SAFETY: both pointers are valid, by valid usage, and the call has written the queue.
        let (info, queue) = unsafe { (&*info, *queue) };
        // Protected queues take protected work only.
        if let Some(armed) = &known.armed
            && queue != vk::Queue::null()
            && !info.flags.contains(vk::DeviceQueueCreateFlags::PROTECTED)
        {
            let id = QueueId { family: info.queue_family_index, index: info.queue_index };
            armed.objects.queues.insert(queue, id);
        }
    });
}

/// `vkCreateQueryPool`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create_query_pool(
    device: vk::Device,
    info: *const vk::QueryPoolCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pool: *mut vk::QueryPool,
) -> vk::Result {
    hook!(
        "vkCreateQueryPool",
        device::with,
        create_query_pool(device, info, allocator, pool),
        |known, next| {
            let result = next();
            if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                // SAFETY: both pointers are valid, by valid usage, and the call has written the pool.
                let (kind, pool) = unsafe { ((*info).query_type, *pool) };
                if kind == vk::QueryType::OCCLUSION {
                    armed.objects.occlusion_pools.insert(pool, ());
                }
            }
            result
        }
    )
}

/// `vkDestroyQueryPool`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy_query_pool(
    device: vk::Device,
    pool: vk::QueryPool,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!("vkDestroyQueryPool", device::with, destroy_query_pool(device, pool, allocator), |known, next| {
        if let Some(armed) = &known.armed {
            armed.objects.occlusion_pools.remove(pool);
        }
        next();
    });
}
