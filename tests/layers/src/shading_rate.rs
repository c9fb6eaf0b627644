//! A layer that makes a device without `VK_KHR_fragment_shading_rate` look as if it had it, checks its use against
//! the specification, and records the map of every executed pass.
//!
//! It stands in for several devices ([`ShadingRateProfile`]), and must be above the validation layer, to which it
//! passes nothing of the extension: structures are left out, flags and layouts replaced (`lower`). A render pass
//! keeps its rate attachment as one that no subpass uses. Ahead of each pass with a rate attachment the layer
//! copies the map into a buffer (`capture`), and reads it when the submit has completed (`submit`).
//!
//! Findings are Valid Usage IDs where the specification has one, and the layer's own rules where not: the map must
//! be loaded, readable at the rate stage when the pass begins (`replay`), and hold only rates of the device
//! (`map`). The writes of a dispatch to the image are not followed; validation below reports a missing barrier
//! there, at the layer's copy.
//!
//! Not emulated: the shaders' own rates (`PrimitiveShadingRateKHR`, `ShadingRateKHR`), and the look: every pixel is
//! shaded, with any map. A layout of the extension in a descriptor, which is never legal, goes down as it is, for
//! validation to find.

mod barrier;
mod capture;
mod chain;
mod device;
mod device_limits;
mod draw;
mod findings;
mod framebuffer;
mod image;
mod lines;
mod lower;
mod map;
mod pass;
mod physical_device;
mod pipeline;
mod profile;
mod rate;
mod recording;
mod render_pass;
mod rendering;
mod replay;
mod state;
mod submit;
mod transfer;

pub use device_limits::{ShadingRate, ShadingRateDevice, ShadingRateLimits};
pub use lines::{
    SHADING_RATE_FILE_VARIABLE, SHADING_RATE_TEXELS_VARIABLE, ShadingRateFinding, ShadingRateLine,
    ShadingRateMap, ShadingRatePass,
};
pub use profile::{SHADING_RATE_GPU_VARIABLE, SHADING_RATE_PROFILE_VARIABLE, ShadingRateProfile};

use crate::functions::functions;
use crate::layer::{Instance, Layer, NextDevice, Tracked, device_of, hooks};
use ash::vk;
use device::Enabled;
use state::State;
use std::ffi::CStr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

functions! {
    /// The next layer's functions that may be missing, or have a name in an extension only.
    Functions {
        create_render_pass2: PFN_vkCreateRenderPass2 = c"vkCreateRenderPass2" | c"vkCreateRenderPass2KHR";
        begin_render_pass2: PFN_vkCmdBeginRenderPass2 = c"vkCmdBeginRenderPass2" | c"vkCmdBeginRenderPass2KHR";
        next_subpass2: PFN_vkCmdNextSubpass2 = c"vkCmdNextSubpass2" | c"vkCmdNextSubpass2KHR";
        end_render_pass2: PFN_vkCmdEndRenderPass2 = c"vkCmdEndRenderPass2" | c"vkCmdEndRenderPass2KHR";
        begin_rendering: PFN_vkCmdBeginRendering = c"vkCmdBeginRendering" | c"vkCmdBeginRenderingKHR";
        end_rendering: PFN_vkCmdEndRendering = c"vkCmdEndRendering" | c"vkCmdEndRenderingKHR";
        pipeline_barrier2: PFN_vkCmdPipelineBarrier2 = c"vkCmdPipelineBarrier2" | c"vkCmdPipelineBarrier2KHR";
        set_event2: PFN_vkCmdSetEvent2 = c"vkCmdSetEvent2" | c"vkCmdSetEvent2KHR";
        reset_event2: PFN_vkCmdResetEvent2 = c"vkCmdResetEvent2" | c"vkCmdResetEvent2KHR";
        wait_events2: PFN_vkCmdWaitEvents2 = c"vkCmdWaitEvents2" | c"vkCmdWaitEvents2KHR";
        write_timestamp2: PFN_vkCmdWriteTimestamp2 = c"vkCmdWriteTimestamp2" | c"vkCmdWriteTimestamp2KHR";
        queue_submit2: PFN_vkQueueSubmit2 = c"vkQueueSubmit2" | c"vkQueueSubmit2KHR";
        draw_indirect_count: PFN_vkCmdDrawIndirectCount
            = c"vkCmdDrawIndirectCount" | c"vkCmdDrawIndirectCountKHR";
        draw_indexed_indirect_count: PFN_vkCmdDrawIndexedIndirectCount
            = c"vkCmdDrawIndexedIndirectCount" | c"vkCmdDrawIndexedIndirectCountKHR";
        copy_buffer_to_image2: PFN_vkCmdCopyBufferToImage2
            = c"vkCmdCopyBufferToImage2" | c"vkCmdCopyBufferToImage2KHR";
        copy_image2: PFN_vkCmdCopyImage2 = c"vkCmdCopyImage2" | c"vkCmdCopyImage2KHR";
        image_memory_requirements: PFN_vkGetDeviceImageMemoryRequirements
            = c"vkGetDeviceImageMemoryRequirements" | c"vkGetDeviceImageMemoryRequirementsKHR";
    }
}

/// The layer's state of a device.
pub(crate) struct Emulator {
    next: NextDevice,
    functions: Functions,
    profile: ShadingRateProfile,
    enabled: Enabled,
    state: Mutex<State>,
}

static TRACKED: Tracked<Emulator> = Tracked::new();

impl Emulator {
    /// State of the device's objects. It is held during calls down, none of which comes back here.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next layer's functions of Vulkan 1.0.
    fn v1_0(&self) -> &ash::DeviceFnV1_0 {
        self.next.functions.fp_v1_0()
    }
}

/// # Safety
///
/// `object` is a live device, queue or command buffer.
unsafe fn emulator(object: impl vk::Handle) -> Arc<Emulator> {
    // SAFETY: the caller vouches for it.
    match unsafe { device_of(object) } {
        Some(emulator) => emulator,
        None => panic!("an object of a device that was created without this layer"),
    }
}

impl Layer for Emulator {
    fn tracked() -> &'static Tracked<Self> {
        &TRACKED
    }

    /// # Safety
    /// As [`Layer::create_device`].
    unsafe fn create_device(
        instance: &Instance,
        physical_device: vk::PhysicalDevice,
        info: vk::DeviceCreateInfo<'_>,
        create: &mut dyn FnMut(&vk::DeviceCreateInfo<'_>) -> Result<NextDevice, vk::Result>,
    ) -> Result<Self, vk::Result> {
        // SAFETY: the caller vouches for handle and structure.
        unsafe { device::create(instance, physical_device, info, create) }
    }

    fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
        physical_device::hook(name)
            .or_else(|| objects(name))
            .or_else(|| commands(name))
            .or_else(|| draw::hook(name))
    }

    fn addition(name: &CStr) -> vk::PFN_vkVoidFunction {
        hooks! { name;
            c"vkGetPhysicalDeviceFragmentShadingRatesKHR":
                PFN_vkGetPhysicalDeviceFragmentShadingRatesKHR = physical_device::rates;
            c"vkCmdSetFragmentShadingRateKHR": PFN_vkCmdSetFragmentShadingRateKHR = draw::set_rate;
        }
        None
    }

    fn next(&self) -> &NextDevice {
        &self.next
    }

    fn device_destroyed(&self) {
        submit::finish(self);
    }

    fn device_left(&self) {
        submit::leave(self);
    }
}

fn objects(name: &CStr) -> vk::PFN_vkVoidFunction {
    hooks! { name;
        c"vkCreateImage": PFN_vkCreateImage = image::create;
        c"vkDestroyImage": PFN_vkDestroyImage = image::destroy;
        c"vkGetDeviceImageMemoryRequirements":
            PFN_vkGetDeviceImageMemoryRequirements = image::memory_requirements;
        c"vkGetDeviceImageMemoryRequirementsKHR":
            PFN_vkGetDeviceImageMemoryRequirements = image::memory_requirements;
        c"vkCreateImageView": PFN_vkCreateImageView = image::create_view;
        c"vkDestroyImageView": PFN_vkDestroyImageView = image::destroy_view;
        c"vkCreateRenderPass": PFN_vkCreateRenderPass = render_pass::create;
        c"vkCreateRenderPass2": PFN_vkCreateRenderPass2 = render_pass::create2;
        c"vkCreateRenderPass2KHR": PFN_vkCreateRenderPass2 = render_pass::create2;
        c"vkDestroyRenderPass": PFN_vkDestroyRenderPass = render_pass::destroy;
        c"vkCreateFramebuffer": PFN_vkCreateFramebuffer = framebuffer::create;
        c"vkDestroyFramebuffer": PFN_vkDestroyFramebuffer = framebuffer::destroy;
        c"vkCreateGraphicsPipelines": PFN_vkCreateGraphicsPipelines = pipeline::create;
        c"vkDestroyPipeline": PFN_vkDestroyPipeline = pipeline::destroy;
        c"vkQueueSubmit": PFN_vkQueueSubmit = submit::queue_submit;
        c"vkQueueSubmit2": PFN_vkQueueSubmit2 = submit::queue_submit2;
        c"vkQueueSubmit2KHR": PFN_vkQueueSubmit2 = submit::queue_submit2;
    }
    None
}

fn commands(name: &CStr) -> vk::PFN_vkVoidFunction {
    hooks! { name;
        c"vkDestroyCommandPool": PFN_vkDestroyCommandPool = recording::destroy_pool;
        c"vkResetCommandPool": PFN_vkResetCommandPool = recording::reset_pool;
        c"vkAllocateCommandBuffers": PFN_vkAllocateCommandBuffers = recording::allocate;
        c"vkFreeCommandBuffers": PFN_vkFreeCommandBuffers = recording::free;
        c"vkBeginCommandBuffer": PFN_vkBeginCommandBuffer = recording::begin;
        c"vkResetCommandBuffer": PFN_vkResetCommandBuffer = recording::reset;
        c"vkCmdExecuteCommands": PFN_vkCmdExecuteCommands = recording::execute;
        c"vkCmdBeginRenderPass": PFN_vkCmdBeginRenderPass = pass::begin_render_pass;
        c"vkCmdBeginRenderPass2": PFN_vkCmdBeginRenderPass2 = pass::begin_render_pass2;
        c"vkCmdBeginRenderPass2KHR": PFN_vkCmdBeginRenderPass2 = pass::begin_render_pass2;
        c"vkCmdNextSubpass": PFN_vkCmdNextSubpass = pass::next_subpass;
        c"vkCmdNextSubpass2": PFN_vkCmdNextSubpass2 = pass::next_subpass2;
        c"vkCmdNextSubpass2KHR": PFN_vkCmdNextSubpass2 = pass::next_subpass2;
        c"vkCmdEndRenderPass": PFN_vkCmdEndRenderPass = pass::end_render_pass;
        c"vkCmdEndRenderPass2": PFN_vkCmdEndRenderPass2 = pass::end_render_pass2;
        c"vkCmdEndRenderPass2KHR": PFN_vkCmdEndRenderPass2 = pass::end_render_pass2;
        c"vkCmdBeginRendering": PFN_vkCmdBeginRendering = rendering::begin_rendering;
        c"vkCmdBeginRenderingKHR": PFN_vkCmdBeginRendering = rendering::begin_rendering;
        c"vkCmdEndRendering": PFN_vkCmdEndRendering = rendering::end_rendering;
        c"vkCmdEndRenderingKHR": PFN_vkCmdEndRendering = rendering::end_rendering;
        c"vkCmdPipelineBarrier": PFN_vkCmdPipelineBarrier = barrier::pipeline_barrier;
        c"vkCmdPipelineBarrier2": PFN_vkCmdPipelineBarrier2 = barrier::pipeline_barrier2;
        c"vkCmdPipelineBarrier2KHR": PFN_vkCmdPipelineBarrier2 = barrier::pipeline_barrier2;
        c"vkCmdSetEvent": PFN_vkCmdSetEvent = barrier::set_event;
        c"vkCmdResetEvent": PFN_vkCmdResetEvent = barrier::reset_event;
        c"vkCmdWaitEvents": PFN_vkCmdWaitEvents = barrier::wait_events;
        c"vkCmdSetEvent2": PFN_vkCmdSetEvent2 = barrier::set_event2;
        c"vkCmdSetEvent2KHR": PFN_vkCmdSetEvent2 = barrier::set_event2;
        c"vkCmdResetEvent2": PFN_vkCmdResetEvent2 = barrier::reset_event2;
        c"vkCmdResetEvent2KHR": PFN_vkCmdResetEvent2 = barrier::reset_event2;
        c"vkCmdWaitEvents2": PFN_vkCmdWaitEvents2 = barrier::wait_events2;
        c"vkCmdWaitEvents2KHR": PFN_vkCmdWaitEvents2 = barrier::wait_events2;
        c"vkCmdWriteTimestamp": PFN_vkCmdWriteTimestamp = barrier::write_timestamp;
        c"vkCmdWriteTimestamp2": PFN_vkCmdWriteTimestamp2 = barrier::write_timestamp2;
        c"vkCmdWriteTimestamp2KHR": PFN_vkCmdWriteTimestamp2 = barrier::write_timestamp2;
        c"vkCmdCopyBufferToImage": PFN_vkCmdCopyBufferToImage = transfer::copy_buffer_to_image;
        c"vkCmdCopyBufferToImage2": PFN_vkCmdCopyBufferToImage2 = transfer::copy_buffer_to_image2;
        c"vkCmdCopyBufferToImage2KHR": PFN_vkCmdCopyBufferToImage2 = transfer::copy_buffer_to_image2;
        c"vkCmdCopyImage": PFN_vkCmdCopyImage = transfer::copy_image;
        c"vkCmdCopyImage2": PFN_vkCmdCopyImage2 = transfer::copy_image2;
        c"vkCmdCopyImage2KHR": PFN_vkCmdCopyImage2 = transfer::copy_image2;
        c"vkCmdClearColorImage": PFN_vkCmdClearColorImage = transfer::clear_color_image;
    }
    None
}
