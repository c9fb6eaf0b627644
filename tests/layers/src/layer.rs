//! Common parts of the layers: creation and destruction of instances and devices, and the way to the next layer's functions. A layer adds
//! hooks, and its state of a device.
//!
//! A panic ends the process: these layers are for tests, which are to notice.

use crate::functions::PhysicalDeviceFunctions;
use crate::interface::{
    DeviceLink, GetPhysicalDeviceProcAddr, InstanceLink, NegotiateLayerInterface, advance_device,
    advance_instance,
};
use ash::vk;
use std::collections::BTreeMap;
use std::ffi::{CStr, c_char, c_int};
use std::mem::transmute;
use std::sync::{Arc, Once, PoisonError, RwLock};

/// One of the layers.
pub(crate) trait Layer: Sized + Send + Sync + 'static {
    /// The objects that it tracks.
    fn tracked() -> &'static Tracked<Self>;

    /// Calls `create`, perhaps with changes to `info`, and makes the layer's state of the device.
    ///
    /// # Safety
    ///
    /// `create` is called once, with a valid structure; the handles are live.
    unsafe fn create_device(
        instance: &Instance,
        physical_device: vk::PhysicalDevice,
        info: vk::DeviceCreateInfo<'_>,
        create: &mut dyn FnMut(&vk::DeviceCreateInfo<'_>) -> Result<NextDevice, vk::Result>,
    ) -> Result<Self, vk::Result>;

    /// Its hook for a function of a device.
    fn hook(name: &CStr) -> vk::PFN_vkVoidFunction;

    /// Its own function of that name, of an instance or a device, where the next layer need not have one.
    fn addition(_: &CStr) -> vk::PFN_vkVoidFunction {
        None
    }

    /// The next layer's functions.
    fn next(&self) -> &NextDevice;

    /// The application is about to destroy the device.
    fn device_destroyed(&self) {}

    /// The process ends without having destroyed the device. Layers below may have ended before, so that a layer which is used with validation
    /// calls nothing of Vulkan here.
    fn device_left(&self) {
        self.device_destroyed();
    }
}

/// The next layer's functions of an instance. They are resolved while it is created: later, the Vulkan loader
/// answers the last layer with the functions at the top of the chain.
#[derive(Clone, Copy)]
pub(crate) struct Instance {
    handle: vk::Instance,
    /// The version that the application asked for.
    pub api_version: u32,
    /// Whether VK_KHR_get_physical_device_properties2 is available, from the extension or Vulkan 1.1.
    pub properties2: bool,
    get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    get_physical_device_proc_addr: Option<GetPhysicalDeviceProcAddr>,
    destroy: vk::PFN_vkDestroyInstance,
    pub physical_device: PhysicalDeviceFunctions,
    pub features: vk::PFN_vkGetPhysicalDeviceFeatures,
    pub queue_families: vk::PFN_vkGetPhysicalDeviceQueueFamilyProperties,
}

impl Instance {
    /// # Safety
    ///
    /// `handle` was just made from `info`, which is valid, by the layer of that link.
    unsafe fn new(
        handle: vk::Instance,
        link: InstanceLink,
        info: &vk::InstanceCreateInfo<'_>,
    ) -> Option<Self> {
        // SAFETY: the names give the functions' types; the instance is live.
        unsafe {
            let function = |name: &CStr| (link.get_instance_proc_addr)(handle, name.as_ptr());
            let application = info.p_application_info.as_ref();
            let api_version = application.map_or(0, |info| info.api_version).max(vk::API_VERSION_1_0);
            let mut names = (0..info.enabled_extension_count)
                .map(|index| *info.pp_enabled_extension_names.add(index as usize));
            // Validation below has the names of Vulkan 1.1 in every version, and does not want them called before.
            let of_version = |name: &CStr| {
                let is_later = api_version < vk::API_VERSION_1_1 && name.to_bytes().ends_with(b"2");
                if is_later { None } else { function(name) }
            };
            let properties2 = vk::KHR_GET_PHYSICAL_DEVICE_PROPERTIES2_NAME;
            Some(Self {
                handle,
                api_version,
                properties2: api_version >= vk::API_VERSION_1_1
                    || names.any(|name| CStr::from_ptr(name) == properties2),
                physical_device: PhysicalDeviceFunctions::load(of_version),
                get_instance_proc_addr: link.get_instance_proc_addr,
                get_physical_device_proc_addr: link.get_physical_device_proc_addr,
                destroy: transmute::<Function, vk::PFN_vkDestroyInstance>(function(c"vkDestroyInstance")?),
                features: transmute::<Function, vk::PFN_vkGetPhysicalDeviceFeatures>(function(
                    c"vkGetPhysicalDeviceFeatures",
                )?),
                queue_families: transmute::<Function, vk::PFN_vkGetPhysicalDeviceQueueFamilyProperties>(
                    function(c"vkGetPhysicalDeviceQueueFamilyProperties")?,
                ),
            })
        }
    }
}

type Function = unsafe extern "system" fn();

/// The next layer of a device.
pub(crate) struct NextDevice {
    get_device_proc_addr: vk::PFN_vkGetDeviceProcAddr,
    /// Its functions. ash's stand-in for a missing one panics: hooks call only functions of the next layer.
    pub functions: ash::Device,
}

impl NextDevice {
    /// The next layer's function of that name.
    pub fn function(&self, name: &CStr) -> vk::PFN_vkVoidFunction {
        // SAFETY: the loader gave the function; the device is live while it is tracked.
        unsafe { (self.get_device_proc_addr)(self.functions.handle(), name.as_ptr()) }
    }
}

/// A layer's live objects, by dispatch key: the first word of a dispatchable object, which a physical device
/// shares with its instance, a queue and a command buffer with their device.
pub(crate) struct Tracked<L> {
    instances: RwLock<BTreeMap<usize, Instance>>,
    devices: RwLock<BTreeMap<usize, Arc<L>>>,
    report_at_exit: Once,
}

impl<L> Tracked<L> {
    pub const fn new() -> Self {
        Self {
            instances: RwLock::new(BTreeMap::new()),
            devices: RwLock::new(BTreeMap::new()),
            report_at_exit: Once::new(),
        }
    }
}

/// # Safety
///
/// `object` is a live dispatchable object.
unsafe fn key<H: vk::Handle>(object: H) -> usize {
    // SAFETY: the loader's contract with drivers.
    unsafe { *(object.as_raw() as *const usize) }
}

/// # Safety
///
/// `object` is a live instance or physical device of one that the layer tracks.
pub(crate) unsafe fn instance_of<L: Layer>(object: impl vk::Handle) -> Option<Instance> {
    // SAFETY: the caller vouches for it.
    let key = unsafe { key(object) };
    L::tracked().instances.read().unwrap_or_else(PoisonError::into_inner).get(&key).copied()
}

/// The layer's state of the device of a device, queue or command buffer.
///
/// # Safety
///
/// `object` is a live one.
pub(crate) unsafe fn device_of<L: Layer>(object: impl vk::Handle) -> Option<Arc<L>> {
    // SAFETY: the caller vouches for it.
    let key = unsafe { key(object) };
    L::tracked().devices.read().unwrap_or_else(PoisonError::into_inner).get(&key).cloned()
}

/// A hook as an answer to a question by name.
macro_rules! hooks {
    ($asked:expr; $($name:literal: $pfn:ident = $hook:path;)*) => {{
        let asked: &std::ffi::CStr = $asked;
        $(if asked == $name {
            let hook: ash::vk::$pfn = $hook;
            // SAFETY: PFN_vkVoidFunction may carry any function; the receiver casts it back by its name.
            return Some(unsafe { std::mem::transmute::<ash::vk::$pfn, unsafe extern "system" fn()>(hook) });
        })*
    }};
}
pub(crate) use hooks;

/// [`Layer::create_device`] of a layer that makes devices as the application asks, and its own `over` of the next one's.
macro_rules! made_as_asked {
    () => {
        /// # Safety
        /// As [`Layer::create_device`](crate::layer::Layer::create_device).
        unsafe fn create_device(
            _: &$crate::layer::Instance,
            _: ash::vk::PhysicalDevice,
            info: ash::vk::DeviceCreateInfo<'_>,
            create: &mut dyn FnMut(
                &ash::vk::DeviceCreateInfo<'_>,
            ) -> Result<$crate::layer::NextDevice, ash::vk::Result>,
        ) -> Result<Self, ash::vk::Result> {
            create(&info).map(Self::over)
        }
    };
}
pub(crate) use made_as_asked;

/// # Safety
///
/// The loader calls it with a valid structure.
pub(crate) unsafe fn negotiate<L: Layer>(interface: *mut NegotiateLayerInterface) -> vk::Result {
    // SAFETY: the caller vouches for it.
    let interface = unsafe { &mut *interface };
    interface.version = interface.version.min(2);
    interface.get_instance_proc_addr = Some(get_instance_proc_addr::<L>);
    interface.get_device_proc_addr = Some(get_device_proc_addr::<L>);
    interface.get_physical_device_proc_addr = Some(get_physical_device_proc_addr::<L>);
    vk::Result::SUCCESS
}

fn common_hook<L: Layer>(name: &CStr) -> vk::PFN_vkVoidFunction {
    hooks! { name;
        c"vkGetInstanceProcAddr": PFN_vkGetInstanceProcAddr = get_instance_proc_addr::<L>;
        c"vkGetDeviceProcAddr": PFN_vkGetDeviceProcAddr = get_device_proc_addr::<L>;
        c"vkCreateInstance": PFN_vkCreateInstance = create_instance::<L>;
        c"vkDestroyInstance": PFN_vkDestroyInstance = destroy_instance::<L>;
        c"vkCreateDevice": PFN_vkCreateDevice = create_device::<L>;
        c"vkDestroyDevice": PFN_vkDestroyDevice = destroy_device::<L>;
    }
    None
}

/// # Safety
/// As `vkGetInstanceProcAddr`.
unsafe extern "system" fn get_instance_proc_addr<L: Layer>(
    instance: vk::Instance,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the caller passes a name, and an instance that is null or live.
    unsafe {
        let name = CStr::from_ptr(name);
        if let Some(own) = common_hook::<L>(name) {
            return Some(own);
        }
        if instance == vk::Instance::null() {
            return None;
        }
        if let Some(own) = L::addition(name) {
            return Some(own);
        }
        let known = instance_of::<L>(instance)?;
        let next = (known.get_instance_proc_addr)(instance, name.as_ptr())?;
        L::hook(name).or(Some(next))
    }
}

/// # Safety
/// As `vkGetDeviceProcAddr`.
unsafe extern "system" fn get_device_proc_addr<L: Layer>(
    device: vk::Device,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the caller passes a name and a live device.
    unsafe {
        let name = CStr::from_ptr(name);
        if let Some(own) = L::addition(name) {
            return Some(own);
        }
        let next = device_of::<L>(device)?.next().function(name)?;
        common_hook::<L>(name).or_else(|| L::hook(name)).or(Some(next))
    }
}

/// # Safety
/// As `vk_layerGetPhysicalDeviceProcAddr` of the loader's layer interface.
unsafe extern "system" fn get_physical_device_proc_addr<L: Layer>(
    instance: vk::Instance,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the caller passes a name and a live instance.
    unsafe {
        let asked = CStr::from_ptr(name);
        if asked == c"vkCreateDevice" {
            return common_hook::<L>(asked);
        }
        if let Some(own) = L::addition(asked).filter(|_| asked.to_bytes().starts_with(b"vkGetPhysicalDevice"))
        {
            return Some(own);
        }
        instance_of::<L>(instance)?.get_physical_device_proc_addr?(instance, name)
    }
}

/// # Safety
/// As `vkCreateInstance`.
unsafe extern "system" fn create_instance<L: Layer>(
    info: *const vk::InstanceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    instance: *mut vk::Instance,
) -> vk::Result {
    // SAFETY: the loader calls with valid arguments; the name gives the function's type.
    unsafe {
        let link = advance_instance((*info).p_next);
        let create = (link.get_instance_proc_addr)(vk::Instance::null(), c"vkCreateInstance".as_ptr());
        let create: vk::PFN_vkCreateInstance = transmute(create);
        let result = create(info, allocator, instance);
        if result == vk::Result::SUCCESS {
            let Some(known) = Instance::new(*instance, link, &*info) else {
                return vk::Result::ERROR_INITIALIZATION_FAILED;
            };
            let mut instances = L::tracked().instances.write().unwrap_or_else(PoisonError::into_inner);
            instances.insert(key(*instance), known);
        }
        result
    }
}

/// # Safety
/// As `vkDestroyInstance`.
unsafe extern "system" fn destroy_instance<L: Layer>(
    instance: vk::Instance,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    // SAFETY: the loader passes on only live instances; the name gives the function's type.
    unsafe {
        let known =
            L::tracked().instances.write().unwrap_or_else(PoisonError::into_inner).remove(&key(instance));
        if let Some(known) = known {
            (known.destroy)(instance, allocator);
        }
    }
}

/// # Safety
/// As `vkCreateDevice`.
unsafe extern "system" fn create_device<L: Layer>(
    physical_device: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    device: *mut vk::Device,
) -> vk::Result {
    // SAFETY: the loader calls with valid arguments; the name gives the function's type.
    unsafe {
        let Some(instance) = instance_of::<L>(physical_device) else {
            return vk::Result::ERROR_INITIALIZATION_FAILED;
        };
        let link: DeviceLink = advance_device((*info).p_next);
        let create = (link.get_instance_proc_addr)(instance.handle, c"vkCreateDevice".as_ptr());
        let create: vk::PFN_vkCreateDevice = transmute(create);
        let mut create_next = |info: &vk::DeviceCreateInfo<'_>| {
            create(physical_device, info, allocator, device).result()?;
            let get_device_proc_addr = link.get_device_proc_addr;
            let load = |name: &CStr| get_device_proc_addr(*device, name.as_ptr());
            let load = |name: &CStr| load(name).map_or(std::ptr::null(), |function| function as *const _);
            Ok(NextDevice { get_device_proc_addr, functions: ash::Device::load_with(load, *device) })
        };
        match L::create_device(&instance, physical_device, *info, &mut create_next) {
            Ok(own) => {
                let mut devices = L::tracked().devices.write().unwrap_or_else(PoisonError::into_inner);
                devices.insert(key(*device), Arc::new(own));
                report_at_exit::<L>();
                vk::Result::SUCCESS
            }
            Err(result) => result,
        }
    }
}

unsafe extern "C" {
    fn atexit(function: extern "C" fn()) -> c_int;
}

/// Makes the process report on the devices that it never destroys (hello_xr destroys none) when it ends.
fn report_at_exit<L: Layer>() {
    extern "C" fn report<L: Layer>() {
        let devices =
            std::mem::take(&mut *L::tracked().devices.write().unwrap_or_else(PoisonError::into_inner));
        devices.values().for_each(|known| known.device_left());
    }
    L::tracked().report_at_exit.call_once(|| {
        // SAFETY: the C library runs the function at the process's end, or before it unloads this library.
        unsafe { atexit(report::<L>) };
    });
}

/// # Safety
/// As `vkDestroyDevice`.
unsafe extern "system" fn destroy_device<L: Layer>(
    device: vk::Device,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    // SAFETY: the loader passes on only live devices.
    unsafe {
        let known = L::tracked().devices.write().unwrap_or_else(PoisonError::into_inner).remove(&key(device));
        if let Some(known) = known {
            known.device_destroyed();
            (known.next().functions.fp_v1_0().destroy_device)(device, allocator);
        }
    }
}
