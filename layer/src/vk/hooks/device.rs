//! Hooks of devices: creation and destruction.

use super::instance::demands;
use crate::abi::copies::{Copies, room};
use crate::abi::guard;
use crate::backend::attachment;
use crate::backend::attachment::create::Enabled;
use crate::backend::attachment::{NoRates, RateAttachments};
use crate::backend::mask::Masks;
use crate::config::{Arming, Demands, device_armed};
use crate::link::DeviceRecord;
use crate::status::{Topic, decided};
use crate::vk::armed::Armed;
use crate::vk::chain::{self, NextDevice, Saved};
use crate::vk::device::{self, Device};
use crate::vk::dispatch_key::DispatchKey;
use crate::vk::functions::{ArmedTable, DeviceTable};
use crate::vk::instance::{self, Instance, properties};
use crate::vk::memory_model::with_device_scope;
use crate::vk::{quirks, recording, submit};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// `vkCreateDevice`. Fails with `ERROR_INITIALIZATION_FAILED` when the caller is not a Vulkan loader.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create(
    physical_device: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    device: *mut vk::Device,
) -> vk::Result {
    // SAFETY: `info` and `device` are valid, by the valid usage of vkCreateDevice; the loader's structure in the chain is valid, by the
    // layer interface.
    let before = unsafe { Saved::of(device, chain::device_link(info)) };
    guard(
        "vkCreateDevice",
        // SAFETY: as above, and all is as it was before the hook.
        || unsafe {
            before.restore();
            create_tracked(physical_device, info, allocator, device, false).0
        },
        |answer| {
            // SAFETY: the application's own arguments.
            let (result, state) = unsafe { create_tracked(physical_device, info, allocator, device, true) };
            let result = answer.record(result);
            if let Some(state) = state {
                tracing::info!("Vulkan device: {state}");
            }
            result
        },
    )
}

/// Creates a device and tracks it, armed if that is `wanted` and the instance is enabled. Returns its state, too.
///
/// # Safety
///
/// The arguments of vkCreateDevice, as a Vulkan loader hands them to a layer.
unsafe fn create_tracked(
    physical_device: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    device: *mut vk::Device,
    wanted: bool,
) -> (vk::Result, Option<&'static str>) {
    const FAILED: (vk::Result, Option<&str>) = (vk::Result::ERROR_INITIALIZATION_FAILED, None);
    // SAFETY: handle and `info` are valid, by the valid usage of vkCreateDevice; the chain is as the loader made it.
    let found = unsafe { instance::of(physical_device).zip(chain::advance_device(info)) };
    let Some((instance, mut next)) = found else { return FAILED };
    let name = c"vkCreateDevice".as_ptr();
    // SAFETY: the loader gave the pointer, the instance is live, and the name gives the type.
    let create = unsafe {
        std::mem::transmute::<vk::PFN_vkVoidFunction, Option<vk::PFN_vkCreateDevice>>((next
            .get_instance_proc_addr)(
            instance.handle, name
        ))
    };
    let Some(create) = create else { return FAILED };
    if !wanted {
        // Without it no device is armed.
        next.set_device_loader_data = None;
    }
    let may_be_armed = instance.enabled && next.set_device_loader_data.is_some();
    let demands = if may_be_armed { demands() } else { Demands::NOTHING };
    let below = Below { create, instance: &instance, physical_device, info, allocator, device };
    // SAFETY: the application's own arguments; the loader's structure is advanced.
    let (result, enabled) = unsafe { below.create(demands.arming) };
    if result != vk::Result::SUCCESS {
        return (result, None);
    }
    // SAFETY: the call succeeded, so `device` points to a live device of the next layer.
    match unsafe { track(&instance, physical_device, *device, next, (demands, enabled)) } {
        Some(state) => (result, Some(state)),
        None => FAILED,
    }
}

/// The call down to create a device.
struct Below<'a> {
    create: vk::PFN_vkCreateDevice,
    instance: &'a Instance,
    physical_device: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo<'a>,
    allocator: *const vk::AllocationCallbacks<'a>,
    device: *mut vk::Device,
}

impl Below<'_> {
    /// Creates the device, with rate attachments where the configuration asks for rates and they are possible, with the features of our
    /// shaders unless the device is to be inert, or else exactly as the application asks. Returns the enabled parts of rate attachments.
    ///
    /// # Safety
    ///
    /// The arguments of vkCreateDevice, with which the next layer's may be called.
    unsafe fn create(&self, arming: Arming) -> (vk::Result, Option<Enabled>) {
        let mut room = room::<128>();
        let mut copies = Copies::new(&mut room);
        // SAFETY: the arguments are valid, as `# Safety` demands.
        let (scoped, is_scoped) = unsafe {
            let info = &*self.info;
            if arming == Arming::Inert {
                (*info, false)
            } else {
                with_device_scope(self.instance, self.physical_device, info, &mut copies)
            }
        };
        if arming == Arming::Rates {
            // SAFETY: the arguments are valid, as `# Safety` demands.
            match unsafe { self.create_with_rates(&scoped) } {
                Ok(enabled) => {
                    tracing::info!("rate attachments: {:?}", enabled.capabilities);
                    quirks::log(&enabled.quirks, &self.instance.engine);
                    return (vk::Result::SUCCESS, Some(enabled));
                }
                Err(reason) => decided(Topic::NoBackend, &format_args!("no rate attachments: {reason}")),
            }
        }
        // SAFETY: as above.
        if is_scoped && unsafe { self.create_amended(&scoped) } == vk::Result::SUCCESS {
            return (vk::Result::SUCCESS, None);
        }
        // The application's own structures are as they were.
        drop(copies);
        // SAFETY: as above.
        let result = unsafe { (self.create)(self.physical_device, self.info, self.allocator, self.device) };
        (result, None)
    }

    /// Creates the device with rate attachments beside all that `info` asks for.
    ///
    /// # Safety
    ///
    /// As for [`Self::create`]; `info` is the application's, amended or not.
    unsafe fn create_with_rates(&self, info: &vk::DeviceCreateInfo<'_>) -> Result<Enabled, NoRates> {
        let mut room = room::<128>();
        let mut copies = Copies::new(&mut room);
        let Self { instance, physical_device, .. } = *self;
        // SAFETY: the physical device is a live one of the instance, and `info` valid for the time of the call, as `# Safety` demands.
        let (amended, enabled) = unsafe {
            let version = instance.api_version.min(properties(instance, physical_device).api_version);
            attachment::create::device(instance, physical_device, version, info, &mut copies)?
        };
        // SAFETY: as above.
        match unsafe { self.create_amended(&amended) } {
            vk::Result::SUCCESS => Ok(enabled),
            refused => Err(NoRates::Refused(refused)),
        }
    }

    /// Creates the device as amended. After a failure, the loader's structure and the handle are as they were.
    ///
    /// # Safety
    ///
    /// As for [`Self::create`].
    unsafe fn create_amended(&self, amended: &vk::DeviceCreateInfo<'_>) -> vk::Result {
        // SAFETY: the handle and the loader's structure are valid, as `# Safety` demands, and no other code writes to them.
        unsafe {
            let before = Saved::of(self.device, chain::device_link(self.info));
            let result = (self.create)(self.physical_device, amended, self.allocator, self.device);
            if result != vk::Result::SUCCESS {
                before.restore();
            }
            result
        }
    }
}

/// Begins to track a device, and returns its state.
///
/// # Safety
///
/// The handles are live and belong together, and `next` is the layer that made the device.
unsafe fn track(
    instance: &Instance,
    physical_device: vk::PhysicalDevice,
    device: vk::Device,
    next: NextDevice,
    (demands, enabled): (Demands, Option<Enabled>),
) -> Option<&'static str> {
    let arming = demands.arming;
    let get_device_proc_addr = next.get_device_proc_addr;
    // SAFETY: the device is a live one of the layer that the pointer belongs to, as `# Safety` demands.
    let get = |name: &CStr| unsafe { get_device_proc_addr(device, name.as_ptr()) };
    // SAFETY: the handles are live, as `# Safety` demands.
    let (key, properties) = unsafe { (DispatchKey::of(device)?, properties(instance, physical_device)) };
    let api_version = instance.api_version.min(properties.api_version);
    let is_cpu = properties.device_type == vk::PhysicalDeviceType::CPU;
    // SAFETY: vkGetDeviceProcAddr returns the device's function of a name, or null.
    let (table, hooked) = unsafe { (DeviceTable::load(get)?, ArmedTable::load(api_version, get)) };
    let set_device_loader_data = next.set_device_loader_data.filter(|_| instance.enabled);
    let is_linked = set_device_loader_data.is_some();
    let wanted = set_device_loader_data.filter(|_| arming != Arming::Inert);
    let armed = wanted.map(|set_device_loader_data| {
        let record = DeviceRecord {
            instance: instance.handle,
            physical_device,
            device,
            api_version,
            next_get_instance_proc_addr: instance.get_instance_proc_addr,
            next_get_device_proc_addr: get_device_proc_addr,
            set_device_loader_data,
            queue_submit: Some(submit::submit_own),
            arming: arming as u32,
            submits_late: u32::from(quirks::submits_late(&instance.engine)),
        };
        // SAFETY: the handles of the record are live, and the pointers come from the layer that made the handles.
        unsafe { arm(record, hooked, (demands, enabled), is_cpu) }
    });
    let state = match (&armed, instance.enabled) {
        (Some(_), _) => "armed",
        (None, false) => "inert",
        (None, true) if is_linked => {
            "inert: the configuration enables nothing; an edit takes effect after a restart of the application"
        }
        (None, true) => "inert: the Vulkan loader offers no vkSetDeviceLoaderData",
    };
    device_armed(if armed.is_some() { arming } else { Arming::Inert });
    if let Some(armed) = &armed {
        recording::compute::device_made(key, &hooked);
        recording::draws::device_made(key, armed);
    }
    device::insert(key, Device::new(armed, table, hooked, get_device_proc_addr, is_linked));
    Some(state)
}

/// The state of a device that is armed: with rate attachments where they are enabled, or else with masks where the passes count.
///
/// # Safety
///
/// The handles of the record are live and belong together, and its pointers are of the layer that made them.
unsafe fn arm(
    record: DeviceRecord,
    hooked: ArmedTable,
    (demands, enabled): (Demands, Option<Enabled>),
    is_cpu: bool,
) -> Arc<Armed> {
    // SAFETY: handles and pointers of the record are valid, as `# Safety` demands.
    let attachments =
        |enabled| unsafe { RateAttachments::on(&record, enabled, is_cpu, demands.coarse_stores) };
    let rates = enabled.and_then(attachments).map(Arc::new);
    let wants_masks = rates.is_none() && demands.arming != Arming::Pictures;
    // SAFETY: as above.
    let masks = wants_masks.then(|| Arc::new(unsafe { Masks::on(&record, is_cpu) }));
    Arc::new(Armed::new(record, hooked, rates, masks))
}

/// `vkDestroyDevice`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy(device: vk::Device, allocator: *const vk::AllocationCallbacks<'_>) {
    // SAFETY: the application vouches that the device is null or live until the call down.
    let key = unsafe { DispatchKey::of(device) };
    let Some((key, known)) = key.and_then(|key| Some((key, device::get(key)?))) else { return };
    let destroy = || {
        device::remove(key);
        // SAFETY: the next layer's function with the application's own arguments.
        unsafe { (known.next.destroy_device)(device, allocator) }
    };
    guard("vkDestroyDevice", destroy, |answer| {
        recording::compute::device_ends(key);
        recording::draws::device_ends(key);
        device::remove(key);
        if let Some(armed) = &known.armed {
            recording::forget_device(armed);
            armed.destroy_own();
        }
        destroy();
        answer.made();
    });
}
