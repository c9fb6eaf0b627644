//! The Vulkan device that OpenXR creates, as a wgpu device.

use std::ffi::c_void;

use anyhow::{Context, Result, anyhow, bail};
use ash::vk::{self, Handle};
use openxr as xr;
use wgpu::hal::{self, api::Vulkan};

/// The device of the headset.
pub struct Graphics {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    /// Keeps the VkInstance: wgpu destroys it with this.
    instance: wgpu::Instance,
    session_info: xr::vulkan::SessionCreateInfo,
}

impl Graphics {
    /// Creates instance and device through XR_KHR_vulkan_enable2 with wgpu's requirements.
    ///
    /// # Errors
    /// If there is no Vulkan, no GPU for the headset, or it is too old.
    pub fn new(xr_instance: &xr::Instance, system: xr::SystemId) -> Result<Self> {
        // SAFETY: the library that is installed as the Vulkan loader is taken to be one.
        let entry =
            unsafe { ash::Entry::load() }.context("the Vulkan loader cannot be loaded; is it installed?")?;
        let version = check_version(&entry, xr_instance, system)?;
        let flags = wgpu::InstanceFlags::default().with_env();
        let extensions = hal::vulkan::Instance::desired_extensions(&entry, version, flags)?;
        let raw_instance = create_instance(&entry, xr_instance, system, version, &extensions)?;
        // SAFETY: the instance is live and was made with XR_KHR_vulkan_enable2.
        let physical = unsafe {
            xr_instance.vulkan_graphics_device(system, raw_instance.handle().as_raw() as *const c_void)
        }
        .context("the runtime names no GPU for the headset")?;
        let physical = vk::PhysicalDevice::from_raw(physical as u64);
        // SAFETY: made from this entry with this version, these extensions and flags; no other code destroys it.
        let hal_instance = unsafe {
            hal::vulkan::Instance::from_raw(
                entry.clone(),
                raw_instance.clone(),
                version,
                0,
                None,
                extensions,
                flags,
                wgpu::MemoryBudgetThresholds::default(),
                false,
                None,
            )
        }?;
        let hal_adapter =
            hal_instance.expose_adapter(physical).context("wgpu does not support the headset's GPU")?;
        let family = graphics_family(&raw_instance, physical)?;
        let limits = wgpu::Limits::default();
        let hal_device =
            open_device(&entry, &raw_instance, xr_instance, system, &hal_adapter.adapter, family, &limits)?;
        let session_info = xr::vulkan::SessionCreateInfo {
            instance: raw_instance.handle().as_raw() as *const c_void,
            physical_device: physical.as_raw() as *const c_void,
            device: hal_device.device.raw_device().handle().as_raw() as *const c_void,
            queue_family_index: family,
            queue_index: 0,
        };
        // SAFETY: the instance is of the Vulkan backend and ours to give away.
        let instance = unsafe { wgpu::Instance::from_hal::<Vulkan>(hal_instance) };
        // SAFETY: exposed by that instance.
        let adapter = unsafe { instance.create_adapter_from_hal(hal_adapter) };
        let descriptor = wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
        // SAFETY: opened from that adapter; the descriptor asks for the features it was opened with, none.
        let (device, queue) = unsafe { adapter.create_device_from_hal(hal_device, &descriptor) }?;
        Ok(Self { device, queue, instance, session_info })
    }

    /// Creates a session on this device, which it keeps alive.
    ///
    /// # Errors
    /// Errors of xrCreateSession.
    pub fn create_session(
        &self,
        instance: &xr::Instance,
        system: xr::SystemId,
    ) -> Result<(xr::Session<xr::Vulkan>, xr::FrameWaiter, xr::FrameStream<xr::Vulkan>)> {
        let guard = (self.device.clone(), self.queue.clone(), self.instance.clone());
        // SAFETY: instance, physical device and device came from XR_KHR_vulkan_enable2, live as long as the
        // guard, and the queue is used by one thread only.
        unsafe { instance.create_session_with_guard(system, &self.session_info, Box::new(guard)) }
            .context("creating the session")
    }
}

/// The Vulkan version to request: the highest one that wgpu's backend uses, if the runtime agrees.
fn check_version(entry: &ash::Entry, instance: &xr::Instance, system: xr::SystemId) -> Result<u32> {
    // SAFETY: the entry is loaded.
    let available = unsafe { entry.try_enumerate_instance_version() }?.unwrap_or(vk::API_VERSION_1_0);
    let version = available.min(vk::API_VERSION_1_3);
    let needs = instance.graphics_requirements::<xr::Vulkan>(system)?;
    let asked =
        xr::Version::new(vk::api_version_major(version) as u16, vk::api_version_minor(version) as u16, 0);
    if asked < needs.min_api_version_supported {
        bail!("the runtime needs Vulkan {}, here is {asked}", needs.min_api_version_supported);
    }
    Ok(version)
}

fn create_instance(
    entry: &ash::Entry,
    xr_instance: &xr::Instance,
    system: xr::SystemId,
    version: u32,
    extensions: &[&'static std::ffi::CStr],
) -> Result<ash::Instance> {
    let application =
        vk::ApplicationInfo::default().application_name(c"parafovea-scene").api_version(version);
    let names: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
    let info =
        vk::InstanceCreateInfo::default().application_info(&application).enabled_extension_names(&names);
    // SAFETY: the create info and all that it points to outlive the call.
    let instance = unsafe {
        xr_instance.create_vulkan_instance(system, get_instance_proc_addr(entry), (&raw const info).cast())
    }?
    .map_err(|result| anyhow!(vk::Result::from_raw(result)))
    .context("creating the Vulkan instance")?;
    // SAFETY: the handle was just created through this entry.
    Ok(unsafe { ash::Instance::load(entry.static_fn(), vk::Instance::from_raw(instance as u64)) })
}

fn graphics_family(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Result<u32> {
    // SAFETY: the physical device is of this instance.
    unsafe { instance.get_physical_device_queue_family_properties(physical) }
        .iter()
        .position(|family| family.queue_flags.contains(vk::QueueFlags::GRAPHICS))
        .map(|index| index as u32)
        .context("the headset's GPU has no graphics queue")
}

fn open_device(
    entry: &ash::Entry,
    instance: &ash::Instance,
    xr_instance: &xr::Instance,
    system: xr::SystemId,
    adapter: &hal::vulkan::Adapter,
    family: u32,
    limits: &wgpu::Limits,
) -> Result<hal::OpenDevice<Vulkan>> {
    let features = wgpu::Features::empty();
    let extensions = adapter.required_device_extensions(features);
    let mut wanted = adapter.physical_device_features(&extensions, features);
    let names: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
    let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0])];
    let info = wanted.add_to_device_create(
        vk::DeviceCreateInfo::default().queue_create_infos(&queues).enabled_extension_names(&names),
    );
    let physical = adapter.raw_physical_device().as_raw() as *const c_void;
    // SAFETY: the physical device is the runtime's choice; the create info outlives the call.
    let device = unsafe {
        xr_instance.create_vulkan_device(
            system,
            get_instance_proc_addr(entry),
            physical,
            (&raw const info).cast(),
        )
    }?
    .map_err(|result| anyhow!(vk::Result::from_raw(result)))
    .context("creating the Vulkan device")?;
    // SAFETY: the handle was just created from this instance.
    let device = unsafe { ash::Device::load(instance.fp_v1_0(), vk::Device::from_raw(device as u64)) };
    let memory = wgpu::MemoryHints::default();
    // SAFETY: created from this adapter with its features, these extensions and one queue of this family.
    Ok(unsafe { adapter.device_from_raw(device, None, &extensions, features, limits, &memory, family, 0) }?)
}

/// The Vulkan loader's entry point in the type that the OpenXR crate wants.
fn get_instance_proc_addr(entry: &ash::Entry) -> xr::sys::platform::VkGetInstanceProcAddr {
    let function = entry.static_fn().get_instance_proc_addr;
    // SAFETY: both are vkGetInstanceProcAddr of the Vulkan headers; only the crates' names for the handle and
    // for the returned function pointer differ, both of one pointer's size.
    unsafe {
        std::mem::transmute::<vk::PFN_vkGetInstanceProcAddr, xr::sys::platform::VkGetInstanceProcAddr>(
            function,
        )
    }
}
