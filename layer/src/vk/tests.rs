//! The Vulkan half above a stand-in for the layer below, called as a loader calls it.

mod by_identifier;
mod ends;
mod fake;
mod memory_model;
mod passes;
mod pipelines;
mod rates;

use super::chain::NegotiateLayerInterface;
use super::{LAYER_NAME, device, negotiate};
use crate::config::{Arming, Demands};
use crate::link::{DeviceRecord, GET_LINK_NAME, GetLink, LINK_VERSION, LinkTable};
use crate::vk::dispatch::proc_addr;
use ash::vk::{self, Handle};
use std::cell::Cell;
use std::ffi::{CStr, c_void};
use std::mem::{MaybeUninit, transmute};
use std::ptr::{null, null_mut};
use std::sync::Barrier;

thread_local! {
    static ARMING: Cell<Arming> = const { Cell::new(Arming::Rates) };
    static COARSE_STORES: Cell<bool> = const { Cell::new(false) };
}

/// The configuration's demands on devices of this thread.
pub fn demands() -> Demands {
    Demands { arming: ARMING.get(), coarse_stores: COARSE_STORES.get() }
}

/// A structure that this layer does not know.
fn unknown(s_type: i32, p_next: *const c_void) -> *const c_void {
    let structure = vk::BaseInStructure {
        s_type: vk::StructureType::from_raw(s_type),
        p_next: p_next.cast(),
        ..Default::default()
    };
    Box::into_raw(Box::new(structure)).cast_const().cast()
}

fn instance_function(instance: vk::Instance, name: &CStr) -> vk::PFN_vkVoidFunction {
    // SAFETY: null or a live instance of the stand-in.
    unsafe { proc_addr::instance(instance, name.as_ptr()) }
}

fn device_function(device: vk::Device, name: &CStr) -> vk::PFN_vkVoidFunction {
    // As loaders do.
    if !name.to_bytes().starts_with(b"vk") {
        return None;
    }
    // SAFETY: a device of the stand-in, whose memory stays readable.
    unsafe { proc_addr::device(device, name.as_ptr()) }
}

fn create_instance(chain: *const c_void, version: Option<u32>) -> Result<vk::Instance, vk::Result> {
    let application = vk::ApplicationInfo { api_version: version.unwrap_or(0), ..Default::default() };
    let info = vk::InstanceCreateInfo {
        p_next: chain,
        p_application_info: if version.is_some() { &application } else { null() },
        ..Default::default()
    };
    let mut instance = vk::Instance::null();
    let function = instance_function(vk::Instance::null(), c"vkCreateInstance");
    // SAFETY: the name gives the type; the arguments are valid.
    unsafe {
        transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkCreateInstance>(function)(&info, null(), &mut instance)
    }
    .result_with_success(instance)
}

fn new_instance(version: Option<u32>) -> vk::Instance {
    create_instance(fake::instance_chain(null()).0, version).unwrap()
}

fn create_device(
    instance: vk::Instance,
    chain: *const c_void,
    queues: u32,
) -> Result<vk::Device, vk::Result> {
    create_device_with(instance, chain, queues, &[])
}

/// The same with these extensions.
fn create_device_with(
    instance: vk::Instance,
    chain: *const c_void,
    queues: u32,
    extensions: &[&CStr],
) -> Result<vk::Device, vk::Result> {
    let names: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
    let info = vk::DeviceCreateInfo { p_next: chain, queue_create_info_count: queues, ..Default::default() }
        .enabled_extension_names(&names);
    let mut device = vk::Device::null();
    let function = instance_function(instance, c"vkCreateDevice");
    let physical_device = fake::physical_device_of(instance);
    // SAFETY: the name gives the type; the arguments are valid.
    unsafe {
        transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkCreateDevice>(function)(
            physical_device,
            &info,
            null(),
            &mut device,
        )
    }
    .result_with_success(device)
}

fn new_device(instance: vk::Instance) -> vk::Device {
    create_device(instance, fake::device_chain(null(), true).0, 1).unwrap()
}

fn destroy_device(device: vk::Device) {
    let function = device_function(device, c"vkDestroyDevice");
    // SAFETY: the name gives the type; the device is live.
    unsafe { transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkDestroyDevice>(function)(device, null()) }
}

fn destroy_instance(instance: vk::Instance) {
    let function = instance_function(instance, c"vkDestroyInstance");
    // SAFETY: the name gives the type; the instance is live.
    unsafe { transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkDestroyInstance>(function)(instance, null()) }
}

fn link(device: vk::Device) -> Option<&'static LinkTable> {
    let function = device_function(device, GET_LINK_NAME)?;
    // SAFETY: the name gives the type; the table lives as long as the process.
    unsafe { transmute::<unsafe extern "system" fn(), GetLink>(function)().as_ref() }
}

fn record(device: vk::Device) -> Option<DeviceRecord> {
    let mut record = MaybeUninit::uninit();
    // SAFETY: the device is live; a result of 1 means that the record is written.
    unsafe { ((link(device)?.device)(device, record.as_mut_ptr()) == 1).then(|| record.assume_init()) }
}

#[test]
fn negotiates_version_2_and_nothing_older() {
    let offer = |s_type, version| {
        let mut interface = NegotiateLayerInterface {
            s_type,
            p_next: null_mut(),
            loader_layer_interface_version: version,
            get_instance_proc_addr: None,
            get_device_proc_addr: None,
            get_physical_device_proc_addr: None,
        };
        // SAFETY: a valid structure.
        let result = unsafe { negotiate(&mut interface) };
        (result, interface)
    };
    let (result, interface) = offer(1, 7);
    assert_eq!((result, interface.loader_layer_interface_version), (vk::Result::SUCCESS, 2));
    assert!(interface.get_instance_proc_addr.is_some() && interface.get_device_proc_addr.is_some());
    assert!(interface.get_physical_device_proc_addr.is_some());
    assert_eq!(offer(1, 1).0, vk::Result::ERROR_INITIALIZATION_FAILED);
    assert_eq!(offer(0, 2).0, vk::Result::ERROR_INITIALIZATION_FAILED);
    // SAFETY: null is allowed.
    assert_eq!(unsafe { negotiate(null_mut()) }, vk::Result::ERROR_INITIALIZATION_FAILED);
}

#[test]
fn the_next_layer_finds_its_own_link_and_the_chain_as_it_was() {
    let (chain, last) = fake::instance_chain(unknown(1_000_000_001, null()));
    let chain = unknown(1_000_000_000, chain);
    let instance = create_instance(chain, None).unwrap();
    let seen = format!("vkCreateInstance chain [1000000000, 47, 1000000001] link {last:?}");
    assert_eq!(fake::calls(), [seen]);

    let (chain, last) = fake::device_chain(unknown(1_000_000_003, null()), true);
    let device = create_device(instance, unknown(1_000_000_002, chain), 1).unwrap();
    let seen = format!("vkCreateDevice chain [1000000002, 48, 48, 1000000003] link {last:?}");
    assert_eq!(fake::calls(), [seen]);
    destroy_device(device);
    destroy_instance(instance);
}

#[test]
fn a_caller_that_is_no_loader_is_refused_and_failures_pass_unchanged() {
    assert_eq!(create_instance(null(), None), Err(vk::Result::ERROR_INITIALIZATION_FAILED));
    let instance = new_instance(None);
    assert_eq!(create_device(instance, null(), 1), Err(vk::Result::ERROR_INITIALIZATION_FAILED));
    let chain = fake::device_chain(null(), true).0;
    assert_eq!(create_device(instance, chain, 99), Err(fake::DEVICE_FAILURE));
    destroy_instance(instance);
}

#[test]
fn the_record_has_the_version_that_both_application_and_device_have() {
    let cases = [
        (None, vk::API_VERSION_1_0),
        (Some(0), vk::API_VERSION_1_0),
        (Some(vk::API_VERSION_1_1), vk::API_VERSION_1_1),
        (Some(vk::API_VERSION_1_3), fake::DEVICE_VERSION),
    ];
    for (requested, expected) in cases {
        let instance = new_instance(requested);
        let device = new_device(instance);
        let record = record(device).unwrap();
        assert_eq!((record.api_version, record.instance, record.device), (expected, instance, device));
        let gdpa: vk::PFN_vkGetDeviceProcAddr = fake::get_device_proc_addr;
        assert_eq!(record.next_get_device_proc_addr as usize, gdpa as usize, "calls bypass this layer");
        destroy_device(device);
        destroy_instance(instance);
    }
}

#[test]
fn commands_without_a_hook_go_straight_to_the_next_layer() {
    let instance = new_instance(None);
    let device = new_device(instance);
    let command: unsafe extern "system" fn() = fake::set_depth_bounds;
    assert_eq!(device_function(device, c"vkCmdSetDepthBounds").map(|f| f as usize), Some(command as usize));
    assert_eq!(
        instance_function(instance, c"vkCmdSetDepthBounds").map(|f| f as usize),
        Some(command as usize)
    );
    assert!(device_function(device, c"vkNobodyHasThis").is_none());
    assert!(instance_function(instance, c"vkNobodyHasThis").is_none());
    // The instance's answers have the device's functions of ours too.
    assert_eq!(
        instance_function(instance, c"vkDestroyDevice").map(|f| f as usize),
        device_function(device, c"vkDestroyDevice").map(|f| f as usize)
    );
    destroy_device(device);
    destroy_instance(instance);
}

#[test]
fn devices_are_told_apart_and_forgotten_before_they_are_destroyed() {
    let instances = [new_instance(None), new_instance(Some(vk::API_VERSION_1_1))];
    let devices = instances.map(|instance| [new_device(instance), new_device(instance)]);
    for (instance, devices) in instances.iter().zip(devices) {
        for device in devices {
            let record = record(device).unwrap();
            assert_eq!((record.instance, record.device), (*instance, device));
        }
    }
    fake::calls();
    destroy_device(devices[0][0]);
    assert_eq!(fake::calls(), [format!("vkDestroyDevice {:x}", devices[0][0].as_raw())]);
    assert!(link(devices[0][0]).is_none(), "forgotten");
    assert!(record(devices[0][1]).is_some() && record(devices[1][0]).is_some(), "the others are not");
    for device in [devices[0][1], devices[1][0], devices[1][1]] {
        destroy_device(device);
    }
    instances.into_iter().for_each(destroy_instance);
    assert!(instance_function(instances[0], c"vkCmdSetDepthBounds").is_none(), "forgotten");
}

#[test]
fn threads_create_and_destroy_at_once() {
    let instance = new_instance(None).as_raw();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..100 {
                    let device = new_device(vk::Instance::from_raw(instance));
                    assert_eq!(record(device).unwrap().device, device);
                    destroy_device(device);
                }
            });
        }
    });
    destroy_instance(vk::Instance::from_raw(instance));
}

#[test]
fn a_device_that_cannot_be_worked_on_offers_no_link() {
    let instance = new_instance(None);
    let device = create_device(instance, fake::device_chain(null(), false).0, 1).unwrap();
    assert!(link(device).is_none());
    assert!(device_function(device, c"vkCmdSetDepthBounds").is_some(), "calls pass");
    destroy_device(device);
    destroy_instance(instance);
}

#[test]
fn active_and_armed_again() {
    let instance = new_instance(None);
    let device = new_device(instance);
    let table = link(device).unwrap();
    assert_eq!((table.version, table.size), (LINK_VERSION, size_of::<LinkTable>() as u32));
    // SAFETY: the device is live.
    let is_active = || unsafe { device::of(device) }.unwrap().is_active();
    assert!(!is_active());
    for (active, expected) in [(1, true), (0, false), (1, true), (1, true), (0, true), (0, false), (0, false)]
    {
        // SAFETY: the device is live.
        unsafe { (table.set_active)(device, active) };
        assert_eq!(is_active(), expected, "two sessions at once, and no more ends than begins");
    }
    destroy_device(device);
    destroy_instance(instance);
}

#[test]
fn the_layer_answers_for_itself_alone() {
    let instance = new_instance(None);
    let function = instance_function(instance, c"vkEnumerateDeviceExtensionProperties");
    let count_of =
        |layer: *const std::ffi::c_char| {
            let mut count = 7;
            let physical_device = fake::physical_device_of(instance);
            // SAFETY: the name gives the type; the arguments are valid.
            let result =
                unsafe {
                    transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkEnumerateDeviceExtensionProperties>(
                        function,
                    )(physical_device, layer, &mut count, null_mut())
                };
            (result, count)
        };
    assert_eq!(count_of(LAYER_NAME.as_ptr()), (vk::Result::SUCCESS, 0));
    assert_eq!(count_of(null()), (vk::Result::SUCCESS, 3), "the next layer's answer");

    let function = instance_function(vk::Instance::null(), c"vkEnumerateInstanceLayerProperties");
    let mut properties = [vk::LayerProperties::default(); 2];
    let mut count = 2;
    // SAFETY: the name gives the type; the arguments are valid.
    let result = unsafe {
        transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkEnumerateInstanceLayerProperties>(function)(
            &mut count,
            properties.as_mut_ptr(),
        )
    };
    assert_eq!((result, count), (vk::Result::SUCCESS, 1));
    assert_eq!(properties[0].layer_name_as_c_str().unwrap(), LAYER_NAME);
    destroy_instance(instance);
}

/// Threads of an application that keep to no order, and submits of the OpenXR half among theirs.
#[test]
fn submits_to_a_queue_come_one_at_a_time() {
    const EACH: u32 = 200;
    let instance = new_instance(None);
    let device = new_device(instance);
    let queue = fake::queue_of(device).as_raw();
    let function = device_function(device, c"vkQueueSubmit");
    // SAFETY: the name gives the type.
    let hooked = unsafe { transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkQueueSubmit>(function) };
    let submits = [hooked, hooked, record(device).unwrap().queue_submit.unwrap()];
    let start = &Barrier::new(submits.len());
    std::thread::scope(|scope| {
        for submit in submits {
            scope.spawn(move || {
                start.wait();
                for _ in 0..EACH {
                    // SAFETY: a live queue, and nothing to submit.
                    let result = unsafe { submit(vk::Queue::from_raw(queue), 0, null(), vk::Fence::null()) };
                    assert_eq!(result, vk::Result::SUCCESS);
                }
            });
        }
    });
    assert_eq!(fake::queue::seen(), [3 * EACH, 0]);
    destroy_device(device);
    destroy_instance(instance);
}
