//! A Vulkan device as an application would have it, with validation.

use ash::{ext, khr, vk};
use parafovea::gpu::Gpu;
use parafovea::link::DeviceRecord;
use parafovea_trial::{Lack, skip};
use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex, MutexGuard, Once, PoisonError};

const VALIDATION: &CStr = c"VK_LAYER_KHRONOS_validation";

/// Messages of validation about one device.
type Messages = Mutex<Vec<String>>;

/// One device with one queue. Never destroyed: the process ends soon.
pub struct Vulkan {
    instance: ash::Instance,
    pub device: ash::Device,
    pub queue: vk::Queue,
    pub memory: vk::PhysicalDeviceMemoryProperties,
    pub gpu: Arc<Gpu>,
    pub pool: vk::CommandPool,
    pub record: DeviceRecord,
    /// Functions of timeline semaphores, which let a test decide when a submit ends. None if the device has none.
    pub timeline: Option<khr::timeline_semaphore::Device>,
    /// Whether the validation layers are enabled.
    pub validated: bool,
    messages: &'static Messages,
}

static TURN: Mutex<()> = Mutex::new(());

thread_local! {
    /// Taken by a test, which has a thread of its own, with its first device, and given back when the thread ends.
    ///
    /// Validation layers 1.3.239 keep their devices in maps without a lock: a call for one device while another is
    /// being made crashes in them now and then.
    static MY_TURN: MutexGuard<'static, ()> = TURN.lock().unwrap_or_else(PoisonError::into_inner);
}

impl Vulkan {
    /// The first device. Without one, the test is skipped.
    pub fn new() -> Self {
        Self::with(|record| record)
    }

    /// As [`Vulkan::new`], with a later version of Vulkan.
    pub fn at(api_version: u32) -> Self {
        Self::made(api_version, |record| record)
    }

    /// As [`Vulkan::new`], with the record of the device for our half of the library changed by `edit`.
    pub fn with(edit: impl FnOnce(DeviceRecord) -> DeviceRecord) -> Self {
        Self::made(vk::API_VERSION_1_0, edit)
    }

    /// As [`Vulkan::at`], without validation, for measurements.
    pub fn unchecked(api_version: u32) -> Self {
        Self::of(api_version, false, |record| record)
    }

    fn made(api_version: u32, edit: impl FnOnce(DeviceRecord) -> DeviceRecord) -> Self {
        Self::of(api_version, true, edit)
    }

    fn of(api_version: u32, validates: bool, edit: impl FnOnce(DeviceRecord) -> DeviceRecord) -> Self {
        MY_TURN.with(|_| ());
        static QUEUE_SUBMIT_CHECKS: Once = Once::new();
        QUEUE_SUBMIT_CHECKS.call_once(|| {
            // The only switch of validation layers 1.3.239 for hazards between submits.
            // SAFETY: every test passes here before it uses Vulkan, which reads the variable.
            unsafe {
                std::env::set_var(
                    "VK_LAYER_ENABLES",
                    "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT",
                );
            }
        });
        // SAFETY: plain use of Vulkan; all handles stay live for the rest of the process.
        unsafe {
            let entry = match ash::Entry::load() {
                Ok(entry) => entry,
                Err(error) => skip(&Lack::setup(format_args!("the Vulkan loader: {error}"))),
            };
            let messages: &'static Messages = Box::leak(Box::default());
            let (instance, validated) = instance(&entry, api_version, validates.then_some(messages));
            let devices = instance.enumerate_physical_devices().unwrap_or_default();
            let Some(&physical_device) = devices.first() else { skip(&Lack::setup("a Vulkan device")) };
            let priorities = [1.0];
            let queues = [vk::DeviceQueueCreateInfo::default().queue_priorities(&priorities)];
            // Tests with later versions may also count shaded fragments.
            let counts = api_version > vk::API_VERSION_1_0
                && instance.get_physical_device_features(physical_device).fragment_stores_and_atomics != 0;
            let features = vk::PhysicalDeviceFeatures::default().fragment_stores_and_atomics(counts);
            let offered = instance.enumerate_device_extension_properties(physical_device).unwrap_or_default();
            let name = khr::timeline_semaphore::NAME;
            let has_timeline = offered.iter().any(|offered| offered.extension_name_as_c_str() == Ok(name));
            let mut timeline =
                vk::PhysicalDeviceTimelineSemaphoreFeatures::default().timeline_semaphore(true);
            let names = [name.as_ptr()];
            let mut info =
                vk::DeviceCreateInfo::default().queue_create_infos(&queues).enabled_features(&features);
            if has_timeline {
                info = info.enabled_extension_names(&names).push_next(&mut timeline);
            }
            let device = instance.create_device(physical_device, &info, None).unwrap();
            let record = edit(DeviceRecord {
                instance: instance.handle(),
                physical_device,
                device: device.handle(),
                api_version,
                next_get_instance_proc_addr: entry.static_fn().get_instance_proc_addr,
                next_get_device_proc_addr: instance.fp_v1_0().get_device_proc_addr,
                set_device_loader_data,
                queue_submit: None,
                arming: parafovea::config::Arming::Rates as u32,
                submits_late: 0,
            });
            let pool_info = vk::CommandPoolCreateInfo::default();
            let vulkan = Self {
                queue: device.get_device_queue(0, 0),
                memory: instance.get_physical_device_memory_properties(physical_device),
                gpu: Gpu::new(&record, 0, 0).unwrap(),
                timeline: has_timeline.then(|| khr::timeline_semaphore::Device::new(&instance, &device)),
                pool: device.create_command_pool(&pool_info, None).unwrap(),
                device,
                instance,
                record,
                validated,
                messages,
            };
            // The loader library must outlive the device.
            std::mem::forget(entry);
            vulkan
        }
    }
}

impl Vulkan {
    /// Whether images of this format can be depth attachments.
    pub fn draws_depth(&self, format: vk::Format) -> bool {
        // SAFETY: plain query.
        let properties = unsafe {
            self.instance.get_physical_device_format_properties(self.record.physical_device, format)
        };
        properties.optimal_tiling_features.contains(vk::FormatFeatureFlags::DEPTH_STENCIL_ATTACHMENT)
    }

    /// Whether the CPU renders, with exact conversions of texels.
    pub fn is_cpu(&self) -> bool {
        // SAFETY: plain query.
        let properties = unsafe { self.instance.get_physical_device_properties(self.record.physical_device) };
        properties.device_type == vk::PhysicalDeviceType::CPU
    }

    /// Messages of validation so far.
    pub fn messages(&self) -> Vec<String> {
        self.messages.lock().unwrap().clone()
    }

    /// Fails when validation has said anything so far.
    pub fn assert_valid(&self) {
        let messages = self.messages();
        assert!(messages.is_empty(), "validation says:\n{}", messages.join("\n"));
    }
}

unsafe fn instance(
    entry: &ash::Entry,
    api_version: u32,
    messages: Option<&'static Messages>,
) -> (ash::Instance, bool) {
    let application = vk::ApplicationInfo::default().api_version(api_version);
    let mut info = vk::InstanceCreateInfo::default().application_info(&application);
    // SAFETY: plain queries.
    let layers = unsafe { entry.enumerate_instance_layer_properties() }.unwrap_or_default();
    let is_installed = layers.iter().any(|layer| layer.layer_name_as_c_str() == Ok(VALIDATION));
    let validated = is_installed && messages.is_some();
    if messages.is_some() && !is_installed {
        println!("without validation: VK_LAYER_KHRONOS_validation is not installed");
    }
    // Timeline semaphores of Vulkan 1.0 need the first extension.
    let extensions = [khr::get_physical_device_properties2::NAME, ext::debug_utils::NAME].map(CStr::as_ptr);
    let names = [VALIDATION.as_ptr()];
    let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
    let messenger = vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(
            vk::DebugUtilsMessageSeverityFlagsEXT::WARNING | vk::DebugUtilsMessageSeverityFlagsEXT::ERROR,
        )
        .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION)
        .pfn_user_callback(Some(on_message))
        .user_data(
            messages.map_or(std::ptr::null_mut(), |messages| std::ptr::from_ref(messages).cast_mut().cast()),
        );
    info = info.enabled_extension_names(&extensions[..1]);
    if validated {
        info = info.enabled_layer_names(&names).enabled_extension_names(&extensions).push_next(&mut features);
    }
    // SAFETY: everything that is named outlives the calls.
    unsafe {
        let instance = entry.create_instance(&info, None).unwrap();
        if validated {
            let debug_utils = ext::debug_utils::Instance::new(entry, &instance);
            debug_utils.create_debug_utils_messenger(&messenger, None).unwrap();
        }
        (instance, validated)
    }
}

unsafe extern "system" fn on_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    messages: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layer passes live data, and the pointer that the messenger was made with.
    let (message, messages) = unsafe { ((*data).message_as_c_str(), &*messages.cast::<Messages>()) };
    if let (Some(message), Ok(mut messages)) = (message, messages.lock()) {
        messages.push(message.to_string_lossy().into_owned());
    }
    vk::FALSE
}

/// Stand-in for the loader's callback: copies the dispatch pointer, the first word, from the device.
unsafe extern "system" fn set_device_loader_data(device: vk::Device, object: *mut c_void) -> vk::Result {
    use vk::Handle;
    // SAFETY: both are live dispatchable objects, which start with that pointer.
    unsafe { *object.cast::<usize>() = *(device.as_raw() as *const usize) };
    vk::Result::SUCCESS
}
