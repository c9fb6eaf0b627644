//! A stand-in for the Vulkan half: it notes what it is told.

use crate::config::Arming;
use crate::link::{
    BACKEND_RATE_ATTACHMENT, DecisionRecord, DeviceEnds, DeviceRecord, FrameTimeRecord, LINK_VERSION,
    LinkTable, OfferRecord, PictureRecord, PlanRecord, RatesCopyRecord, SettingsRecord, ShownRecord,
    ShownViewRecord, StaleRecord, SwapchainRecord,
};
use ash::vk;
use ash::vk::Handle;
use parafovea_core::rate::VULKAN_RATES;
use std::cell::{Cell, RefCell};
use std::ffi::{c_char, c_void};

/// Something that was told.
#[derive(Debug, Clone, PartialEq)]
pub enum Told {
    Active(bool),
    Settings { is_on: u32, backend: u32, passes: String },
    Swapchain { swapchain: u64, images: Vec<u64>, extent: [u32; 2], usage: vk::ImageUsageFlags },
    Plan { serial: u64, extents: [[u32; 2]; 2], rates: [Vec<u8>; 2] },
    Shown { views: Vec<ShownViewRecord>, flat: Vec<u64>, depth: Vec<u64> },
}

thread_local! {
    /// How many passes of a frame are recognised.
    pub static PASSES: Cell<u32> = const { Cell::new(0) };
    /// Whether a GPU renders, and what a frame takes there, nanoseconds: without rates and with them.
    pub static GPU_NS: Cell<Option<[u64; 2]>> = const { Cell::new(None) };
    /// What is left out of the right eye's pictures, in rows of 32 tiles.
    pub static STALE_WORDS: RefCell<Vec<u32>> = const { RefCell::new(Vec::new()) };
    /// Decisions of this half: number of the topic, line and reason.
    pub static DECISIONS: RefCell<Vec<(u32, &'static str, &'static str)>> = const { RefCell::new(Vec::new()) };
    static IS_ON: Cell<bool> = const { Cell::new(false) };
    static FRAMES: Cell<u64> = const { Cell::new(0) };
    /// What the frame before last took.
    static TIMES: RefCell<Vec<FrameTimeRecord>> = const { RefCell::new(Vec::new()) };
    static TOLD: RefCell<Vec<Told>> = const { RefCell::new(Vec::new()) };
}

/// What this thread told since the last call.
pub fn told() -> Vec<Told> {
    TOLD.take()
}

fn tell(what: Told) {
    TOLD.with_borrow_mut(|told| told.push(what));
}

/// A device with tiles of 16 x 16 pixels and all rates.
pub fn table() -> LinkTable {
    LinkTable {
        version: LINK_VERSION,
        size: size_of::<LinkTable>() as u32,
        device,
        set_active,
        runtime_section,
        offer,
        swapchain,
        plan,
        picture,
        shown,
        settings,
        stale,
        passes_with_rates,
        eye_passes,
        frames_ended,
        frame_time,
        copy_rates,
        when_it_ends,
        layout,
        decision,
    }
}

/// Of a device that nobody calls.
pub fn record() -> DeviceRecord {
    DeviceRecord {
        instance: vk::Instance::null(),
        physical_device: vk::PhysicalDevice::null(),
        device: vk::Device::from_raw(1),
        api_version: vk::API_VERSION_1_0,
        next_get_instance_proc_addr: no_instance_function,
        next_get_device_proc_addr: no_device_function,
        set_device_loader_data,
        arming: Arming::Rates as u32,
    }
}

unsafe extern "system" fn no_instance_function(_: vk::Instance, _: *const c_char) -> vk::PFN_vkVoidFunction {
    None
}

unsafe extern "system" fn no_device_function(_: vk::Device, _: *const c_char) -> vk::PFN_vkVoidFunction {
    None
}

unsafe extern "system" fn set_device_loader_data(_: vk::Device, _: *mut c_void) -> vk::Result {
    vk::Result::SUCCESS
}

unsafe extern "C" fn device(_: vk::Device, _: *mut DeviceRecord) -> u32 {
    0
}

unsafe extern "C" fn set_active(_: vk::Device, active: u32) {
    tell(Told::Active(active == 1));
}

unsafe extern "C" fn runtime_section(_: u32) {}

unsafe extern "C" fn copy_rates(_: vk::Device, _: *const RatesCopyRecord) -> u32 {
    0
}

unsafe extern "C" fn layout(_: vk::Device, _: vk::Image) -> vk::ImageLayout {
    vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL
}

unsafe extern "C" fn decision(index: u32, record: *mut DecisionRecord) -> u32 {
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

unsafe extern "C" fn when_it_ends(_: vk::Device, _: DeviceEnds) -> u32 {
    0
}

unsafe extern "C" fn offer(_: vk::Device, record: *mut OfferRecord) -> u32 {
    let mut rates = [0; 16];
    for (to, rate) in rates.iter_mut().zip(VULKAN_RATES) {
        *to = rate.texel();
    }
    let offer = OfferRecord {
        backend: BACKEND_RATE_ATTACHMENT,
        texel: [16, 16],
        rate_count: VULKAN_RATES.len() as u32,
        rates,
        is_cpu: u32::from(GPU_NS.get().is_none()),
    };
    // SAFETY: the other half passes a place for the record.
    unsafe { *record = offer };
    1
}

unsafe extern "C" fn swapchain(_: vk::Device, record: *const SwapchainRecord) {
    // SAFETY: the other half passes a valid record.
    unsafe {
        let SwapchainRecord { swapchain, images, image_count, extent, usage, .. } = *record;
        let images = slice(images, image_count).iter().map(|image| image.as_raw()).collect();
        tell(Told::Swapchain { swapchain, images, extent, usage });
    }
}

unsafe extern "C" fn plan(_: vk::Device, record: *const PlanRecord) {
    // SAFETY: the other half passes a valid record.
    unsafe {
        let PlanRecord { serial, eyes } = *record;
        let rates = eyes.map(|eye| slice(eye.rates, eye.tiles[0] * eye.tiles[1]).to_vec());
        tell(Told::Plan { serial, extents: eyes.map(|eye| eye.extent), rates });
    }
}

unsafe extern "C" fn picture(_: vk::Device, _: *const PictureRecord) {}

unsafe extern "C" fn shown(_: vk::Device, record: *const ShownRecord) {
    FRAMES.set(FRAMES.get() + 1);
    if let Some(ns) = GPU_NS.get() {
        let ns = ns[usize::from(IS_ON.get())];
        TIMES.with_borrow_mut(|times| times.push(FrameTimeRecord { frame: FRAMES.get(), ns }));
    }
    // SAFETY: the other half passes a valid record.
    unsafe {
        let record = &*record;
        tell(Told::Shown {
            views: slice(record.views, record.view_count).to_vec(),
            flat: slice(record.flat, record.flat_count).to_vec(),
            depth: slice(record.depth, record.depth_count).to_vec(),
        });
    }
}

unsafe extern "C" fn settings(_: vk::Device, record: *const SettingsRecord) {
    // SAFETY: the other half passes a valid record.
    unsafe {
        let SettingsRecord { is_on, backend, passes, passes_len, .. } = *record;
        let passes = String::from_utf8(slice(passes, passes_len).to_vec()).unwrap();
        IS_ON.set(is_on == 1);
        tell(Told::Settings { is_on, backend, passes });
    }
}

unsafe extern "C" fn stale(_: vk::Device, eye: u32, record: *mut StaleRecord) -> u32 {
    STALE_WORDS.with_borrow(|words| {
        // SAFETY: the other half passes a record, and as many words as it says.
        unsafe {
            let record = &mut *record;
            record.extent = [512, 16 * words.len() as u32];
            record.texel = [16, 16];
            record.count = words.len() as u32;
            if record.count <= record.capacity {
                record.words.copy_from_nonoverlapping(words.as_ptr(), words.len());
            }
        }
        u32::from(eye == 1 && !words.is_empty())
    })
}

unsafe extern "C" fn passes_with_rates(_: vk::Device) -> u32 {
    if IS_ON.get() { PASSES.get() } else { 0 }
}

unsafe extern "C" fn eye_passes(_: vk::Device) -> u32 {
    PASSES.get()
}

unsafe extern "C" fn frames_ended(_: vk::Device) -> u64 {
    FRAMES.get()
}

unsafe extern "C" fn frame_time(_: vk::Device, record: *mut FrameTimeRecord) -> u32 {
    let is_old = |time: &&FrameTimeRecord| time.frame + 2 <= FRAMES.get();
    let next = TIMES.with_borrow_mut(|times| {
        let is_there = times.first().filter(is_old).is_some();
        is_there.then(|| times.remove(0))
    });
    // SAFETY: the other half passes a place for the record.
    next.map_or(0, |time| unsafe {
        *record = time;
        1
    })
}

/// # Safety
///
/// `count` values begin at `first`.
unsafe fn slice<'a, T>(first: *const T, count: u32) -> &'a [T] {
    if count == 0 {
        return &[];
    }
    // SAFETY: the caller vouches for it.
    unsafe { std::slice::from_raw_parts(first, count as usize) }
}
