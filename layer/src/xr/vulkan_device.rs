//! The Vulkan half's end of an OpenXR session: finding the device's record, whichever copy of this library
//! holds it (see [`crate::link`]).

use super::structures::VulkanBinding;
use crate::config::{Arming, device_armed};
use crate::link::{
    BACKEND_NONE, CapabilitiesRecord, DecisionRecord, DestroyDeviceCallback, DeviceRecord, EyeBufferRecord,
    EyeViewRecord, FrameReportRecord, FrameStart, FrameTimeRecord, GET_LINK_NAME, GetLink, LINK_VERSION,
    LinkTable, LoaderGetDeviceProcAddr, MOST_FRAME_TIMES, RATES_COPIED, RATES_COPY_LEFT_OUT, RatesCopyRecord,
    ShownRecord, StaleRecord, SwapchainRecord,
};
use crate::pass_detection::Feedback;
use crate::status::{Decision, Topic};
use ash::vk;
use ash::vk::Handle;
use parafovea_core::reuse::StaleTiles;
use parafovea_manifest::loader_filters::disabling_word;
use smallvec::SmallVec;
use std::mem::MaybeUninit;

/// A device that the Vulkan half tracks.
#[derive(Clone, Copy)]
pub struct VulkanDevice {
    table: LinkTable,
    /// The Vulkan half's record of it.
    pub record: DeviceRecord,
    /// Family and index of the queue of the session's graphics binding.
    pub queue: (u32, u32),
    /// The abilities of its backend.
    pub capabilities: CapabilitiesRecord,
}

/// Reason why a session's device is out of reach, so that the session stays inert.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotLinked {
    /// The process has no libvulkan.so.1 loaded.
    #[error("no Vulkan loader in this process")]
    NoLoader,
    /// Our Vulkan layer is not in the device's chain.
    #[error("the Vulkan half of this layer is not active on the device")]
    NoVulkanHalf,
    /// The Vulkan loader was told to leave it out, by the user or by the application.
    #[error(
        "VK_LOADER_LAYERS_DISABLE keeps the Vulkan half of this layer out of the application, which may have set it itself; `parafovea run -- PROGRAM` overrules it"
    )]
    Filtered,
    /// The Vulkan half comes from another version of this library.
    #[error("the Vulkan half has interface version {0}, the OpenXR half {LINK_VERSION}")]
    OtherVersion(u32),
    /// The application has handles of another layer, which the driver's functions do not know.
    #[error(
        "a Vulkan layer between the application and this one, such as RenderDoc's, gives the application handles of its own"
    )]
    Wrapped,
    /// The Vulkan half is present, but keeps this device inert.
    #[error("the Vulkan half keeps this device inert")]
    Inert,
}

/// The reason for a missing Vulkan half.
fn no_vulkan_half() -> NotLinked {
    match disabling_word(|name| std::env::var_os(name)) {
        Some(_) => NotLinked::Filtered,
        None => NotLinked::NoVulkanHalf,
    }
}

/// Whether the device of a record is the application's. The loader finds it by its dispatch table, which a handle of another layer has, too.
fn is_same(known: vk::Device, device: vk::Device) -> Result<(), NotLinked> {
    if known == device { Ok(()) } else { Err(NotLinked::Wrapped) }
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
        // SAFETY: the device is live, as `# Safety` demands; only our Vulkan half answers this name, with a GetLink. Its table
        // is valid for the life of the process, and `version` comes first in every version of it.
        let table = unsafe {
            let get_link = get_device_proc_addr(device, GET_LINK_NAME.as_ptr()).ok_or_else(no_vulkan_half)?;
            let get_link = std::mem::transmute::<unsafe extern "system" fn(), GetLink>(get_link);
            let table = get_link();
            let version = (&raw const (*table).version).read();
            if version != LINK_VERSION || (*table).size as usize != size_of::<LinkTable>() {
                return Err(NotLinked::OtherVersion(version));
            }
            *table
        };
        let mut record = MaybeUninit::<DeviceRecord>::uninit();
        // SAFETY: a function of the table, with a live device and a record to write to; 1 means that the record was written.
        let record =
            unsafe { ((table.device)(device, record.as_mut_ptr()) == 1).then(|| record.assume_init()) };
        let Some(record) = record else {
            device_armed(Arming::Inert);
            return Err(NotLinked::Inert);
        };
        is_same(record.device, device)?;
        Arming::from_number(record.arming).inspect(|arming| device_armed(*arming));
        let queue = (binding.queue_family_index, binding.queue_index);
        Ok(Self { table, record, queue, capabilities: capabilities(&table, device) })
    }

    /// A device behind a stand-in for the Vulkan half.
    #[cfg(test)]
    pub fn of_table(table: LinkTable, record: DeviceRecord) -> Self {
        Self { table, record, queue: (0, 0), capabilities: capabilities(&table, record.device) }
    }

    /// Whether the device is a CPU.
    pub fn is_cpu(&self) -> bool {
        self.capabilities.is_cpu == 1
    }

    /// Whether draws to an image may be submitted after the application has returned it.
    pub fn submits_late(&self) -> bool {
        self.record.submits_late == 1
    }

    /// Notifies the Vulkan half whether a session is bound to the device.
    pub fn set_active(&self, active: bool) {
        // SAFETY: the session that holds this guarantees that the device is live: it outlives its session.
        unsafe { (self.table.set_active)(self.record.device, u32::from(active)) }
    }

    /// Registers `call` for the destruction of the device by the application; false if it will not be called.
    pub fn on_device_destroyed(&self, call: DestroyDeviceCallback) -> bool {
        // SAFETY: the device is live, as above.
        unsafe { (self.table.on_device_destroyed)(self.record.device, call) == 1 }
    }

    /// Sends the images of a swapchain, or, without any, the notice that it is about to be destroyed.
    ///
    /// # Safety
    ///
    /// The record is valid, with all that it points to.
    pub unsafe fn notify_swapchain(&self, record: &SwapchainRecord) {
        // SAFETY: the device is live, as above; the record is valid with its arrays, as `# Safety` demands.
        unsafe { (self.table.swapchain)(self.record.device, record) }
    }

    /// Starts a frame with new settings or a new plan.
    ///
    /// # Safety
    ///
    /// The records are null or valid, with all that they point to.
    pub unsafe fn begin_frame(&self, start: &FrameStart) {
        // SAFETY: the device is live, as above; the records are null or valid, as `# Safety` demands.
        unsafe { (self.table.begin_frame)(self.record.device, start) }
    }

    /// Analyses finished eye buffers.
    ///
    /// # Safety
    ///
    /// As [`EyeBufferRecord`] demands.
    pub unsafe fn analyze_eye_buffers(&self, records: &[EyeBufferRecord]) {
        if !records.is_empty() {
            // SAFETY: the device is live, as above; the records are as [`EyeBufferRecord`] demands.
            unsafe { (self.table.eye_buffers)(self.record.device, records.as_ptr(), records.len() as u32) }
        }
    }

    /// Sends the view of an eye buffer.
    pub fn notify_eye_view(&self, record: &EyeViewRecord) {
        // SAFETY: the device is live, as above; the record is plain data.
        unsafe { (self.table.eye_view)(self.record.device, record) }
    }

    /// Ends a frame with its submission, and takes the report on it. A steady frame allocates nothing.
    ///
    /// # Safety
    ///
    /// The record is valid, with all that it points to.
    pub unsafe fn end_frame(&self, submission: &ShownRecord, report: &mut FrameReport) {
        let mut record = FrameReportRecord {
            frame: 0,
            passes_with_rates: 0,
            eye_passes: 0,
            eye_pixels: 0,
            feedback: 0,
            decisions: 0,
            untracked_frames: 0,
            time_count: 0,
            times: [FrameTimeRecord::default(); MOST_FRAME_TIMES],
            stale: report.words.each_mut().map(stale_record),
        };
        // SAFETY: the device is live, as above; the submission is valid, as `# Safety` demands, and there are as many words as the record states.
        let is_written =
            unsafe { (self.table.end_frame)(self.record.device, submission, &raw mut record) == 1 };
        report.frame = record.frame;
        report.passes_with_rates = record.passes_with_rates;
        report.eye_passes = record.eye_passes;
        report.eye_pixels = record.eye_pixels;
        report.feedback = Feedback::from_number(record.feedback);
        report.decisions = record.decisions;
        report.untracked_frames = record.untracked_frames;
        report.times.clear();
        report.times.extend(record.times.into_iter().take(record.time_count as usize));
        for (eye, stale) in record.stale.into_iter().enumerate() {
            report.stale[eye].clear();
            if is_written && stale.count > 0 {
                self.take_stale(eye, &stale, &mut report.words[eye], &mut report.stale[eye]);
            }
        }
    }

    /// Takes the stale tiles of an eye buffer (0: left, 1: right); asks again with more room if they had too little.
    fn take_stale(&self, eye: usize, record: &StaleRecord, words: &mut Vec<u32>, stale: &mut StaleTiles) {
        let mut record = *record;
        loop {
            if let Some(words) = words.get(..record.count as usize) {
                return stale.set_words(record.extent, record.texel, words);
            }
            words.resize(record.count as usize, 0);
            record = stale_record(words);
            // SAFETY: the device is live, as above; there are as many words as the record states.
            if unsafe { (self.table.stale)(self.record.device, eye as u32, &raw mut record) } != 1 {
                return;
            }
        }
    }

    /// Has the rates copied that the GPU decided last for an eye.
    ///
    /// # Safety
    ///
    /// As [`RatesCopyRecord`] demands.
    pub unsafe fn copy_rates(&self, record: &RatesCopyRecord) -> RatesCopy {
        // SAFETY: the device is live, as above; the record is as [`RatesCopyRecord`] demands.
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

    /// Whether the application has submitted commands that use an image of a swapchain to a queue other than the session's, or, before any
    /// submit with it, could.
    pub fn is_used_on_other_queues(&self, image: vk::Image) -> bool {
        let queue = [self.queue.0, self.queue.1];
        // SAFETY: the device is live, as above; the numbers are read during the call.
        unsafe { (self.table.is_used_on_other_queues)(self.record.device, image, &queue) == 1 }
    }

    /// Marks this thread's submits as the runtime's or ours until the result is dropped.
    pub fn runtime_section(&self) -> RuntimeSection {
        // SAFETY: the function takes any thread at any time.
        unsafe { (self.table.runtime_section)(1) };
        RuntimeSection(self.table.runtime_section)
    }
}

/// The capabilities of a device's backend; no backend if the Vulkan half does not answer.
fn capabilities(table: &LinkTable, device: vk::Device) -> CapabilitiesRecord {
    let mut record =
        CapabilitiesRecord { backend: BACKEND_NONE, texel: [1, 1], rate_count: 0, rates: [0; 16], is_cpu: 0 };
    // SAFETY: the device is live; the record is there to be written to.
    unsafe { (table.capabilities)(device, &raw mut record) };
    record
}

/// A record for stale tiles with room for as many words as there are.
fn stale_record(words: &mut Vec<u32>) -> StaleRecord {
    let capacity = words.len() as u32;
    StaleRecord { extent: [0; 2], texel: [0; 2], words: words.as_mut_ptr(), capacity, count: 0 }
}

/// The Vulkan half's report on a frame that ended.
#[derive(Debug, Default)]
pub struct FrameReport {
    /// Number of the frame, from 1; 0 where the Vulkan half reports nothing.
    pub frame: u64,
    /// Number of passes that had the plan's rates.
    pub passes_with_rates: u32,
    /// Number that distinguishes the set of passes recognised as an eye buffer, whether rates are on or not, from other sets; 0: none.
    pub eye_passes: u32,
    /// Pixels of the largest picture of these passes; 0: none.
    pub eye_pixels: u32,
    /// Whether passes read eye buffers of earlier frames.
    pub feedback: Feedback,
    /// Number of decisions so far.
    pub decisions: u32,
    /// Frames from the next one on whose passes the Vulkan half does not follow.
    pub untracked_frames: u32,
    /// GPU times of earlier frames that became known.
    pub times: SmallVec<[FrameTimeRecord; MOST_FRAME_TIMES]>,
    /// Stale tiles of the left and of the right eye buffer.
    pub stale: [StaleTiles; 2],
    /// Memory that stale tiles are written to.
    words: [Vec<u32>; 2],
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
    // SAFETY: the bytes are there, as `# Safety` demands.
    String::from_utf8_lossy(unsafe { std::slice::from_raw_parts(first, len as usize) }).into_owned()
}

/// Outcome of a copy of rates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RatesCopy {
    /// It was submitted.
    Submitted,
    /// The GPU decided, but there was no room for the copy.
    LeftOut,
    /// The plan's own rates hold.
    OfPlan,
}

/// A section of a thread whose submits are not the application's.
#[must_use]
pub struct RuntimeSection(unsafe extern "C" fn(u32));

impl Drop for RuntimeSection {
    fn drop(&mut self) {
        // SAFETY: as on entering it.
        unsafe { (self.0)(0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// RenderDoc's handle has the dispatch table of the device, and so finds its record.
    #[test]
    fn a_handle_of_another_layer_is_out_of_reach() {
        let [known, wrapped] = [0x1000, 0x2000].map(vk::Device::from_raw);
        assert_eq!(is_same(known, known), Ok(()));
        assert_eq!(is_same(known, wrapped), Err(NotLinked::Wrapped));
    }
}
