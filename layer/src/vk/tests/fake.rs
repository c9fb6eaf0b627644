//! A stand-in for the layer below and the driver: it records the calls that reach it.

use super::super::chain::{
    DeviceLink, DevicePayload, InstanceLink, InstancePayload, LINK_INFO, LOADER_DATA_CALLBACK,
    LayerDeviceCreateInfo, LayerInstanceCreateInfo,
};
use ash::vk::{self, Handle};
use std::cell::RefCell;
use std::ffi::{CStr, c_char, c_void};
use std::ptr::{null, null_mut};

pub mod pipelines;
pub mod queue;
pub mod rates;

thread_local! {
    static CALLS: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
    static INSTANCE_NAMES: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// The names that vkGetInstanceProcAddr was asked for on this thread since the last time.
pub fn instance_names() -> Vec<String> {
    INSTANCE_NAMES.take()
}

/// The calls that reached the stand-in on this thread since the last time.
pub fn calls() -> Vec<String> {
    CALLS.take()
}

fn called(what: impl Into<String>) {
    CALLS.with_borrow_mut(|calls| calls.push(what.into()));
}

/// A dispatchable object: its first word is its key, which here is the address of a block of its own.
#[repr(C)]
struct Object {
    key: *mut u64,
}

fn object_with_key(key: *mut u64) -> u64 {
    Box::into_raw(Box::new(Object { key })) as u64
}

fn new_object() -> u64 {
    object_with_key(Box::into_raw(Box::new(0)))
}

/// A physical device of that instance: another object with the same key.
pub fn physical_device_of(instance: vk::Instance) -> vk::PhysicalDevice {
    // SAFETY: the instance is an Object made by `new_object`.
    let key = unsafe { (*(instance.as_raw() as *const Object)).key };
    vk::PhysicalDevice::from_raw(object_with_key(key))
}

/// A command buffer of that device: another object with the same key.
pub fn command_buffer_of(device: vk::Device) -> vk::CommandBuffer {
    // SAFETY: the device is an Object made by `new_object`.
    let key = unsafe { (*(device.as_raw() as *const Object)).key };
    vk::CommandBuffer::from_raw(object_with_key(key))
}

/// A queue of that device: another object with the same key.
pub fn queue_of(device: vk::Device) -> vk::Queue {
    vk::Queue::from_raw(command_buffer_of(device).as_raw())
}

/// The Vulkan version of the stand-in's devices.
pub const DEVICE_VERSION: u32 = vk::make_api_version(0, 1, 2, 5);

/// The result of vkCreateDevice for a queue count of 99.
pub const DEVICE_FAILURE: vk::Result = vk::Result::ERROR_TOO_MANY_OBJECTS;

/// The structure types of a chain, in its order.
fn types(mut at: *const c_void) -> Vec<i32> {
    let mut found = Vec::new();
    while !at.is_null() {
        // SAFETY: the tests build valid chains.
        unsafe {
            let header = &*at.cast::<vk::BaseInStructure<'_>>();
            found.push(header.s_type.as_raw());
            at = header.p_next.cast();
        }
    }
    found
}

/// The link that the loader's structure in a chain names now.
fn link_at(mut at: *const c_void, loader: vk::StructureType) -> *const c_void {
    while !at.is_null() {
        // SAFETY: the tests build valid chains; both loader structures have their link at the same place.
        unsafe {
            let header = &*at.cast::<vk::BaseInStructure<'_>>();
            let info = &*at.cast::<LayerInstanceCreateInfo>();
            if header.s_type == loader && info.function == LINK_INFO {
                return info.payload.other;
            }
            at = header.p_next.cast();
        }
    }
    null()
}

/// The changes of a layer before it fails: it moves the loader's structure on, and writes to the handle.
///
/// # Safety
///
/// A chain of the tests, and a handle to write to.
unsafe fn spoil<H: Handle>(handle: *mut H, mut at: *const c_void, loader: vk::StructureType) {
    // SAFETY: chain and handle are valid, as `# Safety` demands; both loader structures have their link at the same place.
    unsafe {
        *handle = H::from_raw(0xbad);
        while !at.is_null() {
            let info = at.cast_mut().cast::<LayerInstanceCreateInfo>();
            if (*info).s_type == loader && (*info).function == LINK_INFO {
                (*info).payload.link = null_mut();
            }
            at = (*info).p_next;
        }
    }
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_instance(
    info: *const vk::InstanceCreateInfo<'_>,
    _: *const vk::AllocationCallbacks<'_>,
    instance: *mut vk::Instance,
) -> vk::Result {
    // SAFETY: the tests pass valid structures.
    unsafe {
        let chain = (*info).p_next;
        let link = link_at(chain, vk::StructureType::LOADER_INSTANCE_CREATE_INFO);
        called(format!("vkCreateInstance chain {:?} link {link:?}", types(chain)));
        if let Err(refused) = rates::instance_created(&*info) {
            spoil(instance, chain, vk::StructureType::LOADER_INSTANCE_CREATE_INFO);
            return refused;
        }
        *instance = vk::Instance::from_raw(new_object());
    }
    vk::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_device(
    _: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo<'_>,
    _: *const vk::AllocationCallbacks<'_>,
    device: *mut vk::Device,
) -> vk::Result {
    // SAFETY: the tests pass valid structures.
    unsafe {
        let chain = (*info).p_next;
        let link = link_at(chain, vk::StructureType::LOADER_DEVICE_CREATE_INFO);
        called(format!("vkCreateDevice chain {:?} link {link:?}", types(chain)));
        if (*info).queue_create_info_count == 99 {
            return DEVICE_FAILURE;
        }
        if let Err(refused) = rates::device_created(&*info) {
            spoil(device, chain, vk::StructureType::LOADER_DEVICE_CREATE_INFO);
            return refused;
        }
        *device = vk::Device::from_raw(new_object());
    }
    vk::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn destroy_instance(instance: vk::Instance, _: *const vk::AllocationCallbacks<'_>) {
    called(format!("vkDestroyInstance {:x}", instance.as_raw()));
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn destroy_device(device: vk::Device, _: *const vk::AllocationCallbacks<'_>) {
    called(format!("vkDestroyDevice {:x}", device.as_raw()));
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn physical_device_properties(
    _: vk::PhysicalDevice,
    properties: *mut vk::PhysicalDeviceProperties,
) {
    // SAFETY: the caller passes a structure to write to.
    let properties = unsafe { &mut *properties };
    properties.api_version = DEVICE_VERSION;
    rates::describe(properties);
}

/// The stand-in's function for `vkCmdSetDepthBounds`, which this layer does not hook.
///
/// # Safety
///
/// As the call.
pub unsafe extern "system" fn set_depth_bounds() {}

fn function(name: &CStr) -> vk::PFN_vkVoidFunction {
    macro_rules! answer {
        ($($known:literal: $pfn:ident = $function:path;)*) => {
            $(if name == $known {
                let function: vk::$pfn = $function;
                // SAFETY: carried as PFN_vkVoidFunction, cast back by its name.
                return Some(unsafe {
                    std::mem::transmute::<vk::$pfn, unsafe extern "system" fn()>(function)
                });
            })*
        };
    }
    answer! {
        c"vkCreateInstance": PFN_vkCreateInstance = create_instance;
        c"vkDestroyInstance": PFN_vkDestroyInstance = destroy_instance;
        c"vkCreateDevice": PFN_vkCreateDevice = create_device;
        c"vkDestroyDevice": PFN_vkDestroyDevice = destroy_device;
        c"vkGetPhysicalDeviceProperties": PFN_vkGetPhysicalDeviceProperties = physical_device_properties;
        c"vkEnumerateDeviceExtensionProperties":
            PFN_vkEnumerateDeviceExtensionProperties = rates::enumerate_device_extensions;
        c"vkGetPhysicalDeviceFeatures2": PFN_vkGetPhysicalDeviceFeatures2 = rates::features2;
        c"vkGetPhysicalDeviceFeatures2KHR": PFN_vkGetPhysicalDeviceFeatures2 = rates::features2;
        c"vkGetPhysicalDeviceProperties2KHR": PFN_vkGetPhysicalDeviceProperties2 = rates::properties2;
        c"vkGetPhysicalDeviceProperties2": PFN_vkGetPhysicalDeviceProperties2 = rates::properties2;
        c"vkGetPhysicalDeviceMemoryProperties":
            PFN_vkGetPhysicalDeviceMemoryProperties = rates::memory_properties;
        c"vkGetPhysicalDeviceFragmentShadingRatesKHR":
            PFN_vkGetPhysicalDeviceFragmentShadingRatesKHR = rates::shading_rates;
        c"vkCmdSetFragmentShadingRateKHR": PFN_vkCmdSetFragmentShadingRateKHR = rates::set_rate;
        c"vkGetDeviceProcAddr": PFN_vkGetDeviceProcAddr = get_device_proc_addr;
        c"vkQueueSubmit": PFN_vkQueueSubmit = queue::submit;
    }
    if let Some(function) = pipelines::function(name).filter(|_| rates::is_offered()) {
        return Some(function);
    }
    let is_there = name == c"vkCmdSetDepthBounds" || rates::is_offered();
    is_there.then_some(set_depth_bounds)
}

/// # Safety
///
/// As the call.
pub unsafe extern "system" fn get_instance_proc_addr(
    _: vk::Instance,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the caller passes a name.
    let name = unsafe { CStr::from_ptr(name) };
    INSTANCE_NAMES.with_borrow_mut(|names| names.push(name.to_string_lossy().into_owned()));
    function(name)
}

/// # Safety
///
/// As the call.
pub unsafe extern "system" fn get_device_proc_addr(
    _: vk::Device,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the caller passes a name.
    function(unsafe { CStr::from_ptr(name) })
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn set_device_loader_data(_: vk::Device, _: *mut c_void) -> vk::Result {
    vk::Result::SUCCESS
}

/// The chain that a loader gives to the first of two layers of an instance, with `then` behind it.
pub fn instance_chain(then: *const c_void) -> (*const c_void, *const c_void) {
    let link = |next| InstanceLink {
        next,
        get_instance_proc_addr,
        get_physical_device_proc_addr: Some(get_instance_proc_addr),
    };
    let last = Box::into_raw(Box::new(link(null_mut())));
    let first = Box::into_raw(Box::new(link(last)));
    let info = LayerInstanceCreateInfo {
        s_type: vk::StructureType::LOADER_INSTANCE_CREATE_INFO,
        p_next: then,
        function: LINK_INFO,
        payload: InstancePayload { link: first },
    };
    (Box::into_raw(Box::new(info)).cast(), last.cast())
}

/// As [`instance_chain`], for a device; without `callback` the loader gives no vkSetDeviceLoaderData.
pub fn device_chain(then: *const c_void, callback: bool) -> (*const c_void, *const c_void) {
    let link = |next| DeviceLink { next, get_instance_proc_addr, get_device_proc_addr };
    let last = Box::into_raw(Box::new(link(null_mut())));
    let first = Box::into_raw(Box::new(link(last)));
    let info = |p_next, function, payload| {
        let s_type = vk::StructureType::LOADER_DEVICE_CREATE_INFO;
        Box::into_raw(Box::new(LayerDeviceCreateInfo { s_type, p_next, function, payload }))
            .cast_const()
            .cast::<c_void>()
    };
    let set_device_loader_data = DevicePayload { set_device_loader_data: Some(set_device_loader_data) };
    let then = if callback { info(then, LOADER_DATA_CALLBACK, set_device_loader_data) } else { then };
    (info(then, LINK_INFO, DevicePayload { link: first }), last.cast())
}
