//! Devices: creation, tracking, destruction.

use super::armed::Armed;
use super::chain::{self, NextDevice};
use super::dispatch::{ArmedTable, DeviceTable};
use super::dispatch_key::DispatchKey;
use super::instance::{self, Instance};
use super::masks::Masks;
use super::quirks;
use super::rates::create::Enabled;
use super::rates::{self, Copies, NoRates, Rates, room};
use super::recording;
use crate::abi::guard;
use crate::config::{Arming, device_armed};
use crate::link::DeviceRecord;
use crate::registry::Registry;
use crate::status::{Topic, decided};
use ash::vk;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// One live device.
pub struct Device {
    /// What is done on it; `None` for an inert device.
    pub armed: Option<Arc<Armed>>,
    pub next: DeviceTable,
    /// The next layer's functions under the hooks of armed devices.
    pub hooked: ArmedTable,
    pub get_device_proc_addr: vk::PFN_vkGetDeviceProcAddr,
    /// Whether the OpenXR half finds it, if only to learn that it is inert.
    pub is_linked: bool,
    active: AtomicBool,
}

impl Device {
    /// Marks the device active (an OpenXR session is bound to it) or armed again.
    pub fn set_active(&self, active: bool) {
        if self.active.swap(active, Ordering::Relaxed) != active {
            tracing::info!("Vulkan device {}", if active { "active" } else { "idle" });
        }
    }

    /// Its rate attachments; nothing where there are none.
    pub fn rates(&self) -> Option<&Rates> {
        self.armed.as_ref()?.rate_attachments.as_deref()
    }

    /// Its masks; nothing where there are none.
    pub fn masks(&self) -> Option<&Masks> {
        self.armed.as_ref()?.masks.as_deref()
    }

    /// Whether an OpenXR session is bound to the device.
    pub fn is_active(&self) -> bool {
        self.active.load(Ordering::Relaxed)
    }
}

static DEVICES: Registry<DispatchKey, Device> = Registry::new();

/// The device that a device, queue or command buffer belongs to.
///
/// # Safety
///
/// `object` is null, or a live object of one of these kinds.
pub unsafe fn of<H: vk::Handle>(object: H) -> Option<Arc<Device>> {
    // SAFETY: the caller vouches for the handle.
    DEVICES.get(unsafe { DispatchKey::of(object) }?)
}

/// The device that an object belongs to, with the next layer's function that `choose` names. Hooks are given out only where
/// there is that function, so that a call through one finds it.
///
/// # Safety
///
/// As for [`of`].
pub unsafe fn with<H: vk::Handle, F>(
    object: H,
    choose: impl FnOnce(&ArmedTable) -> Option<F>,
) -> Option<(Arc<Device>, F)> {
    // SAFETY: the caller vouches for the handle.
    let device = unsafe { of(object) }?;
    let function = choose(&device.hooked)?;
    Some((device, function))
}

/// `vkCreateDevice`. Fails with `ERROR_INITIALIZATION_FAILED` when the caller is not a Vulkan loader.
pub unsafe extern "system" fn create(
    physical_device: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    device: *mut vk::Device,
) -> vk::Result {
    // SAFETY: the application vouches for `info` and `device` (valid usage of vkCreateDevice), the loader for what it put into the
    // chain, and out of which it reads its own pointers.
    let before = unsafe { (*device, chain::device_link(info).map(|at| (at, *at))) };
    guard(
        "vkCreateDevice",
        || {
            let (handle, link) = before;
            // SAFETY: as above; all is as it was before the hook.
            unsafe {
                *device = handle;
                if let Some((at, link)) = link {
                    *at = link;
                }
                create_tracked(physical_device, info, allocator, device, false).0
            }
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

/// Creates a device and tracks it, armed where that is `wanted` and the instance is enabled. Says in which state it is.
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
    // SAFETY: the caller vouches for the handle, `info` and the chain.
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
    let arming = if may_be_armed { instance::arming() } else { Arming::Inert };
    let below = Below { create, instance: &instance, physical_device, info, allocator, device };
    // SAFETY: the application's own arguments; the loader's structure is advanced.
    let (result, enabled) = unsafe { below.create(arming) };
    if result != vk::Result::SUCCESS {
        return (result, None);
    }
    // SAFETY: the call succeeded, so `device` points to a live device of the next layer.
    match unsafe { track(&instance, physical_device, *device, next, (arming, enabled)) } {
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
    /// Creates the device, with rate attachments where the configuration asks for rates and they are possible, or else
    /// exactly as the application asks. Returns the enabled parts of rate attachments.
    ///
    /// # Safety
    ///
    /// The arguments of vkCreateDevice, with which the next layer's may be called.
    unsafe fn create(&self, arming: Arming) -> (vk::Result, Option<Enabled>) {
        if arming == Arming::Rates {
            // SAFETY: the caller vouches for the arguments.
            match unsafe { self.create_with_rates() } {
                Ok(enabled) => {
                    tracing::info!("rate attachments: {:?}", enabled.offer);
                    quirks::tell(&enabled.quirks, &self.instance.engine);
                    return (vk::Result::SUCCESS, Some(enabled));
                }
                Err(reason) => decided(Topic::NoBackend, &format_args!("no rate attachments: {reason}")),
            }
        }
        // SAFETY: as above.
        let result = unsafe { (self.create)(self.physical_device, self.info, self.allocator, self.device) };
        (result, None)
    }

    /// # Safety
    ///
    /// As for [`Self::create`].
    unsafe fn create_with_rates(&self) -> Result<Enabled, NoRates> {
        // SAFETY: the caller vouches for the arguments. The loader below reads its own pointers out of `device` and
        // of its structure in the chain, which this attempt may change: a second one needs them as they were.
        unsafe {
            let mut room = room::<128>();
            let mut copies = Copies::new(&mut room);
            let Self { instance, physical_device, info, .. } = *self;
            let version = instance.api_version.min(properties(instance, physical_device).api_version);
            let (amended, enabled) =
                rates::create::device(instance, physical_device, version, &*info, &mut copies)?;
            let before = *self.device;
            let link = chain::device_link(info).map(|at| (at, *at));
            let result = (self.create)(physical_device, &amended, self.allocator, self.device);
            if result == vk::Result::SUCCESS {
                return Ok(enabled);
            }
            *self.device = before;
            if let Some((at, link)) = link {
                *at = link;
            }
            Err(NoRates::Refused(result))
        }
    }
}

/// The properties of a physical device, from the next layer.
///
/// # Safety
///
/// `physical_device` is a live one of `instance`.
pub unsafe fn properties(
    instance: &Instance,
    physical_device: vk::PhysicalDevice,
) -> vk::PhysicalDeviceProperties {
    let mut properties = vk::PhysicalDeviceProperties::default();
    // SAFETY: the next layer's function, a live physical device and a structure to write to.
    unsafe { (instance.next.physical_device_properties)(physical_device, &mut properties) };
    properties
}

/// Begins to track a device, and says in which state.
///
/// # Safety
///
/// The handles are live and belong together, and `next` is the layer that made the device.
unsafe fn track(
    instance: &Instance,
    physical_device: vk::PhysicalDevice,
    device: vk::Device,
    next: NextDevice,
    (arming, enabled): (Arming, Option<Enabled>),
) -> Option<&'static str> {
    // SAFETY: the caller vouches for the handles and the pointer.
    unsafe {
        let key = DispatchKey::of(device)?;
        let table = DeviceTable::load(|name| (next.get_device_proc_addr)(device, name.as_ptr()))?;
        let set_device_loader_data = next.set_device_loader_data.filter(|_| instance.enabled);
        let properties = properties(instance, physical_device);
        let api_version = instance.api_version.min(properties.api_version);
        let is_cpu = properties.device_type == vk::PhysicalDeviceType::CPU;
        let hooked = ArmedTable::load(api_version, |name| (next.get_device_proc_addr)(device, name.as_ptr()));
        let is_linked = set_device_loader_data.is_some();
        let wanted = set_device_loader_data.filter(|_| arming != Arming::Inert);
        let armed = wanted.map(|set_device_loader_data| {
            let record = DeviceRecord {
                instance: instance.handle,
                physical_device,
                device,
                api_version,
                next_get_instance_proc_addr: instance.get_instance_proc_addr,
                next_get_device_proc_addr: next.get_device_proc_addr,
                set_device_loader_data,
                arming: arming as u32,
            };
            let rates = enabled.and_then(|enabled| Rates::on(&record, enabled, is_cpu)).map(Arc::new);
            let wants_masks = rates.is_none() && arming != Arming::Pictures;
            let masks = wants_masks.then(|| Arc::new(Masks::on(&record, is_cpu)));
            Arc::new(Armed::new(record, hooked, rates, masks))
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
        if armed.is_some() {
            recording::compute::device_made(key, &hooked);
        }
        DEVICES.insert(
            key,
            Arc::new(Device {
                armed,
                next: table,
                hooked,
                get_device_proc_addr: next.get_device_proc_addr,
                is_linked,
                active: AtomicBool::new(false),
            }),
        );
        Some(state)
    }
}

/// `vkDestroyDevice`.
pub unsafe extern "system" fn destroy(device: vk::Device, allocator: *const vk::AllocationCallbacks<'_>) {
    // SAFETY: the application vouches that the device is null or live until the call down.
    let key = unsafe { DispatchKey::of(device) };
    let Some((key, known)) = key.and_then(|key| Some((key, DEVICES.get(key)?))) else { return };
    let destroy = || {
        DEVICES.remove(key);
        // SAFETY: the next layer's function with the application's own arguments.
        unsafe { (known.next.destroy_device)(device, allocator) }
    };
    guard("vkDestroyDevice", destroy, |answer| {
        recording::compute::device_ends(key);
        DEVICES.remove(key);
        if let Some(armed) = &known.armed {
            recording::forget_device(armed);
            armed.destroy_own();
        }
        destroy();
        answer.made();
    });
}
