//! Eleven Vulkan layers for tests and benches, and an OpenXR layer ([`CAPTURE_LAYER`]), in one library. Each is explicit, found through a manifest of its
//! own ([`TestLayer::manifest`]), which maps the loader's entry point to that layer's.
//!
//! - `VK_LAYER_PARAFOVEA_TEST_pass_through` does nothing: the baseline for the cost of any layer.
//! - `VK_LAYER_PARAFOVEA_TEST_above` does nothing either, above Parafovea.
//! - `VK_LAYER_PARAFOVEA_TEST_count` counts fragment shader invocations, draws and submits ([`Count`]).
//! - `VK_LAYER_PARAFOVEA_TEST_samples` counts the samples that pass depth and stencil tests in the application's render
//!   passes ([`SampleCount`]), below Parafovea, together with the former above it.
//! - `VK_LAYER_PARAFOVEA_TEST_times` times primary command buffers on the GPU ([`GpuTimes`]).
//! - `VK_LAYER_PARAFOVEA_TEST_drop_barrier` leaves out chosen image barriers, to see that their absence is
//!   noticed.
//! - `VK_LAYER_PARAFOVEA_TEST_shading_rate` makes a device look as if it had `VK_KHR_fragment_shading_rate`,
//!   and checks its use ([`ShadingRateLine`]).
//! - `VK_LAYER_PARAFOVEA_TEST_two_queues` gives a device with one queue a second one; it must be the lowest.
//! - `VK_LAYER_PARAFOVEA_TEST_faults` makes chosen calls fail, directly below Parafovea; `VK_LAYER_PARAFOVEA_TEST_calls`, above it,
//!   identifies the callers ([`VulkanFault`]).
//! - `VK_LAYER_PARAFOVEA_TEST_costs` plants the GPU time of frames, and runs none of them ([`PlantedCosts`]).
//! - `VK_LAYER_PARAFOVEA_TEST_live` counts live objects and device memory ([`LiveObjects`]), directly below Parafovea, with `calls` above it.
//!
//! # Order
//!
//! The Vulkan loader (as of 1.3.239) puts implicit layers nearest to the application, in the order in which it finds
//! their manifests, then the layers of `VK_INSTANCE_LAYERS`, in its order. Parafovea is implicit, so a layer named in
//! `VK_INSTANCE_LAYERS` is below it, and `drop_barrier:VK_LAYER_KHRONOS_validation` puts the former above the latter.
//! `shading_rate` must be below Parafovea and above the validation layer, to which it passes nothing of the extension.
//! To have a layer above Parafovea, name Parafovea in `VK_INSTANCE_LAYERS` too, behind that layer, and leave its
//! implicit manifest out; or make that layer implicit ([`TestLayer::implicit_manifest`]) and put its manifest into
//! `XDG_CONFIG_HOME`, which is searched before `XDG_DATA_HOME`.

mod capture;
mod costs;
mod count;
mod cpu_time;
mod drop_barrier;
mod faults;
mod functions;
mod interface;
mod layer;
mod live;
mod manifest;
mod pass_through;
mod report;
mod shading_rate;
mod two_queues;
pub mod validation;
mod variable;

pub use capture::{CAPTURE_FOLDER_VARIABLE, CAPTURE_LAYER, CapturedView, capture_manifest};
pub use costs::{COSTS_FILE_VARIABLE, COSTS_VARIABLE, CostsReport, PlantedCosts};
pub use count::{
    COUNT_FILE_VARIABLE, Count, Counted, GpuTime, GpuTimes, SAMPLES_FILE_VARIABLE, SampleCount,
    TIMES_FILE_VARIABLE,
};
pub use drop_barrier::{DROP_BARRIER_VARIABLE, DROP_FILE_VARIABLE, Dropped};
pub use faults::{FAULT_FILE_VARIABLE, FAULT_VARIABLE, FaultReport, VulkanFault, Whose};
pub use live::{BUDGET_VARIABLE, Holdings, LIVE_FILE_VARIABLE, LiveObjects};
pub use manifest::TestLayer;
pub use shading_rate::{
    SHADING_RATE_FILE_VARIABLE, SHADING_RATE_GPU_VARIABLE, SHADING_RATE_PROFILE_VARIABLE,
    SHADING_RATE_TEXELS_VARIABLE, ShadingRate, ShadingRateDevice, ShadingRateFinding, ShadingRateLimits,
    ShadingRateLine, ShadingRateMap, ShadingRatePass, ShadingRateProfile,
};

use ash::vk;
use interface::NegotiateLayerInterface;

/// The Vulkan loader's first call to the layer `pass_through`.
///
/// # Safety
///
/// Called by a Vulkan loader, with a valid structure.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn pass_through_vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader vouches for it.
    unsafe { layer::negotiate::<pass_through::PassThrough>(interface) }
}

/// The Vulkan loader's first call to the layer `above`.
///
/// # Safety
///
/// Called by a Vulkan loader, with a valid structure.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn above_vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader vouches for it.
    unsafe { layer::negotiate::<pass_through::Above>(interface) }
}

/// The Vulkan loader's first call to the layer `count`.
///
/// # Safety
///
/// Called by a Vulkan loader, with a valid structure.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn count_vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader vouches for it.
    unsafe { layer::negotiate::<count::Invocations>(interface) }
}

/// The Vulkan loader's first call to the layer `samples`.
///
/// # Safety
///
/// Called by a Vulkan loader, with a valid structure.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn samples_vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader vouches for it.
    unsafe { layer::negotiate::<count::Samples>(interface) }
}

/// The Vulkan loader's first call to the layer `times`.
///
/// # Safety
///
/// Called by a Vulkan loader, with a valid structure.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn times_vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader vouches for it.
    unsafe { layer::negotiate::<count::Times>(interface) }
}

/// The Vulkan loader's first call to the layer `drop_barrier`.
///
/// # Safety
///
/// Called by a Vulkan loader, with a valid structure.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn drop_barrier_vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader vouches for it.
    unsafe { layer::negotiate::<drop_barrier::DropBarrier>(interface) }
}

/// The Vulkan loader's first call to the layer `shading_rate`.
///
/// # Safety
///
/// Called by a Vulkan loader, with a valid structure.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn shading_rate_vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader vouches for it.
    unsafe { layer::negotiate::<shading_rate::Emulator>(interface) }
}

/// The Vulkan loader's first call to the layer `two_queues`.
///
/// # Safety
///
/// Called by a Vulkan loader, with a valid structure.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn two_queues_vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader vouches for it.
    unsafe { layer::negotiate::<two_queues::TwoQueues>(interface) }
}

/// The Vulkan loader's first call to the layer `calls`.
///
/// # Safety
///
/// Called by a Vulkan loader, with a valid structure.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn calls_vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader vouches for it.
    unsafe { layer::negotiate::<faults::Calls>(interface) }
}

/// The Vulkan loader's first call to the layer `faults`.
///
/// # Safety
///
/// Called by a Vulkan loader, with a valid structure.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn faults_vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader vouches for it.
    unsafe { layer::negotiate::<faults::Faults>(interface) }
}

/// The Vulkan loader's first call to the layer `costs`.
///
/// # Safety
///
/// Called by a Vulkan loader, with a valid structure.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn costs_vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader vouches for it.
    unsafe { layer::negotiate::<costs::Costs>(interface) }
}

/// The Vulkan loader's first call to the layer `live`.
///
/// # Safety
///
/// Called by a Vulkan loader, with a valid structure.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn live_vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader vouches for it.
    unsafe { layer::negotiate::<live::Live>(interface) }
}
