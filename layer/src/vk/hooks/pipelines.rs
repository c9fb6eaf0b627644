//! Hooks of graphics pipelines.

use crate::abi::copies::slice;
use crate::vk::device;
use crate::vk::hooks::by_identifier;
use crate::vk::runtime_section::in_runtime_section;
use crate::vk::shaders::parts::has_static_viewports;
use ash::vk;

/// `vkCreateGraphicsPipelines`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create_pipelines(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::GraphicsPipelineCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::Pipeline,
) -> vk::Result {
    hook!(
        "vkCreateGraphicsPipelines",
        device::with,
        create_graphics_pipelines(device, cache, count, infos, allocator, made),
        |known, next, answer| {
            if let Some(armed) = known.armed.as_ref().filter(|_| !in_runtime_section()) {
                // SAFETY: valid usage demands `count` valid structures.
                let is_any = unsafe { slice(infos, count).iter().any(|info| has_static_viewports(info)) };
                if is_any {
                    armed.note_static_viewports();
                }
            }
            let create = |count, infos, made| match known.rate_attachments() {
                Some(rates) => {
                    let functions = (next, known.hooked.destroy_pipeline);
                    // SAFETY: some of the application's own structures, and the next layer's functions for them.
                    unsafe { rates.create_pipelines(device, cache, count, infos, allocator, made, functions) }
                }
                // SAFETY: the next layer's function, with some of the application's own structures.
                None => unsafe { next(device, cache, count, infos, allocator, made) },
            };
            // SAFETY: the application's own arguments.
            let result =
                answer.record(unsafe { by_identifier::create(&known, (device, infos, count), made, create) });
            if let (Some(masks), true) = (known.masks(), result.as_raw() >= 0) {
                // SAFETY: valid usage demands `count` structures; the call has written as many pipelines, null for each one that failed.
                unsafe { masks.add_pipelines(infos, made, count) };
            }
            result
        }
    )
}

/// `vkDestroyPipeline`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy_pipeline(
    device: vk::Device,
    pipeline: vk::Pipeline,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!("vkDestroyPipeline", device::with, destroy_pipeline(device, pipeline, allocator), |known, next| {
        if let Some(rates) = known.rate_attachments() {
            rates.forget_pipeline(pipeline);
        }
        if let Some(masks) = known.masks() {
            masks.forget_pipeline(pipeline);
        }
        next();
    });
}
