//! Instance and device with the extension, and the device's answers about it.

use super::Plan;
use ash::vk;

/// The size of the target, in pixels: no multiple of any texel.
pub const SIZE: [u32; 2] = [100, 60];

pub struct Setup {
    pub plan: Plan,
    _entry: ash::Entry,
    instance: ash::Instance,
    pub vk: ash::Device,
    pub set_rate: ash::khr::fragment_shading_rate::Device,
    pub queue: vk::Queue,
    memory: vk::PhysicalDeviceMemoryProperties,
    /// Of a texel, in pixels.
    pub texel: u32,
    pub layered: bool,
    /// The texels of all rates that the device has.
    pub rates: Vec<u8>,
}

fn texel_of(size: vk::Extent2D) -> u8 {
    (size.width.ilog2() << 2 | size.height.ilog2()) as u8
}

impl Setup {
    /// None where the device was to be created wrongly, and nothing more.
    pub fn new(plan: Plan) -> Option<Self> {
        // SAFETY: plain use of Vulkan; the handles live as long as the structure.
        unsafe {
            let entry = ash::Entry::load().unwrap();
            let version = match plan.broken.as_str() {
                "no create_renderpass2" => vk::API_VERSION_1_1,
                "no properties2" => vk::API_VERSION_1_0,
                _ => vk::API_VERSION_1_3,
            };
            let application = vk::ApplicationInfo::default().api_version(version);
            let info = vk::InstanceCreateInfo::default().application_info(&application);
            let instance = entry.create_instance(&info, None).unwrap();
            let physical_device = instance.enumerate_physical_devices().unwrap()[0];
            let name = vk::KHR_FRAGMENT_SHADING_RATE_NAME;
            let extensions = instance.enumerate_device_extension_properties(physical_device).unwrap();
            let has = extensions.iter().filter(|known| known.extension_name_as_c_str() == Ok(name)).count();
            assert_eq!(has, 1, "the extension is offered once");

            let mut limits = vk::PhysicalDeviceFragmentShadingRatePropertiesKHR::default();
            let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut limits);
            instance.get_physical_device_properties2(physical_device, &mut properties);
            let mut offered = vk::PhysicalDeviceFragmentShadingRateFeaturesKHR::default();
            let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut offered);
            instance.get_physical_device_features2(physical_device, &mut features);
            assert_eq!(offered.attachment_fragment_shading_rate, vk::TRUE);
            let format = instance.get_physical_device_format_properties(physical_device, vk::Format::R8_UINT);
            let feature = vk::FormatFeatureFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
            assert!(format.optimal_tiling_features.contains(feature));
            assert!(!format.linear_tiling_features.contains(feature));
            let supported = |format| {
                let usage = vk::ImageUsageFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
                let (flat, optimal) = (vk::ImageType::TYPE_2D, vk::ImageTiling::OPTIMAL);
                let flags = vk::ImageCreateFlags::empty();
                instance.get_physical_device_image_format_properties(
                    physical_device,
                    format,
                    flat,
                    optimal,
                    usage,
                    flags,
                )
            };
            assert!(supported(vk::Format::R8_UINT).is_ok());
            assert!(supported(vk::Format::R8G8B8A8_UNORM).is_err());
            let list = ash::khr::fragment_shading_rate::Instance::new(&entry, &instance);
            let mut rates = Vec::new();
            let get = list.fp().get_physical_device_fragment_shading_rates_khr;
            let mut count = 0;
            get(physical_device, &mut count, std::ptr::null_mut()).result().unwrap();
            rates.resize(count as usize, vk::PhysicalDeviceFragmentShadingRateKHR::default());
            get(physical_device, &mut count, rates.as_mut_ptr()).result().unwrap();

            let queue = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
            let mut rate_features = vk::PhysicalDeviceFragmentShadingRateFeaturesKHR::default()
                .pipeline_fragment_shading_rate(!plan.is("without_pipeline"))
                .primitive_fragment_shading_rate(!plan.is("without_primitive"))
                .attachment_fragment_shading_rate(!plan.is("without_attachment"));
            let mut twice = rate_features;
            let mut v11 = vk::PhysicalDeviceVulkan11Features::default().multiview(true);
            let mut v12 = vk::PhysicalDeviceVulkan12Features::default().imageless_framebuffer(true);
            let mut v13 =
                vk::PhysicalDeviceVulkan13Features::default().dynamic_rendering(true).synchronization2(true);
            let mut density =
                vk::PhysicalDeviceFragmentDensityMapFeaturesEXT::default().fragment_density_map(true);
            let mut image = vk::PhysicalDeviceShadingRateImageFeaturesNV::default().shading_rate_image(true);
            let mut libraries = vk::PhysicalDeviceGraphicsPipelineLibraryFeaturesEXT::default()
                .graphics_pipeline_library(true);
            let mut names = vec![name.as_ptr()];
            if plan.is("without_extension") {
                names.clear();
            }
            if plan.is("libraries") {
                names.push(vk::EXT_GRAPHICS_PIPELINE_LIBRARY_NAME.as_ptr());
                names.push(vk::KHR_PIPELINE_LIBRARY_NAME.as_ptr());
            }
            let features = vk::PhysicalDeviceFeatures::default().shader_storage_image_extended_formats(true);
            let mut info = vk::DeviceCreateInfo::default()
                .queue_create_infos(&queue)
                .enabled_extension_names(&names)
                .enabled_features(&features);
            if version >= vk::API_VERSION_1_3 {
                info = info.push_next(&mut v11).push_next(&mut v12).push_next(&mut v13);
            }
            if !plan.is("without_extension") || plan.breaks("features without extension") {
                info = info.push_next(&mut rate_features);
            }
            if plan.breaks("density map") {
                info = info.push_next(&mut density);
            }
            if plan.breaks("shading rate image") {
                info = info.push_next(&mut image);
            }
            if plan.breaks("features twice") {
                info = info.push_next(&mut twice);
            }
            if plan.is("libraries") {
                info = info.push_next(&mut libraries);
            }
            if version < vk::API_VERSION_1_1 {
                info.p_next = std::ptr::null();
            }
            let device = instance.create_device(physical_device, &info, None).unwrap();
            if plan.form == "device" {
                device.destroy_device(None);
                instance.destroy_instance(None);
                return None;
            }
            Some(Self {
                set_rate: ash::khr::fragment_shading_rate::Device::new(&instance, &device),
                queue: device.get_device_queue(0, 0),
                memory: instance.get_physical_device_memory_properties(physical_device),
                vk: device,
                texel: limits.max_fragment_shading_rate_attachment_texel_size.width,
                layered: limits.layered_shading_rate_attachments == vk::TRUE,
                rates: rates.iter().map(|rate| texel_of(rate.fragment_size)).collect(),
                instance,
                _entry: entry,
                plan,
            })
        }
    }

    /// Layers of the target, and of the rate image.
    pub fn layers(&self) -> [u32; 2] {
        let layers = if self.plan.is("multiview") { 2 } else { 1 };
        [layers, if self.layered { layers } else { 1 }]
    }

    /// Size of the rate image in texels, in each direction.
    pub fn texels(&self) -> [u32; 2] {
        SIZE.map(|side| side.div_ceil(self.texel))
    }

    pub fn allocate(&self, needs: vk::MemoryRequirements) -> vk::DeviceMemory {
        let host = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let index = (0..self.memory.memory_type_count).find(|&index| {
            let flags = self.memory.memory_types[index as usize].property_flags;
            needs.memory_type_bits & (1 << index) != 0 && flags.contains(host)
        });
        let info = vk::MemoryAllocateInfo::default().allocation_size(needs.size);
        // SAFETY: plain use of Vulkan.
        unsafe { self.vk.allocate_memory(&info.memory_type_index(index.unwrap()), None).unwrap() }
    }

    /// An image with memory.
    pub fn image(&self, info: &vk::ImageCreateInfo<'_>) -> (vk::Image, vk::DeviceMemory) {
        // SAFETY: plain use of Vulkan.
        unsafe {
            let image = self.vk.create_image(info, None).unwrap();
            let memory = self.allocate(self.vk.get_image_memory_requirements(image));
            self.vk.bind_image_memory(image, memory, 0).unwrap();
            (image, memory)
        }
    }

    /// Writes memory that the host can see, which nothing else uses.
    pub fn write(&self, memory: vk::DeviceMemory, bytes: &[u8]) {
        // SAFETY: plain use of Vulkan; the memory is mapped while it is written.
        unsafe {
            let to = self.vk.map_memory(memory, 0, vk::WHOLE_SIZE, Default::default()).unwrap();
            std::ptr::copy_nonoverlapping(bytes.as_ptr(), to.cast(), bytes.len());
            self.vk.unmap_memory(memory);
        }
    }

    /// A buffer with these bytes.
    pub fn buffer(&self, bytes: &[u8]) -> (vk::Buffer, vk::DeviceMemory) {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let info = vk::BufferCreateInfo::default().size(bytes.len() as u64).usage(usage);
        // SAFETY: plain use of Vulkan.
        unsafe {
            let buffer = self.vk.create_buffer(&info, None).unwrap();
            let memory = self.allocate(self.vk.get_buffer_memory_requirements(buffer));
            self.vk.bind_buffer_memory(buffer, memory, 0).unwrap();
            self.write(memory, bytes);
            (buffer, memory)
        }
    }
}

impl Drop for Setup {
    fn drop(&mut self) {
        // SAFETY: the program waited, and destroyed the objects that it made, before.
        unsafe {
            self.vk.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}

/// Width and height.
pub fn extent([width, height]: [u32; 2]) -> vk::Extent2D {
    vk::Extent2D { width, height }
}
