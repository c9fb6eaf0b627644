//! A stand-in for the Vulkan half: it notes its messages.

use crate::config::Arming;
use crate::link::{
    AwaitedPlan, BACKEND_RATE_ATTACHMENT, CapabilitiesRecord, DecisionRecord, DestroyDeviceCallback,
    DeviceRecord, EyeBufferRecord, EyeViewRecord, FrameReportRecord, FrameStart, FrameTimeRecord,
    LINK_VERSION, LinkTable, MOST_FRAME_TIMES, PlanRecord, RatesCopyRecord, SettingsRecord, ShownRecord,
    ShownViewRecord, StaleRecord, SwapchainRecord,
};
use ash::vk;
use ash::vk::Handle;
use parafovea_core::rate::VULKAN_RATES;
use std::cell::{Cell, RefCell};
use std::ffi::{c_char, c_void};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// A message to the Vulkan half.
#[derive(Debug, Clone, PartialEq)]
pub enum Crossing {
    Active(bool),
    Settings { is_on: u32, backend: u32, passes: String },
    Swapchain { swapchain: u64, images: Vec<u64>, extent: [u32; 2], usage: vk::ImageUsageFlags },
    Plan { serial: u64, extents: [[u32; 2]; 2], rates: [Vec<u8>; 2] },
    Shown { views: Vec<ShownViewRecord>, flat: Vec<u64>, depth: Vec<u64> },
}

thread_local! {
    /// Number of recognised passes in a frame.
    pub static PASSES: Cell<u32> = const { Cell::new(0) };
    /// Whether a GPU renders, and its time for a frame, nanoseconds: without rates and with them.
    pub static GPU_NS: Cell<Option<[u64; 2]>> = const { Cell::new(None) };
    /// Pixels of the largest picture of a frame's eye passes: without rates and with them.
    pub static EYE_PIXELS: Cell<[u32; 2]> = const { Cell::new([0; 2]) };
    /// Frames from the next one on that are not followed.
    pub static UNTRACKED_FRAMES: Cell<u32> = const { Cell::new(0) };
    /// Stale tiles of the right eye buffers, in rows of 32 tiles.
    pub static STALE_WORDS: RefCell<Vec<u32>> = const { RefCell::new(Vec::new()) };
    /// Decisions of this half: number of the topic, line and reason.
    pub static DECISIONS: RefCell<Vec<(u32, &'static str, &'static str)>> = const { RefCell::new(Vec::new()) };
    static IS_ON: Cell<bool> = const { Cell::new(false) };
    static FRAMES: Cell<u64> = const { Cell::new(0) };
    /// Time of the frame before last.
    static TIMES: RefCell<Vec<FrameTimeRecord>> = const { RefCell::new(Vec::new()) };
    static CALLS: RefCell<Vec<&'static str>> = const { RefCell::new(Vec::new()) };
    static CROSSINGS: RefCell<Vec<Crossing>> = const { RefCell::new(Vec::new()) };
    /// The device of this thread.
    static DEVICE: u64 = DEVICES.fetch_add(1, Ordering::Relaxed);
}

static DEVICES: AtomicU64 = AtomicU64::new(1);

/// Plans of each device, which a thread of the layer may send.
static PLANS: Mutex<Vec<(u64, Crossing)>> = Mutex::new(Vec::new());

/// Messages of this thread since the last call.
pub fn crossings() -> Vec<Crossing> {
    take_plans();
    CROSSINGS.take()
}

/// Moves the plans of this thread's device to its messages.
fn take_plans() {
    let is_mine = |(device, _): &mut (u64, Crossing)| *device == DEVICE.with(|own| *own);
    let plans: Vec<_> = PLANS.lock().unwrap().extract_if(.., is_mine).collect();
    plans.into_iter().for_each(|(_, plan)| cross(plan));
}

/// The calls of this thread since the last call of this.
pub fn calls() -> Vec<&'static str> {
    CALLS.take()
}

fn note(call: &'static str) {
    CALLS.with_borrow_mut(|calls| calls.push(call));
}

fn cross(crossing: Crossing) {
    CROSSINGS.with_borrow_mut(|received| received.push(crossing));
}

/// A device with tiles of 16 x 16 pixels and all rates.
pub fn table() -> LinkTable {
    LinkTable {
        version: LINK_VERSION,
        size: size_of::<LinkTable>() as u32,
        device,
        set_active,
        runtime_section,
        capabilities,
        swapchain,
        begin_frame,
        eye_buffers,
        eye_view,
        end_frame,
        stale,
        copy_rates,
        on_device_destroyed,
        layout,
        is_used_on_other_queues,
        decision,
    }
}

/// Of a device that receives no calls.
pub fn record() -> DeviceRecord {
    DeviceRecord {
        instance: vk::Instance::null(),
        physical_device: vk::PhysicalDevice::null(),
        device: vk::Device::from_raw(DEVICE.with(|own| *own)),
        api_version: vk::API_VERSION_1_0,
        next_get_instance_proc_addr: no_instance_function,
        next_get_device_proc_addr: no_device_function,
        set_device_loader_data,
        queue_submit: None,
        arming: Arming::Rates as u32,
        submits_late: 0,
    }
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn no_instance_function(_: vk::Instance, _: *const c_char) -> vk::PFN_vkVoidFunction {
    None
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn no_device_function(_: vk::Device, _: *const c_char) -> vk::PFN_vkVoidFunction {
    None
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn set_device_loader_data(_: vk::Device, _: *mut c_void) -> vk::Result {
    vk::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn device(_: vk::Device, _: *mut DeviceRecord) -> u32 {
    0
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn set_active(_: vk::Device, active: u32) {
    cross(Crossing::Active(active == 1));
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn runtime_section(_: u32) {
    note("runtime_section");
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn copy_rates(_: vk::Device, _: *const RatesCopyRecord) -> u32 {
    note("copy_rates");
    0
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn layout(_: vk::Device, _: vk::Image) -> vk::ImageLayout {
    note("layout");
    vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn is_used_on_other_queues(_: vk::Device, _: vk::Image, _: *const [u32; 2]) -> u32 {
    note("is_used_on_other_queues");
    0
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn decision(index: u32, record: *mut DecisionRecord) -> u32 {
    note("decision");
    let Some((topic, line, reason)) =
        DECISIONS.with_borrow(|decisions| decisions.get(index as usize).copied())
    else {
        return 0;
    };
    let [(line, line_len), (reason, reason_len)] =
        [line, reason].map(|text| (text.as_ptr(), text.len() as u32));
    // SAFETY: the other half passes a place for the record.
    unsafe { *record = DecisionRecord { topic, line, line_len, reason, reason_len } };
    1
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn on_device_destroyed(_: vk::Device, _: DestroyDeviceCallback) -> u32 {
    0
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn capabilities(_: vk::Device, record: *mut CapabilitiesRecord) -> u32 {
    note("capabilities");
    let mut rates = [0; 16];
    for (to, rate) in rates.iter_mut().zip(VULKAN_RATES) {
        *to = rate.texel();
    }
    let capabilities = CapabilitiesRecord {
        backend: BACKEND_RATE_ATTACHMENT,
        texel: [16, 16],
        rate_count: VULKAN_RATES.len() as u32,
        rates,
        is_cpu: u32::from(GPU_NS.get().is_none()),
    };
    // SAFETY: the other half passes a place for the record.
    unsafe { *record = capabilities };
    1
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn swapchain(_: vk::Device, record: *const SwapchainRecord) {
    // SAFETY: the other half passes a valid record.
    unsafe {
        let SwapchainRecord { swapchain, images, image_count, extent, usage, .. } = *record;
        let images = slice(images, image_count).iter().map(|image| image.as_raw()).collect();
        cross(Crossing::Swapchain { swapchain, images, extent, usage });
    }
}

/// Plans are awaited at once, as by an application that submits straight after it has located its views.
///
/// # Safety
///
/// As the call.
unsafe extern "C" fn begin_frame(device: vk::Device, start: *const FrameStart) {
    // SAFETY: the other half passes valid records, or null.
    let (settings, plan, awaited) = unsafe {
        let FrameStart { settings, plan, awaited } = *start;
        (settings.as_ref(), plan.as_ref(), awaited.as_ref())
    };
    if let Some(AwaitedPlan { finish: Some(finish), context }) = awaited {
        // SAFETY: the function of the record, with its context.
        unsafe { finish(*context) };
        return take_plans();
    }
    note("begin_frame");
    if let Some(SettingsRecord { is_on, backend, passes, passes_len, .. }) = settings {
        // SAFETY: the record states the length of its array.
        let passes = unsafe { slice(*passes, *passes_len) };
        IS_ON.set(*is_on == 1);
        let passes = String::from_utf8(passes.to_vec()).unwrap();
        cross(Crossing::Settings { is_on: *is_on, backend: *backend, passes });
    }
    if let Some(PlanRecord { serial, eyes }) = plan {
        // SAFETY: a map has a rate for each tile.
        let rates = eyes.map(|eye| unsafe { slice(eye.rates, eye.tiles[0] * eye.tiles[1]) }.to_vec());
        let plan = Crossing::Plan { serial: *serial, extents: eyes.map(|eye| eye.extent), rates };
        PLANS.lock().unwrap().push((device.as_raw(), plan));
    }
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn eye_buffers(_: vk::Device, _: *const EyeBufferRecord, _: u32) {
    note("eye_buffers");
}

unsafe extern "C" fn eye_view(_: vk::Device, _: *const EyeViewRecord) {
    note("eye_view");
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn end_frame(
    _: vk::Device,
    submission: *const ShownRecord,
    report: *mut FrameReportRecord,
) -> u32 {
    note("end_frame");
    // SAFETY: the other half passes a valid record.
    FRAMES.set(FRAMES.get() + 1 + u64::from(unsafe { (*submission).skipped_frames }));
    if let Some(ns) = GPU_NS.get() {
        let ns = ns[usize::from(IS_ON.get())];
        TIMES.with_borrow_mut(|times| {
            times.push(FrameTimeRecord { frame: FRAMES.get(), ns, ..FrameTimeRecord::default() })
        });
    }
    // SAFETY: the other half passes a valid record, and one to write to.
    let report = unsafe {
        let submission = &*submission;
        cross(Crossing::Shown {
            views: slice(submission.views, submission.view_count).to_vec(),
            flat: slice(submission.flat, submission.flat_count).to_vec(),
            depth: slice(submission.depth, submission.depth_count).to_vec(),
        });
        &mut *report
    };
    report.frame = FRAMES.get();
    report.passes_with_rates = if IS_ON.get() { PASSES.get() } else { 0 };
    report.eye_passes = PASSES.get();
    report.eye_pixels = EYE_PIXELS.get()[usize::from(IS_ON.get())];
    report.untracked_frames = UNTRACKED_FRAMES.get();
    report.decisions = DECISIONS.with_borrow(Vec::len) as u32;
    TIMES.with_borrow_mut(|times| {
        let is_old = |time: &&FrameTimeRecord| time.frame + 2 <= FRAMES.get();
        let count = times.iter().take_while(is_old).count().min(MOST_FRAME_TIMES);
        report.times.iter_mut().zip(times.drain(..count)).for_each(|(to, time)| *to = time);
        report.time_count = count as u32;
    });
    for (eye, record) in (0..).zip(&mut report.stale) {
        // SAFETY: as above, with as many words as the record states.
        unsafe { write_stale(eye, record) };
    }
    1
}

/// # Safety
///
/// As the call.
unsafe extern "C" fn stale(_: vk::Device, eye: u32, record: *mut StaleRecord) -> u32 {
    note("stale");
    // SAFETY: the other half passes a record, and as many words as the record states.
    unsafe {
        write_stale(eye, &mut *record);
        u32::from((*record).count > 0)
    }
}

/// # Safety
///
/// `record.words` has room for `record.capacity` words.
unsafe fn write_stale(eye: u32, record: &mut StaleRecord) {
    STALE_WORDS.with_borrow(|words| {
        record.extent = [512, 16 * words.len() as u32];
        record.texel = [16, 16];
        record.count = if eye == 1 { words.len() as u32 } else { 0 };
        if record.count <= record.capacity {
            // SAFETY: there is room for the words, as `# Safety` demands.
            unsafe { record.words.copy_from_nonoverlapping(words.as_ptr(), record.count as usize) };
        }
    });
}

/// # Safety
///
/// `count` values begin at `first`.
unsafe fn slice<'a, T>(first: *const T, count: u32) -> &'a [T] {
    if count == 0 {
        return &[];
    }
    // SAFETY: so many values are there, as `# Safety` demands.
    unsafe { std::slice::from_raw_parts(first, count as usize) }
}
