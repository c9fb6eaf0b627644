//! The Vulkan half's end of an OpenXR session: finding the device's record, whichever copy of this library
//! holds it (see [`crate::link`]).

use super::structures::VulkanBinding;
use crate::config::{Arming, device_armed};
use crate::link::{
    DecisionRecord, DeviceEnds, DeviceRecord, FrameTimeRecord, GET_LINK_NAME, GetLink, LINK_VERSION,
    LinkTable, LoaderGetDeviceProcAddr, OfferRecord, PictureRecord, PlanRecord, RATES_COPIED,
    RATES_COPY_LEFT_OUT, RatesCopyRecord, SettingsRecord, ShownRecord, StaleRecord, SwapchainRecord,
};
use crate::status::{Decision, Topic};
use ash::vk;
use ash::vk::Handle;
use parafovea_core::reuse::StaleTiles;
use std::mem::MaybeUninit;

/// A device that the Vulkan half tracks.
#[derive(Clone, Copy)]
pub struct VulkanDevice {
    table: LinkTable,
    /// What the Vulkan half knows of it.
    pub record: DeviceRecord,
    /// Family and index of the queue of the session's graphics binding.
    pub queue: (u32, u32),
}

/// Why a session's device is out of reach, so that the session stays inert.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotLinked {
    /// The process has no libvulkan.so.1 loaded.
    #[error("no Vulkan loader in this process")]
    NoLoader,
    /// Our Vulkan layer is not in the device's chain.
    #[error("the Vulkan half of this layer is not active on the device")]
    NoVulkanHalf,
    /// The Vulkan half comes from another version of this library.
    #[error("the Vulkan half has interface version {0}, the OpenXR half {LINK_VERSION}")]
    OtherVersion(u32),
    /// The Vulkan half is there, but keeps this device inert.
    #[error("the Vulkan half keeps this device inert")]
    Inert,
}

impl VulkanDevice {
    /// Asks the Vulkan loader for the Vulkan half of the device in `binding`.
    ///
    /// # Safety
    ///
    /// The device is live, as `XrGraphicsBindingVulkanKHR` demands.
    pub unsafe fn find(binding: &VulkanBinding) -> Result<Self, NotLinked> {
        let device = vk::Device::from_raw(binding.device as u64);
        // SAFETY: dlopen with RTLD_NOLOAD only looks for a library that is there, and dlsym for its
        // function, which has the type that Vulkan gives it. The reference is kept: never unloaded.
        let get_device_proc_addr = unsafe {
            let loader = libc::dlopen(c"libvulkan.so.1".as_ptr(), libc::RTLD_NOW | libc::RTLD_NOLOAD);
            if loader.is_null() {
                return Err(NotLinked::NoLoader);
            }
            let function = libc::dlsym(loader, c"vkGetDeviceProcAddr".as_ptr());
            std::mem::transmute::<*mut libc::c_void, Option<LoaderGetDeviceProcAddr>>(function)
                .ok_or(NotLinked::NoLoader)?
        };
        // SAFETY: the device is live; only our Vulkan half answers this name, with a GetLink. Its table
        // is valid for the life of the process, and `version` comes first in every version of it.
        unsafe {
            let get_link =
                get_device_proc_addr(device, GET_LINK_NAME.as_ptr()).ok_or(NotLinked::NoVulkanHalf)?;
            let get_link = std::mem::transmute::<unsafe extern "system" fn(), GetLink>(get_link);
            let table = get_link();
            let version = (&raw const (*table).version).read();
            if version != LINK_VERSION || (*table).size as usize != size_of::<LinkTable>() {
                return Err(NotLinked::OtherVersion(version));
            }
            let table = *table;
            let mut record = MaybeUninit::uninit();
            if (table.device)(device, record.as_mut_ptr()) != 1 {
                device_armed(Arming::Inert);
                return Err(NotLinked::Inert);
            }
            let record: DeviceRecord = record.assume_init();
            Arming::from_number(record.arming).inspect(|arming| device_armed(*arming));
            let queue = (binding.queue_family_index, binding.queue_index);
            Ok(Self { table, record, queue })
        }
    }

    /// A device behind a stand-in for the Vulkan half.
    #[cfg(test)]
    pub fn of_table(table: LinkTable, record: DeviceRecord) -> Self {
        Self { table, record, queue: (0, 0) }
    }

    /// Tells the Vulkan half whether a session is bound to the device.
    pub fn set_active(&self, active: bool) {
        // SAFETY: the session that holds this says that the device is live: it outlives its session.
        unsafe { (self.table.set_active)(self.record.device, u32::from(active)) }
    }

    /// Has `call` called when the application destroys the device; false where nobody will.
    pub fn when_it_ends(&self, call: DeviceEnds) -> bool {
        // SAFETY: the device is live, as above.
        unsafe { (self.table.when_it_ends)(self.record.device, call) == 1 }
    }

    /// What the device's backend can do; `None` where the Vulkan half does not say.
    pub fn offer(&self) -> Option<OfferRecord> {
        let mut record = MaybeUninit::uninit();
        // SAFETY: the device is live, as above; the function writes the record if it returns 1.
        unsafe {
            ((self.table.offer)(self.record.device, record.as_mut_ptr()) == 1).then(|| record.assume_init())
        }
    }

    /// Tells the images of a swapchain, or, without any, that it is about to be destroyed.
    ///
    /// # Safety
    ///
    /// What the record points to is valid.
    pub unsafe fn tell_swapchain(&self, record: &SwapchainRecord) {
        // SAFETY: the device is live, as above; the caller vouches for the record.
        unsafe { (self.table.swapchain)(self.record.device, record) }
    }

    /// Tells the newest plan.
    ///
    /// # Safety
    ///
    /// What the record points to is valid.
    pub unsafe fn tell_plan(&self, record: &PlanRecord) {
        // SAFETY: the device is live, as above; the caller vouches for the record.
        unsafe { (self.table.plan)(self.record.device, record) }
    }

    /// Tells a finished picture of an eye.
    ///
    /// # Safety
    ///
    /// As [`PictureRecord`] says.
    pub unsafe fn tell_picture(&self, record: &PictureRecord) {
        // SAFETY: the device is live, as above; the caller vouches for the record.
        unsafe { (self.table.picture)(self.record.device, record) }
    }

    /// Tells what a frame shows.
    ///
    /// # Safety
    ///
    /// What the record points to is valid.
    pub unsafe fn tell_shown(&self, record: &ShownRecord) {
        // SAFETY: the device is live, as above; the caller vouches for the record.
        unsafe { (self.table.shown)(self.record.device, record) }
    }

    /// Tells what the configuration asks for.
    ///
    /// # Safety
    ///
    /// What the record points to is valid.
    pub unsafe fn tell_settings(&self, record: &SettingsRecord) {
        // SAFETY: the device is live, as above; the caller vouches for the record.
        unsafe { (self.table.settings)(self.record.device, record) }
    }

    /// Makes `stale` the tiles of an eye's picture (0: left, 1: right) that the passes of the frame that ended last left out.
    /// `words` is memory that is kept, so that a steady frame allocates nothing.
    pub fn stale(&self, eye: usize, words: &mut Vec<u32>, stale: &mut StaleTiles) {
        stale.clear();
        loop {
            let capacity = words.len() as u32;
            let mut record =
                StaleRecord { extent: [0; 2], texel: [0; 2], words: words.as_mut_ptr(), capacity, count: 0 };
            // SAFETY: the device is live, as above; there are as many words as the record says.
            if unsafe { (self.table.stale)(self.record.device, eye as u32, &raw mut record) } != 1 {
                return;
            }
            match words.get(..record.count as usize) {
                Some(words) => return stale.set_words(record.extent, record.texel, words),
                None => words.resize(record.count as usize, 0),
            }
        }
    }

    /// How many passes had the plan's rates in the frame that ended last.
    pub fn passes_with_rates(&self) -> u32 {
        // SAFETY: the device is live, as above.
        unsafe { (self.table.passes_with_rates)(self.record.device) }
    }

    /// How many passes were recognised as an eye's picture in the frame that ended last, whether rates are on or not.
    pub fn eye_passes(&self) -> u32 {
        // SAFETY: the device is live, as above.
        unsafe { (self.table.eye_passes)(self.record.device) }
    }

    /// Number of the frame that ended last, from 1.
    pub fn frames_ended(&self) -> u64 {
        // SAFETY: the device is live, as above.
        unsafe { (self.table.frames_ended)(self.record.device) }
    }

    /// What the next frame's recognised passes took on the GPU, of which that is known.
    pub fn frame_time(&self) -> Option<FrameTimeRecord> {
        let mut record = MaybeUninit::uninit();
        // SAFETY: the device is live, as above; the function writes the record if it returns 1.
        unsafe {
            ((self.table.frame_time)(self.record.device, record.as_mut_ptr()) == 1)
                .then(|| record.assume_init())
        }
    }

    /// Has the rates copied that the GPU decided last for an eye.
    ///
    /// # Safety
    ///
    /// As [`RatesCopyRecord`] says.
    pub unsafe fn copy_rates(&self, record: &RatesCopyRecord) -> RatesCopy {
        // SAFETY: the device is live, as above; the caller vouches for the record.
        match unsafe { (self.table.copy_rates)(self.record.device, record) } {
            RATES_COPIED => RatesCopy::Submitted,
            RATES_COPY_LEFT_OUT => RatesCopy::LeftOut,
            _ => RatesCopy::OfPlan,
        }
    }

    /// The Vulkan half's decision of that index, from 0; `None` if there are fewer.
    pub fn decision(&self, index: u32) -> Option<Decision> {
        let mut record = MaybeUninit::<DecisionRecord>::uninit();
        // SAFETY: the function takes any index at any time, and writes the record if it returns 1.
        let record = unsafe {
            ((self.table.decision)(index, record.as_mut_ptr()) == 1).then(|| record.assume_init())
        }?;
        // SAFETY: the texts of a record are valid for the life of the process (link/records.rs).
        let (line, reason) =
            unsafe { (text(record.line, record.line_len), text(record.reason, record.reason_len)) };
        Some(Decision { topic: Topic::from_number(record.topic, &reason)?, line })
    }

    /// The layout in which the application left an image of a swapchain.
    pub fn layout(&self, image: vk::Image) -> vk::ImageLayout {
        // SAFETY: the device is live, as above.
        unsafe { (self.table.layout)(self.record.device, image) }
    }

    /// Marks this thread's submits as the runtime's or ours until the result is dropped.
    pub fn runtime_section(&self) -> RuntimeSection {
        // SAFETY: the function takes any thread at any time.
        unsafe { (self.table.runtime_section)(1) };
        RuntimeSection(self.table.runtime_section)
    }
}

/// A text of a record.
///
/// # Safety
///
/// `first` is null, or `len` bytes begin there.
unsafe fn text(first: *const u8, len: u32) -> String {
    if first.is_null() {
        return String::new();
    }
    // SAFETY: the caller vouches for the bytes.
    String::from_utf8_lossy(unsafe { std::slice::from_raw_parts(first, len as usize) }).into_owned()
}

/// What became of a copy of rates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RatesCopy {
    /// It was submitted.
    Submitted,
    /// The GPU decided, but there was no room for the copy.
    LeftOut,
    /// The plan's own rates hold.
    OfPlan,
}

/// A section of a thread in which what is submitted is not the application's.
#[must_use]
pub struct RuntimeSection(unsafe extern "C" fn(u32));

impl Drop for RuntimeSection {
    fn drop(&mut self) {
        // SAFETY: as on entering it.
        unsafe { (self.0)(0) }
    }
}
