//! Instance, device, queue.

use crate::headset::Headset;
use crate::style::Style;
use anyhow::{Context, Result};
use ash::vk;
use std::ffi::CString;

/// A device with one queue that draws.
pub struct Device {
    _entry: ash::Entry,
    pub instance: ash::Instance,
    pub physical_device: vk::PhysicalDevice,
    pub functions: ash::Device,
    pub family: u32,
    queue: vk::Queue,
    fence: vk::Fence,
    memory_types: vk::PhysicalDeviceMemoryProperties,
}

/// Extensions that an OpenXR runtime requires, names separated by spaces.
#[derive(Default)]
pub struct Wishes {
    pub instance_extensions: String,
    pub device_extensions: String,
}

impl Device {
    /// Makes the headset's device, or else one of the first physical device with a queue that draws; as an application
    /// of Vulkan 1.0 does, or of 1.3 where the style needs that.
    pub fn new(style: Style, headset: Option<&Headset>) -> Result<Self> {
        let wishes = headset.map(Headset::wishes).transpose()?.unwrap_or_default();
        let version = match style {
            Style::RenderPass => vk::API_VERSION_1_0,
            Style::DynamicRendering => vk::API_VERSION_1_3,
        };
        let instance_extensions = names(&wishes.instance_extensions)?;
        let device_extensions = names(&wishes.device_extensions)?;
        // SAFETY: plain use of Vulkan: valid structures, and the handles live as long as this object.
        unsafe {
            let entry = ash::Entry::load()?;
            let application = vk::ApplicationInfo::default().api_version(version);
            let pointers: Vec<_> = instance_extensions.iter().map(|name| name.as_ptr()).collect();
            let info = vk::InstanceCreateInfo::default()
                .application_info(&application)
                .enabled_extension_names(&pointers);
            let instance = entry.create_instance(&info, None)?;
            let physical_device = match headset {
                Some(headset) => headset.physical_device(instance.handle())?,
                None => instance
                    .enumerate_physical_devices()?
                    .into_iter()
                    .find(|&device| graphics_family(&instance, device).is_some())
                    .context("no queue that draws")?,
            };
            let family = graphics_family(&instance, physical_device).context("no queue that draws")?;
            let queue =
                [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0])];
            let pointers: Vec<_> = device_extensions.iter().map(|name| name.as_ptr()).collect();
            let mut modern =
                vk::PhysicalDeviceVulkan13Features::default().dynamic_rendering(true).synchronization2(true);
            let mut info =
                vk::DeviceCreateInfo::default().queue_create_infos(&queue).enabled_extension_names(&pointers);
            if style == Style::DynamicRendering {
                info = info.push_next(&mut modern);
            }
            let functions = instance.create_device(physical_device, &info, None)?;
            Ok(Self {
                queue: functions.get_device_queue(family, 0),
                fence: functions.create_fence(&vk::FenceCreateInfo::default(), None)?,
                memory_types: instance.get_physical_device_memory_properties(physical_device),
                family,
                functions,
                physical_device,
                instance,
                _entry: entry,
            })
        }
    }

    /// Submits, with the fence that [`Self::wait`] waits for.
    pub fn submit(&self, commands: vk::CommandBuffer) -> Result<()> {
        let buffers = [commands];
        let submit = [vk::SubmitInfo::default().command_buffers(&buffers)];
        // SAFETY: the buffer is recorded and the fence unsignalled.
        unsafe { Ok(self.functions.queue_submit(self.queue, &submit, self.fence)?) }
    }

    /// Waits for the last submit.
    pub fn wait(&self) -> Result<()> {
        // SAFETY: the fence is this object's own.
        unsafe {
            self.functions.wait_for_fences(&[self.fence], true, u64::MAX)?;
            Ok(self.functions.reset_fences(&[self.fence])?)
        }
    }

    /// Memory for an object with these needs.
    pub fn allocate(
        &self,
        needs: vk::MemoryRequirements,
        properties: vk::MemoryPropertyFlags,
    ) -> Result<vk::DeviceMemory> {
        let fits = |&(index, memory): &(usize, &vk::MemoryType)| {
            needs.memory_type_bits & (1 << index) != 0 && memory.property_flags.contains(properties)
        };
        let types = self.memory_types.memory_types_as_slice().iter().enumerate();
        let (index, _) = types.into_iter().find(fits).context("no memory of the kind that is needed")?;
        let info =
            vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(index as u32);
        // SAFETY: a valid structure.
        unsafe { Ok(self.functions.allocate_memory(&info, None)?) }
    }
}

fn names(text: &str) -> Result<Vec<CString>> {
    text.split_whitespace().map(|name| Ok(CString::new(name)?)).collect()
}

fn graphics_family(instance: &ash::Instance, device: vk::PhysicalDevice) -> Option<u32> {
    // SAFETY: the physical device is the instance's.
    let families = unsafe { instance.get_physical_device_queue_family_properties(device) };
    let draws = |family: &vk::QueueFamilyProperties| family.queue_flags.contains(vk::QueueFlags::GRAPHICS);
    families.iter().position(draws).map(|index| index as u32)
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: everything that was made of the device is gone, and it is idle: each submit was waited for.
        unsafe {
            self.functions.destroy_fence(self.fence, None);
            self.functions.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}
