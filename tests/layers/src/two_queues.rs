//! A layer that gives a device with one queue in a family a second one, which is the same queue under another handle: for
//! applications that need two, on lavapipe. A device with one family has another one with the same properties, whose only queue is that
//! queue again.
//!
//! It is the lowest, below validation, which thus sees two queues. Work on both runs in the order of the submits: more order than an
//! application may rely on, so that a missing semaphore between queues shows in validation alone.

use crate::functions::functions;
use crate::layer::{Instance, Layer, NextDevice, Tracked, device_of, hooks, instance_of};
use ash::vk;
use ash::vk::Handle;
use std::ffi::CStr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Queues of a family that has fewer.
const QUEUES: u32 = 2;

functions! {
    /// The next layer's functions that it may lack.
    Functions {
        get_device_queue2: PFN_vkGetDeviceQueue2 = c"vkGetDeviceQueue2";
        queue_submit2: PFN_vkQueueSubmit2 = c"vkQueueSubmit2" | c"vkQueueSubmit2KHR";
    }
}

pub(crate) struct TwoQueues {
    next: NextDevice,
    functions: Functions,
    /// Queues of each family of the device.
    counts: Vec<u32>,
    /// The other handles of queues. Submits are made under its lock: two threads may use both of a pair.
    seconds: Mutex<Seconds>,
}

/// Boxed, because their addresses are handles.
type Seconds = Vec<Box<Second>>;

/// Another handle of a queue. As for every dispatchable object, its first word is the loader's.
#[repr(C)]
struct Second {
    dispatch: usize,
    queue: vk::Queue,
    family: u32,
}

impl Second {
    fn handle(&self) -> vk::Queue {
        vk::Queue::from_raw(std::ptr::from_ref(self) as u64)
    }
}

static TRACKED: Tracked<TwoQueues> = Tracked::new();

impl Layer for TwoQueues {
    fn tracked() -> &'static Tracked<Self> {
        &TRACKED
    }

    /// # Safety
    /// As [`Layer::create_device`].
    unsafe fn create_device(
        instance: &Instance,
        physical_device: vk::PhysicalDevice,
        mut info: vk::DeviceCreateInfo<'_>,
        create: &mut dyn FnMut(&vk::DeviceCreateInfo<'_>) -> Result<NextDevice, vk::Result>,
    ) -> Result<Self, vk::Result> {
        // SAFETY: the caller vouches for handle and structure; the second call has the room that the first asked for.
        unsafe {
            let mut count = 0;
            (instance.queue_families)(physical_device, &mut count, std::ptr::null_mut());
            let mut families = vec![vk::QueueFamilyProperties::default(); count as usize];
            (instance.queue_families)(physical_device, &mut count, families.as_mut_ptr());
            let counts: Vec<u32> = families.iter().map(|family| family.queue_count).collect();
            let asked = match info.queue_create_info_count {
                0 => &[][..],
                asked => std::slice::from_raw_parts(info.p_queue_create_infos, asked as usize),
            };
            let mut fewer = Vec::new();
            for &queues in asked {
                let queue_family_index = own_family(&counts, queues.queue_family_index);
                let is_same = |known: &vk::DeviceQueueCreateInfo<'_>| {
                    known.queue_family_index == queue_family_index && known.flags == queues.flags
                };
                if fewer.iter().any(is_same) {
                    continue;
                }
                let there = counts.get(queue_family_index as usize).copied().unwrap_or(0);
                let queue_count = queues.queue_count.min(there);
                fewer.push(vk::DeviceQueueCreateInfo { queue_family_index, queue_count, ..queues });
            }
            info.p_queue_create_infos = fewer.as_ptr();
            info.queue_create_info_count = fewer.len() as u32;
            let next = create(&info)?;
            let functions = Functions::load(|name| next.function(name));
            Ok(Self { next, functions, counts, seconds: Mutex::default() })
        }
    }

    fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
        hooks! { name;
            c"vkGetPhysicalDeviceQueueFamilyProperties": PFN_vkGetPhysicalDeviceQueueFamilyProperties = families;
            c"vkGetPhysicalDeviceQueueFamilyProperties2":
                PFN_vkGetPhysicalDeviceQueueFamilyProperties2 = families2;
            c"vkGetPhysicalDeviceQueueFamilyProperties2KHR":
                PFN_vkGetPhysicalDeviceQueueFamilyProperties2 = families2;
            c"vkCreateCommandPool": PFN_vkCreateCommandPool = create_pool;
            c"vkGetDeviceQueue": PFN_vkGetDeviceQueue = get_queue;
            c"vkGetDeviceQueue2": PFN_vkGetDeviceQueue2 = get_queue2;
            c"vkQueueSubmit": PFN_vkQueueSubmit = submit;
            c"vkQueueSubmit2": PFN_vkQueueSubmit2 = submit2;
            c"vkQueueSubmit2KHR": PFN_vkQueueSubmit2 = submit2;
            c"vkQueueWaitIdle": PFN_vkQueueWaitIdle = wait_idle;
        }
        None
    }

    fn next(&self) -> &NextDevice {
        &self.next
    }
}

impl TwoQueues {
    fn seconds(&self) -> MutexGuard<'_, Seconds> {
        self.seconds.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a queue is one that the device does not have.
    fn is_second(&self, family: u32, index: u32) -> bool {
        self.counts.get(family as usize).is_none_or(|&count| index >= count)
    }

    /// The other handle of a family's first queue, which `get` gives.
    fn second(&self, family: u32, get: impl FnOnce() -> vk::Queue) -> vk::Queue {
        let mut seconds = self.seconds();
        if let Some(known) = seconds.iter().find(|known| known.family == family) {
            return known.handle();
        }
        let queue = get();
        // SAFETY: a live queue, whose first word is the loader's.
        let dispatch = unsafe { *(queue.as_raw() as *const usize) };
        let new = Box::new(Second { dispatch, queue, family });
        let handle = new.handle();
        seconds.push(new);
        handle
    }

    /// Calls with the device's own handle of a queue, one caller at a time.
    fn with<R>(&self, queue: vk::Queue, call: impl FnOnce(vk::Queue) -> R) -> R {
        let seconds = self.seconds();
        let own = seconds.iter().find(|known| known.handle() == queue).map_or(queue, |known| known.queue);
        call(own)
    }
}

/// # Safety
///
/// `object` is a live device or queue.
unsafe fn layer(object: impl Handle) -> Arc<TwoQueues> {
    // SAFETY: the caller vouches for it.
    match unsafe { device_of(object) } {
        Some(layer) => layer,
        None => panic!("an object of a device that was created without this layer"),
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceQueueFamilyProperties`.
unsafe extern "system" fn families(
    physical_device: vk::PhysicalDevice,
    count: *mut u32,
    properties: *mut vk::QueueFamilyProperties,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(instance) = instance_of::<TwoQueues>(physical_device) else { return };
        let next = |count: &mut u32, all| (instance.queue_families)(physical_device, count, all);
        let amend =
            |family: &mut vk::QueueFamilyProperties| family.queue_count = family.queue_count.max(QUEUES);
        list(count, properties, next, amend);
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceQueueFamilyProperties2`.
unsafe extern "system" fn families2(
    physical_device: vk::PhysicalDevice,
    count: *mut u32,
    properties: *mut vk::QueueFamilyProperties2<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let next = instance_of::<TwoQueues>(physical_device)
            .and_then(|instance| instance.physical_device.queue_families2);
        let Some(next) = next else { return };
        let next = |count: &mut u32, all| next(physical_device, count, all);
        let amend = |family: &mut vk::QueueFamilyProperties2<'_>| {
            let own = &mut family.queue_family_properties;
            own.queue_count = own.queue_count.max(QUEUES);
        };
        list(count, properties, next, amend);
    }
}

/// Writes the device's families, from `next`, with the changes of `amend`, and a second one like the first if the device has one: the count alone
/// if `properties` is null.
///
/// # Safety
/// `count` is valid, and `properties` null or with room for as many structures.
unsafe fn list<T>(
    count: *mut u32,
    properties: *mut T,
    next: impl Fn(&mut u32, *mut T),
    amend: impl Fn(&mut T),
) where
    T: Families,
{
    // SAFETY: the caller vouches for `count` and `properties`.
    unsafe {
        let room = *count;
        next(&mut *count, properties);
        let mut own = 0;
        next(&mut own, std::ptr::null_mut());
        if properties.is_null() {
            *count = families_of(own);
            return;
        }
        let listed = std::slice::from_raw_parts_mut(properties, room as usize);
        listed.iter_mut().take(*count as usize).for_each(amend);
        if own == 1 && room > 1 {
            let (first, others) = listed.split_at_mut(1);
            others[0].take_properties(&first[0]);
            *count = 2;
        }
    }
}

/// A structure with the properties of a family.
trait Families {
    /// Takes the properties of another family, with one queue.
    fn take_properties(&mut self, other: &Self);
}

impl Families for vk::QueueFamilyProperties {
    fn take_properties(&mut self, other: &Self) {
        *self = Self { queue_count: 1, ..*other };
    }
}

impl Families for vk::QueueFamilyProperties2<'_> {
    fn take_properties(&mut self, other: &Self) {
        self.queue_family_properties.take_properties(&other.queue_family_properties);
    }
}

/// The number of families that are shown of a device with so many.
fn families_of(own: u32) -> u32 {
    if own == 1 { 2 } else { own }
}

/// The device's own family for one that is shown.
fn own_family(counts: &[u32], family: u32) -> u32 {
    if (family as usize) < counts.len() { family } else { 0 }
}

/// # Safety
/// As `vkCreateCommandPool`.
unsafe extern "system" fn create_pool(
    device: vk::Device,
    info: *const vk::CommandPoolCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pool: *mut vk::CommandPool,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = layer(device);
        let queue_family_index = own_family(&layer.counts, (*info).queue_family_index);
        let info = vk::CommandPoolCreateInfo { queue_family_index, ..*info };
        (layer.next.functions.fp_v1_0().create_command_pool)(device, &info, allocator, pool)
    }
}

/// # Safety
/// As `vkGetDeviceQueue`.
unsafe extern "system" fn get_queue(device: vk::Device, family: u32, index: u32, queue: *mut vk::Queue) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = layer(device);
        let next = layer.next.functions.fp_v1_0().get_device_queue;
        if !layer.is_second(family, index) {
            return next(device, family, index, queue);
        }
        *queue = layer.second(family, || {
            let mut first = vk::Queue::null();
            next(device, own_family(&layer.counts, family), 0, &mut first);
            first
        });
    }
}

/// # Safety
/// As `vkGetDeviceQueue2`.
unsafe extern "system" fn get_queue2(
    device: vk::Device,
    info: *const vk::DeviceQueueInfo2<'_>,
    queue: *mut vk::Queue,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = layer(device);
        let Some(next) = layer.functions.get_device_queue2 else { return };
        let (family, index) = ((*info).queue_family_index, (*info).queue_index);
        if !layer.is_second(family, index) {
            return next(device, info, queue);
        }
        *queue = layer.second(family, || {
            let mut first = vk::Queue::null();
            let queue_family_index = own_family(&layer.counts, family);
            next(device, &vk::DeviceQueueInfo2 { queue_family_index, queue_index: 0, ..*info }, &mut first);
            first
        });
    }
}

/// # Safety
/// As `vkQueueSubmit`.
unsafe extern "system" fn submit(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = layer(queue);
        let next = layer.next.functions.fp_v1_0().queue_submit;
        layer.with(queue, |queue| next(queue, count, submits, fence))
    }
}

/// # Safety
/// As `vkQueueSubmit2`.
unsafe extern "system" fn submit2(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo2<'_>,
    fence: vk::Fence,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = layer(queue);
        let Some(next) = layer.functions.queue_submit2 else { return vk::Result::ERROR_DEVICE_LOST };
        layer.with(queue, |queue| next(queue, count, submits, fence))
    }
}

/// # Safety
/// As `vkQueueWaitIdle`.
unsafe extern "system" fn wait_idle(queue: vk::Queue) -> vk::Result {
    // SAFETY: the application's valid argument.
    unsafe {
        let layer = layer(queue);
        let next = layer.next.functions.fp_v1_0().queue_wait_idle;
        layer.with(queue, |queue| next(queue))
    }
}
