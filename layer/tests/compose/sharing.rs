//! Shared objects of sessions on one device, and their end.

use crate::vulkan::Vulkan;
use ash::vk;
use parafovea::gpu::{Gpu, Shared};
use parafovea::kernels::compose::Compose;
use parafovea::link::DeviceRecord;
use std::ffi::{CStr, c_char};
use std::mem::transmute;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::sleep;
use std::time::Duration;

static NEXT: OnceLock<vk::PFN_vkGetDeviceProcAddr> = OnceLock::new();
static CREATE: OnceLock<vk::PFN_vkCreateGraphicsPipelines> = OnceLock::new();
static DESTROY: OnceLock<vk::PFN_vkDestroyPipeline> = OnceLock::new();
static DESTROY_BUFFER: OnceLock<vk::PFN_vkDestroyBuffer> = OnceLock::new();

/// Pipelines made, pipelines destroyed, and buffers destroyed.
static CALLS: [AtomicU32; 3] = [const { AtomicU32::new(0) }; 3];

/// A device whose calls are counted. Tests with a device run one at a time.
fn counted() -> (Vulkan, Arc<Shared>) {
    let vulkan = Vulkan::with(|mut record| {
        NEXT.get_or_init(|| record.next_get_device_proc_addr);
        record.next_get_device_proc_addr = counting;
        record
    });
    CALLS.iter().for_each(|count| count.store(0, Ordering::Relaxed));
    // SAFETY: the device is never destroyed.
    let shared = unsafe { Shared::new(&vulkan.record) }.unwrap();
    (vulkan, shared)
}

fn calls() -> [u32; 3] {
    CALLS.each_ref().map(|count| count.load(Ordering::Relaxed))
}

/// The compositor of a session that draws to one format.
fn session(record: &DeviceRecord, shared: &Arc<Shared>) -> Compose {
    // SAFETY: the record is of a live device with this queue, which no other code uses now.
    let gpu = unsafe { Gpu::sharing(record, (0, 0), Arc::clone(shared)) }.unwrap();
    let mut compose = Compose::new(gpu).unwrap();
    while !compose.attenuates(vk::Format::R8G8B8A8_SRGB) {
        sleep(Duration::from_millis(1));
    }
    compose
}

#[test]
fn a_pipeline_is_made_once_for_all_sessions_and_goes_when_the_device_ends() {
    let (vulkan, shared) = counted();
    let at_once = [session(&vulkan.record, &shared), session(&vulkan.record, &shared)];
    drop(at_once);
    drop(session(&vulkan.record, &shared));
    let [made, destroyed, buffers] = calls();
    assert_eq!([made, destroyed], [1, 0]);
    assert!(buffers >= 3, "what is a session's own goes with it: {buffers}");
    shared.end();
    assert_eq!(calls(), [1, 1, buffers]);
    vulkan.assert_valid();
}

#[test]
fn a_device_that_ends_before_its_session_is_not_called_any_more() {
    let (vulkan, shared) = counted();
    let ended = session(&vulkan.record, &shared);
    let left = session(&vulkan.record, &shared);
    drop(ended);
    let before = calls();
    shared.end();
    drop((left, shared));
    assert_eq!(calls(), before);
    vulkan.assert_valid();
}

unsafe extern "system" fn counting(device: vk::Device, name: *const c_char) -> vk::PFN_vkVoidFunction {
    type Function = unsafe extern "system" fn();
    // SAFETY: names are C strings, and give the functions' types; the device is live.
    unsafe {
        let next = NEXT.get().unwrap()(device, name)?;
        Some(match CStr::from_ptr(name).to_bytes() {
            b"vkCreateGraphicsPipelines" => {
                CREATE.get_or_init(|| transmute::<Function, vk::PFN_vkCreateGraphicsPipelines>(next));
                transmute::<vk::PFN_vkCreateGraphicsPipelines, Function>(create)
            }
            b"vkDestroyPipeline" => {
                DESTROY.get_or_init(|| transmute::<Function, vk::PFN_vkDestroyPipeline>(next));
                transmute::<vk::PFN_vkDestroyPipeline, Function>(destroy)
            }
            b"vkDestroyBuffer" => {
                DESTROY_BUFFER.get_or_init(|| transmute::<Function, vk::PFN_vkDestroyBuffer>(next));
                transmute::<vk::PFN_vkDestroyBuffer, Function>(destroy_buffer)
            }
            _ => next,
        })
    }
}

unsafe extern "system" fn create(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::GraphicsPipelineCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pipelines: *mut vk::Pipeline,
) -> vk::Result {
    CALLS[0].fetch_add(count, Ordering::Relaxed);
    // SAFETY: the caller's own arguments.
    unsafe { CREATE.get().unwrap()(device, cache, count, infos, allocator, pipelines) }
}

unsafe extern "system" fn destroy(
    device: vk::Device,
    pipeline: vk::Pipeline,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    CALLS[1].fetch_add(1, Ordering::Relaxed);
    // SAFETY: the caller's own arguments.
    unsafe { DESTROY.get().unwrap()(device, pipeline, allocator) }
}

unsafe extern "system" fn destroy_buffer(
    device: vk::Device,
    buffer: vk::Buffer,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    CALLS[2].fetch_add(1, Ordering::Relaxed);
    // SAFETY: the caller's own arguments.
    unsafe { DESTROY_BUFFER.get().unwrap()(device, buffer, allocator) }
}
