//! Interface between the OpenXR half and the Vulkan half: a versioned C table.
//!
//! The halves may be loaded from different paths, or as two copies with separate globals (containers), so
//! the OpenXR half never looks into the Vulkan half's memory. It asks the application's own Vulkan loader,
//! `vkGetDeviceProcAddr(device, "vkGetParafoveaLink")`, which only our Vulkan layer answers, and gets the
//! [`LinkTable`] of the copy in that device's chain.

mod records;

pub use records::{
    AwaitedPlan, BACKEND_ANY, BACKEND_MASK, BACKEND_NONE, BACKEND_RATE_ATTACHMENT, CapabilitiesRecord,
    DecisionRecord, EyeBufferRecord, EyeMapRecord, EyeViewRecord, FrameReportRecord, FrameStart,
    FrameTimeRecord, MOST_FRAME_TIMES, NO_EYE, NO_IMAGE, PlanRecord, RatesCopyRecord, SettingsRecord,
    ShownRecord, ShownViewRecord, StaleRecord, SwapchainRecord,
};

use ash::vk;
use std::ffi::{CStr, c_char, c_void};

/// The name that the Vulkan half's `vkGetDeviceProcAddr` answers with a [`GetLink`]. It begins as Vulkan's names do: for others, newer
/// loaders (1.4.309 is one, 1.3.239 is not) ask no layer, and answer with null.
pub const GET_LINK_NAME: &CStr = c"vkGetParafoveaLink";

/// Version of [`LinkTable`] and [`DeviceRecord`]; halves with different versions stay inert.
pub const LINK_VERSION: u32 = 23;

/// Signature behind [`GET_LINK_NAME`]: the table, valid for the life of the process.
pub type GetLink = unsafe extern "C" fn() -> *const LinkTable;

/// Nothing is copied, because the plan's own rates hold.
pub const RATES_OF_PLAN: u32 = 0;
/// The copy was submitted.
pub const RATES_COPIED: u32 = 1;
/// The GPU decided, and nothing is copied, because too much is in progress, or a call failed.
pub const RATES_COPY_LEFT_OUT: u32 = 2;

/// A callback before the application's vkDestroyDevice, while the device is still live.
pub type DestroyDeviceCallback = unsafe extern "C" fn(device: vk::Device);

/// Functions of the Vulkan half for the OpenXR half.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct LinkTable {
    /// [`LINK_VERSION`] of the library that made this table.
    pub version: u32,
    /// `size_of::<LinkTable>()` of that library.
    pub size: u32,
    /// Writes the record of a live device to `record`; returns 1, or 0 when the device is not tracked.
    pub device: unsafe extern "C" fn(device: vk::Device, record: *mut DeviceRecord) -> u32,
    /// Marks the device active (1: an OpenXR session is bound to it) or armed again (0).
    pub set_active: unsafe extern "C" fn(device: vk::Device, active: u32),
    /// Enters (1) or leaves (0) a section of this thread whose submits are the runtime's or ours, not the
    /// application's. Sections nest.
    pub runtime_section: unsafe extern "C" fn(enter: u32),
    /// Writes the abilities of the device's backend, which never change, to `record`; returns 1, or 0 when the device is not armed.
    pub capabilities: unsafe extern "C" fn(device: vk::Device, record: *mut CapabilitiesRecord) -> u32,
    /// Sends the images of a swapchain, or the notice that they are about to be destroyed.
    pub swapchain: unsafe extern "C" fn(device: vk::Device, record: *const SwapchainRecord),
    /// Starts a frame with the settings and the plan that are new in it; not called in frames without any.
    pub begin_frame: unsafe extern "C" fn(device: vk::Device, start: *const FrameStart),
    /// Analyses so many finished eye buffers, between the submits that wrote them and the return of their images to the runtime, in a section of
    /// the runtime. All have the same queue.
    pub eye_buffers: unsafe extern "C" fn(device: vk::Device, records: *const EyeBufferRecord, count: u32),
    /// Sends the view of an eye buffer, at the end of the frame that shows it; ignored unless [`Self::eye_buffers`] was called for its
    /// picture.
    pub eye_view: unsafe extern "C" fn(device: vk::Device, record: *const EyeViewRecord),
    /// Ends the device's frame with its submission, before or after the runtime's xrEndFrame. Writes the report on it to `report`; returns 1,
    /// or 0 when the device is not armed. It waits for nothing.
    pub end_frame: unsafe extern "C" fn(
        device: vk::Device,
        submission: *const ShownRecord,
        report: *mut FrameReportRecord,
    ) -> u32,
    /// Writes the stale tiles of an eye buffer (0: left, 1: right) in the last frame to `record`, as [`Self::end_frame`] does: for words
    /// that had no room there. Returns 1, or 0 if everything is fresh.
    pub stale: unsafe extern "C" fn(device: vk::Device, eye: u32, record: *mut StaleRecord) -> u32,
    /// Copies the rates that the GPU decided last for an eye, in a submit of its own, in a section of the runtime. Returns
    /// [`RATES_COPIED`], [`RATES_OF_PLAN`] or [`RATES_COPY_LEFT_OUT`].
    pub copy_rates: unsafe extern "C" fn(device: vk::Device, record: *const RatesCopyRecord) -> u32,
    /// Has `call` called once when the application destroys the device, before the device is gone. Returns 1, or 0 when the device
    /// is not armed.
    pub on_device_destroyed: unsafe extern "C" fn(device: vk::Device, call: DestroyDeviceCallback) -> u32,
    /// The layout in which the application's submits left a swapchain's image; COLOR_ATTACHMENT_OPTIMAL, as OpenXR has it, for an image
    /// with an unknown layout.
    pub layout: unsafe extern "C" fn(device: vk::Device, image: vk::Image) -> vk::ImageLayout,
    /// Whether the application's submits to queues other than that one (family, index) have used a swapchain's image, or, before
    /// any submit with it, could: 1, or 0.
    pub is_used_on_other_queues:
        unsafe extern "C" fn(device: vk::Device, image: vk::Image, queue: *const [u32; 2]) -> u32,
    /// Writes the decision of that index, counted from 0 over all devices of the process, to `record`; returns 1, or 0 if there are fewer.
    /// It waits for nothing.
    pub decision: unsafe extern "C" fn(index: u32, record: *mut DecisionRecord) -> u32,
}

/// One device as the Vulkan half tracked it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct DeviceRecord {
    /// The instance that the device belongs to.
    pub instance: vk::Instance,
    /// The physical device that it was made from.
    pub physical_device: vk::PhysicalDevice,
    /// The device itself, as the application knows it.
    pub device: vk::Device,
    /// The Vulkan version both the application asked for and the device has (`vk::make_api_version`).
    pub api_version: u32,
    /// The next layer's `vkGetInstanceProcAddr`. Good for questions about the physical device: where the next
    /// is the Vulkan loader itself, it answers with the top of the chain once the instance is made.
    pub next_get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    /// The next layer's (or driver's) `vkGetDeviceProcAddr`: calls through it bypass the layers above us.
    pub next_get_device_proc_addr: vk::PFN_vkGetDeviceProcAddr,
    /// The Vulkan loader's callback that must initialise every dispatchable object that we create
    /// (command buffers, queues) before it is used with the next layer's functions.
    pub set_device_loader_data:
        unsafe extern "system" fn(device: vk::Device, object: *mut c_void) -> vk::Result,
    /// The next layer's `vkQueueSubmit`, one call at a time on each queue, the application's included; `None`: as the next layer has it.
    pub queue_submit: Option<vk::PFN_vkQueueSubmit>,
    /// [`Arming`](crate::config::Arming) of the device.
    pub arming: u32,
    /// 1 where the draws to an image may be submitted after its xrReleaseSwapchainImage, before xrEndFrame; else 0.
    pub submits_late: u32,
}

/// `vkGetDeviceProcAddr` as the application's Vulkan loader exports it.
pub type LoaderGetDeviceProcAddr =
    unsafe extern "system" fn(device: vk::Device, name: *const c_char) -> vk::PFN_vkVoidFunction;
