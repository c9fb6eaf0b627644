//! The application's VkInstance and VkDevice, made in any of the orders that OpenXR allows.

mod enable;
mod enable2;

use crate::failure::Failure;
use crate::options::{Enable, Options, VulkanVersion};
use crate::xr::Xr;
use ash::vk;
use ash::vk::Handle as _;
use libloading::Library;
use openxr_sys as xr;
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::null;

/// The device, and the queue that the session is bound to.
pub struct Vulkan {
    pub instance: ash::Instance,
    pub physical_device: vk::PhysicalDevice,
    pub device: ash::Device,
    pub queue_family: u32,
    pub queue: vk::Queue,
    _library: Library,
}

/// The XrInstance and the Vulkan device, created in the order that the options ask for.
pub fn create(options: &Options, extensions: &[&CStr]) -> Result<(Xr, Vulkan), Failure> {
    match (options.enable, options.vulkan_first) {
        (Enable::One, true) => {
            let vulkan = Vulkan::before_openxr((options.vulkan, &options.engine))?;
            let xr = Xr::create(options, extensions)?;
            enable::require_same_device(&xr, &vulkan)?;
            Ok((xr, vulkan))
        }
        (Enable::One, false) => {
            let xr = Xr::create(options, extensions)?;
            let vulkan = enable::create(&xr, (options.vulkan, &options.engine))?;
            Ok((xr, vulkan))
        }
        (Enable::Two, false) => {
            let xr = Xr::create(options, extensions)?;
            let vulkan = enable2::create(&xr, (options.vulkan, &options.engine))?;
            Ok((xr, vulkan))
        }
        (Enable::Two, true) => Err(Failure::Unsupported(
            "--vulkan-first needs --enable 1: with enable2 the runtime creates the instance".to_owned(),
        )),
    }
}

impl Vulkan {
    /// The graphics binding of an XrSession.
    pub fn binding(&self) -> xr::GraphicsBindingVulkanKHR {
        xr::GraphicsBindingVulkanKHR {
            ty: xr::GraphicsBindingVulkanKHR::TYPE,
            next: null(),
            instance: self.instance.handle().as_raw() as *const c_void,
            physical_device: self.physical_device.as_raw() as *const c_void,
            device: self.device.handle().as_raw() as *const c_void,
            queue_family_index: self.queue_family,
            queue_index: 0,
        }
    }

    /// An instance and a device that OpenXR does not know.
    pub fn apart() -> Result<Self, Failure> {
        Self::before_openxr((VulkanVersion::V1_1, c"none"))
    }

    /// Waits until the application's own work on the queue is done.
    pub fn wait_idle(&self) {
        // SAFETY: the queue is used by one thread at a time. An error means a lost device, where nothing is
        // left to wait for.
        let _ = unsafe { self.device.queue_wait_idle(self.queue) };
    }

    fn before_openxr(application: Application<'_>) -> Result<Self, Failure> {
        let (library, entry) = load()?;
        let instance = with_instance_info(application, &[], |info| {
            // SAFETY: the structure and the data that it points to outlive the call.
            Ok(unsafe { entry.create_instance(info, None) }?)
        })?;
        // SAFETY: the instance is live.
        let physical_device = unsafe { instance.enumerate_physical_devices() }?
            .first()
            .copied()
            .ok_or_else(|| Failure::Unsupported("no Vulkan device".to_owned()))?;
        let family = graphics_family(&instance, physical_device)?;
        let device = with_device_info(family, &[], |info| {
            // SAFETY: the physical device is this instance's; the structure outlives the call.
            Ok(unsafe { instance.create_device(physical_device, info, None) }?)
        })?;
        Ok(Self::assemble(library, instance, physical_device, device, family))
    }

    fn assemble(
        library: Library,
        instance: ash::Instance,
        physical_device: vk::PhysicalDevice,
        device: ash::Device,
        queue_family: u32,
    ) -> Self {
        // SAFETY: the device was created with one queue of this family.
        let queue = unsafe { device.get_device_queue(queue_family, 0) };
        Self { instance, physical_device, device, queue_family, queue, _library: library }
    }
}

impl Drop for Vulkan {
    fn drop(&mut self) {
        // SAFETY: sessions and swapchains borrow the application that holds this, so none is alive any more;
        // the queue is idle before the device goes.
        unsafe {
            let _ = self.device.device_wait_idle();
            self.device.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}

fn load() -> Result<(Library, ash::Entry), Failure> {
    // SAFETY: the loader's initialisers are meant to run in any process that asks for it.
    let library = unsafe { Library::new("libvulkan.so.1") }?;
    // SAFETY: the loader exports this function with this signature; the library is kept beside the entry.
    let entry = unsafe {
        ash::Entry::from_static_fn(ash::StaticFn {
            get_instance_proc_addr: *library.get(b"vkGetInstanceProcAddr\0")?,
        })
    };
    Ok((library, entry))
}

/// Requested version and engine name.
type Application<'a> = (VulkanVersion, &'a CStr);

fn with_instance_info<T>(
    (version, engine): Application<'_>,
    extensions: &[CString],
    create: impl FnOnce(&vk::InstanceCreateInfo) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let application = vk::ApplicationInfo::default()
        .application_name(c"parafovea-cases")
        .engine_name(engine)
        .api_version(version.encoded());
    let names = pointers(extensions);
    create(&vk::InstanceCreateInfo::default().application_info(&application).enabled_extension_names(&names))
}

fn with_device_info<T>(
    queue_family: u32,
    extensions: &[CString],
    create: impl FnOnce(&vk::DeviceCreateInfo) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let queues =
        [vk::DeviceQueueCreateInfo::default().queue_family_index(queue_family).queue_priorities(&[1.0])];
    let names = pointers(extensions);
    create(&vk::DeviceCreateInfo::default().queue_create_infos(&queues).enabled_extension_names(&names))
}

fn pointers(names: &[CString]) -> Vec<*const c_char> {
    names.iter().map(|name| name.as_ptr()).collect()
}

fn graphics_family(instance: &ash::Instance, physical_device: vk::PhysicalDevice) -> Result<u32, Failure> {
    // SAFETY: the physical device is this instance's.
    let families = unsafe { instance.get_physical_device_queue_family_properties(physical_device) };
    families
        .iter()
        .position(|family| family.queue_flags.contains(vk::QueueFlags::GRAPHICS))
        .map(|index| index as u32)
        .ok_or_else(|| Failure::Unsupported("no graphics queue".to_owned()))
}
