//! The Vulkan device, and everything that a style makes on it: destroyed together, at the end.

mod attachment;
mod buffer;
mod commands;
mod device;
mod heaps;
mod image;
mod libraries;
mod pass;
mod pipeline;
mod rates;
mod rates_file;
mod shading_rates;
mod subpasses;
mod transfer;

pub use attachment::Attachment;
pub use buffer::Buffer;
pub use device::Device;
use device::RATES;
pub use heaps::{HeapBinding, HeapFeatures, UniformHeap};
pub use image::{DEPTH, Image, ImageSpec};
pub use pass::{Kind, Pass, PassSpec, Target, passes};
pub use pipeline::{Depth, Making, PipelineSpec, Shader};
pub use rates::RatesUse;
pub use rates_file::RatesFile;
pub use subpasses::{Subpasses, SubpassesSpec};

use crate::support::{Demands, Feature, Features, Queues};
use crate::truth::PassSeen;
use anyhow::{Context, Result};
use ash::vk;
use openxr as xr;
use std::ffi::c_void;
use std::ops::Deref;
use std::sync::Mutex;
use std::sync::atomic::AtomicU64;

use ash::vk::Handle;
use rates::Rates;

/// The device that OpenXR chose, with one queue or two.
pub struct Gpu {
    pub instance: ash::Instance,
    pub physical: vk::PhysicalDevice,
    pub device: ash::Device,
    /// Families of the session's queue and of the second one.
    pub families: [u32; 2],
    /// Of the session.
    pub queue: vk::Queue,
    /// Another, or the same where there is one only.
    pub second_queue: vk::Queue,
    memory: vk::PhysicalDeviceMemoryProperties,
    made: Mutex<Vec<Made>>,
    begun: Mutex<Vec<PassSeen>>,
    /// Frames whose passes were taken.
    frames: AtomicU64,
    /// Maps of shading rates, if the application has any.
    rates: Option<Rates>,
    has_addresses: bool,
    /// Whether the instance goes with it.
    owns_instance: bool,
    entry: ash::Entry,
}

/// The device, or a feature that it lacks.
pub enum Opened {
    /// It has all that was asked for.
    Gpu(Box<Gpu>),
    /// It lacks this.
    Lacking(String),
}

/// Objects of the device, to be destroyed.
#[derive(Clone, Copy)]
pub enum Made {
    Buffer(vk::Buffer),
    CommandPool(vk::CommandPool),
    DescriptorPool(vk::DescriptorPool),
    Fence(vk::Fence),
    Framebuffer(vk::Framebuffer),
    Image(vk::Image),
    Memory(vk::DeviceMemory),
    Module(vk::ShaderModule),
    Pipeline(vk::Pipeline),
    PipelineLayout(vk::PipelineLayout),
    QueryPool(vk::QueryPool),
    RenderPass(vk::RenderPass),
    Sampler(vk::Sampler),
    Semaphore(vk::Semaphore),
    SetLayout(vk::DescriptorSetLayout),
    View(vk::ImageView),
}

impl Deref for Gpu {
    type Target = ash::Device;

    fn deref(&self) -> &ash::Device {
        &self.device
    }
}

impl Gpu {
    /// Makes instance and device through XR_KHR_vulkan_enable2; with `maps` passes that draw colour have these rates, or
    /// shaders know them.
    ///
    /// # Errors
    /// Errors of the calls, and maps that no device could have.
    pub fn open(
        xr_instance: &xr::Instance,
        system: xr::SystemId,
        demands: &Demands,
        maps: Option<(RatesUse, RatesFile)>,
    ) -> Result<Opened> {
        // SAFETY: the library that is installed as the Vulkan loader is taken to be one.
        let entry = unsafe { ash::Entry::load() }.context("the Vulkan loader cannot be loaded")?;
        xr_instance.graphics_requirements::<xr::Vulkan>(system)?;
        let application =
            vk::ApplicationInfo::default().application_name(c"parafovea-zoo").api_version(demands.vulkan);
        let info = vk::InstanceCreateInfo::default().application_info(&application);
        // SAFETY: the create info and all that it points to outlive the call.
        let instance = unsafe {
            xr_instance.create_vulkan_instance(system, entry_point(&entry), (&raw const info).cast())
        }?
        .map_err(vk::Result::from_raw)?;
        // SAFETY: the handle was just created through this entry.
        let instance =
            unsafe { ash::Instance::load(entry.static_fn(), vk::Instance::from_raw(instance as u64)) };
        // SAFETY: the instance is live and was made with XR_KHR_vulkan_enable2.
        let physical = unsafe {
            xr_instance.vulkan_graphics_device(system, instance.handle().as_raw() as *const c_void)
        }?;
        let physical = vk::PhysicalDevice::from_raw(physical as u64);
        if let Some(lacking) = demands.lacking(&instance, physical)? {
            // SAFETY: nothing was made from the instance.
            unsafe { instance.destroy_instance(None) };
            return Ok(Opened::Lacking(lacking));
        }
        let (families, queues) = graphics_families(&instance, physical, demands)?;
        let priorities = vec![1.0; queues as usize];
        let create = |info: &vk::DeviceCreateInfo| {
            // SAFETY: the physical device is the runtime's choice; the create info outlives the call.
            let device = unsafe {
                xr_instance.create_vulkan_device(
                    system,
                    entry_point(&entry),
                    physical.as_raw() as *const c_void,
                    std::ptr::from_ref(info).cast(),
                )
            };
            device.context("xrCreateVulkanDeviceKHR")
        };
        let queue_info = families.map(|family| {
            vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&priorities)
        });
        let queue_info = if families[0] == families[1] { &queue_info[..1] } else { &queue_info };
        let names = demands.extension_names();
        let names: Vec<_> = names.iter().map(|name| name.as_ptr()).collect();
        let device = Features::of(&demands.features).chained(&demands.features, |features| {
            let info = vk::DeviceCreateInfo::default()
                .queue_create_infos(queue_info)
                .enabled_extension_names(&names)
                .push_next(features);
            create(&info)
        })?;
        let device = device.map_err(vk::Result::from_raw)?;
        // SAFETY: the handle was just created from this instance.
        let device = unsafe { ash::Device::load(instance.fp_v1_0(), vk::Device::from_raw(device as u64)) };
        // SAFETY: the device has so many queues of these families.
        let (queue, second_queue) = unsafe {
            (device.get_device_queue(families[0], 0), device.get_device_queue(families[1], queues - 1))
        };
        // SAFETY: the physical device is of this instance.
        let memory = unsafe { instance.get_physical_device_memory_properties(physical) };
        let mut gpu = Self {
            instance,
            physical,
            device,
            families,
            queue,
            second_queue,
            memory,
            made: Mutex::default(),
            begun: Mutex::default(),
            frames: AtomicU64::new(0),
            rates: None,
            has_addresses: demands.features.contains(&Feature::BufferDeviceAddress),
            owns_instance: true,
            entry,
        };
        gpu.rates = maps.map(|(used, maps)| Rates::new(&gpu, used, maps)).transpose()?;
        Ok(Opened::Gpu(Box::new(gpu)))
    }

    /// Another device from the same instance, with one queue and nothing enabled.
    ///
    /// # Errors
    /// Errors of vkCreateDevice.
    pub fn another(&self) -> Result<Self> {
        let queue_info = [vk::DeviceQueueCreateInfo::default()
            .queue_family_index(self.families[0])
            .queue_priorities(&[1.0])];
        let info = vk::DeviceCreateInfo::default().queue_create_infos(&queue_info);
        // SAFETY: the physical device is of this instance; the structure outlives the call.
        let device = unsafe { self.instance.create_device(self.physical, &info, None) }?;
        // SAFETY: the device has one queue of this family.
        let queue = unsafe { device.get_device_queue(self.families[0], 0) };
        Ok(Self {
            instance: self.instance.clone(),
            device,
            queue,
            second_queue: queue,
            made: Mutex::default(),
            begun: Mutex::default(),
            frames: AtomicU64::new(0),
            rates: None,
            has_addresses: false,
            owns_instance: false,
            entry: self.entry.clone(),
            physical: self.physical,
            families: [self.families[0]; 2],
            memory: self.memory,
        })
    }

    /// Sharing mode of buffers and images, and the families that share them.
    fn sharing(&self) -> (vk::SharingMode, &[u32]) {
        match self.families[0] == self.families[1] {
            true => (vk::SharingMode::EXCLUSIVE, &[]),
            false => (vk::SharingMode::CONCURRENT, &self.families),
        }
    }

    /// The graphics binding of an XrSession.
    pub fn session_info(&self) -> xr::vulkan::SessionCreateInfo {
        xr::vulkan::SessionCreateInfo {
            instance: self.instance.handle().as_raw() as *const c_void,
            physical_device: self.physical.as_raw() as *const c_void,
            device: self.device.handle().as_raw() as *const c_void,
            queue_family_index: self.families[0],
            queue_index: 0,
        }
    }

    /// Keeps an object until [`Self::destroy_made`].
    pub fn keep(&self, made: Made) {
        self.made.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push(made);
    }

    /// The number of kept objects.
    pub fn made(&self) -> usize {
        self.made.lock().unwrap_or_else(std::sync::PoisonError::into_inner).len()
    }

    /// Takes the objects that were kept after so many; the caller destroys them.
    pub fn take_made(&self, after: usize) -> Vec<Made> {
        let mut made = self.made.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let after = after.min(made.len());
        made.split_off(after)
    }

    /// Waits until the device is idle, and destroys the kept objects, the newest first.
    ///
    /// # Errors
    /// A lost device.
    pub fn destroy_made(&self) -> Result<()> {
        // SAFETY: no other thread uses the device's queues any more.
        unsafe { self.device.device_wait_idle() }?;
        let mut made = self.made.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        for object in made.drain(..).rev() {
            self.destroy(object);
        }
        Ok(())
    }

    /// Destroys an object that was not kept, and that no submitted command uses any more.
    pub fn destroy(&self, object: Made) {
        let device = &self.device;
        // SAFETY: each object was made by this device and is destroyed once, after the last use of it: the caller
        // vouches for it, or the device is idle.
        unsafe {
            match object {
                Made::Buffer(buffer) => device.destroy_buffer(buffer, None),
                Made::CommandPool(pool) => device.destroy_command_pool(pool, None),
                Made::DescriptorPool(pool) => device.destroy_descriptor_pool(pool, None),
                Made::Fence(fence) => device.destroy_fence(fence, None),
                Made::Framebuffer(framebuffer) => device.destroy_framebuffer(framebuffer, None),
                Made::Image(image) => device.destroy_image(image, None),
                Made::Memory(memory) => device.free_memory(memory, None),
                Made::Module(module) => device.destroy_shader_module(module, None),
                Made::Pipeline(pipeline) => device.destroy_pipeline(pipeline, None),
                Made::PipelineLayout(layout) => device.destroy_pipeline_layout(layout, None),
                Made::QueryPool(pool) => device.destroy_query_pool(pool, None),
                Made::RenderPass(render_pass) => device.destroy_render_pass(render_pass, None),
                Made::Sampler(sampler) => device.destroy_sampler(sampler, None),
                Made::Semaphore(semaphore) => device.destroy_semaphore(semaphore, None),
                Made::SetLayout(layout) => device.destroy_descriptor_set_layout(layout, None),
                Made::View(view) => device.destroy_image_view(view, None),
            }
        }
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        // SAFETY: sessions are gone: they borrow this. Kept objects are destroyed first; where that fails the
        // device is lost.
        unsafe {
            let _ = self.destroy_made();
            self.device.destroy_device(None);
            if self.owns_instance {
                self.instance.destroy_instance(None);
            }
        }
    }
}

/// Families of the session's queue and of the second one, and the number of queues of each family.
fn graphics_families(
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
    demands: &Demands,
) -> Result<([u32; 2], u32)> {
    // SAFETY: the physical device is of this instance.
    let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
    let mut drawing =
        (0..).zip(&families).filter(|(_, family)| family.queue_flags.contains(vk::QueueFlags::GRAPHICS));
    let (first, family) = drawing.next().context("the headset's GPU has no graphics queue")?;
    Ok(match demands.queues {
        Queues::One => ([first; 2], 1),
        Queues::SecondIfThere | Queues::Two => ([first; 2], family.queue_count.min(2)),
        Queues::TwoFamilies => ([first, drawing.next().map_or(first, |(second, _)| second)], 1),
    })
}

/// The Vulkan loader's entry point in the type that the OpenXR crate wants.
fn entry_point(entry: &ash::Entry) -> xr::sys::platform::VkGetInstanceProcAddr {
    let function = entry.static_fn().get_instance_proc_addr;
    // SAFETY: both are vkGetInstanceProcAddr of the Vulkan headers; only the crates' names for the handle and
    // for the returned function pointer differ, both of one pointer's size.
    unsafe {
        std::mem::transmute::<vk::PFN_vkGetInstanceProcAddr, xr::sys::platform::VkGetInstanceProcAddr>(
            function,
        )
    }
}
