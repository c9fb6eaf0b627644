//! The functions of this half for the OpenXR half; see [`crate::link`].

mod report;

use super::armed::Armed;
use super::objects::QueueId;
use super::{device, runtime_section};
use crate::abi::guard;
use crate::link::{
    CapabilitiesRecord, DecisionRecord, DestroyDeviceCallback, DeviceRecord, EyeBufferRecord, EyeViewRecord,
    FrameReportRecord, FrameStart, GetLink, LINK_VERSION, LinkTable, RATES_OF_PLAN, RatesCopyRecord,
    ShownRecord, StaleRecord, SwapchainRecord,
};
use crate::status;
use ash::vk;
use report::{write_report, write_stale};
use smallvec::SmallVec;

static TABLE: LinkTable = LinkTable {
    version: LINK_VERSION,
    size: size_of::<LinkTable>() as u32,
    device: device_record,
    set_active,
    runtime_section: set_runtime_section,
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
};

/// The function behind [`crate::link::GET_LINK_NAME`].
pub fn get_link() -> unsafe extern "system" fn() {
    // SAFETY: any function pointer may be carried as PFN_vkVoidFunction; the other half casts it back to
    // GetLink, by its name.
    unsafe { std::mem::transmute::<GetLink, unsafe extern "system" fn()>(table) }
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn table() -> *const LinkTable {
    &TABLE
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn device_record(device: vk::Device, record: *mut DeviceRecord) -> u32 {
    // SAFETY: the other half passes a live device, and a record to write to (link.rs).
    guard(
        "vkGetParafoveaLink.device",
        || 0,
        |_| unsafe {
            let known = device::of(device).and_then(|device| Some(device.armed.as_ref()?.record));
            match (known, record.as_mut()) {
                (Some(known), Some(record)) => {
                    *record = known;
                    1
                }
                _ => 0,
            }
        },
    )
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn set_active(device: vk::Device, active: u32) {
    // SAFETY: the other half passes a live device (link.rs).
    guard(
        "vkGetParafoveaLink.set_active",
        || (),
        |_| unsafe {
            if let Some(device) = device::of(device) {
                if active != 0 {
                    device.bind_session();
                } else if let (true, Some(armed)) = (device.unbind_session(), &device.armed) {
                    armed.sessions_ended();
                }
            }
        },
    );
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn set_runtime_section(enter: u32) {
    runtime_section::set(enter != 0);
}

/// Runs `act` for an armed device and a record.
///
/// # Safety
///
/// The device is live; `record` is null, or valid with all that it points to during the call.
unsafe fn with_armed<T>(
    call: &'static str,
    device: vk::Device,
    record: *const T,
    act: impl FnOnce(&Armed, &T),
) {
    guard(
        call,
        || (),
        |_| {
            // SAFETY: the device is live and the record null or valid, as `# Safety` demands.
            let (device, record) = unsafe { (device::of(device), record.as_ref()) };
            if let (Some(armed), Some(record)) = (device.as_ref().and_then(|d| d.armed.as_ref()), record) {
                act(armed, record);
            }
        },
    );
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn capabilities(device: vk::Device, record: *mut CapabilitiesRecord) -> u32 {
    // SAFETY: the other half passes a live device, and a record to write to (link.rs).
    guard(
        "vkGetParafoveaLink.capabilities",
        || 0,
        |_| unsafe {
            let known = device::of(device);
            match (known.as_ref().and_then(|known| known.armed.as_ref()), record.as_mut()) {
                (Some(armed), Some(record)) => {
                    *record = armed.capabilities();
                    1
                }
                _ => 0,
            }
        },
    )
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn swapchain(device: vk::Device, record: *const SwapchainRecord) {
    // SAFETY: the other half passes a live device and a valid record (link.rs).
    unsafe {
        with_armed("vkGetParafoveaLink.swapchain", device, record, |armed, record| {
            armed.notify_swapchain(record, slice(record.images, record.image_count as usize));
        });
    }
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn begin_frame(device: vk::Device, start: *const FrameStart) {
    // SAFETY: the other half passes a live device and a valid record (link.rs).
    unsafe {
        with_armed("vkGetParafoveaLink.begin_frame", device, start, |armed, start| note_start(armed, start));
    }
}

/// A frame begins.
///
/// # Safety
///
/// The records are null or valid, and each map has a rate for each tile.
unsafe fn note_start(armed: &Armed, start: &FrameStart) {
    // SAFETY: each is null or valid, as `# Safety` demands.
    let (settings, plan, awaited) =
        unsafe { (start.settings.as_ref(), start.plan.as_ref(), start.awaited.as_ref()) };
    if let Some(settings) = settings {
        // SAFETY: the record states its number of passes.
        let passes = unsafe { slice(settings.passes, settings.passes_len as usize) };
        armed.notify_settings(settings, passes);
    }
    if let Some(plan) = plan {
        let rates = plan.eyes.map(|eye| {
            let [columns, rows] = eye.tiles.map(|count| count as usize);
            // SAFETY: there is a rate for each tile, as `# Safety` demands.
            unsafe { slice(eye.rates, columns.saturating_mul(rows)) }
        });
        armed.frame.set_plan(plan, rates);
        armed.planned_texels.resolve_ahead(&armed.frame, &armed.offered_rates);
    }
    if let Some(awaited) = awaited {
        armed.frame.awaited.set(awaited);
    }
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn eye_buffers(device: vk::Device, records: *const EyeBufferRecord, count: u32) {
    // SAFETY: as above; the images are live until their swapchain is said to end, and this thread may use the queue.
    unsafe {
        with_armed("vkGetParafoveaLink.eye_buffers", device, records, |armed, _| {
            analyze(armed, slice(records, count as usize));
        });
    }
}

/// Analyses eye buffers, except those in images that the application uses on other queues: there they may be drawn to again while they are read.
///
/// # Safety
///
/// The images are live, and this thread may use the queue.
unsafe fn analyze(armed: &Armed, records: &[EyeBufferRecord]) {
    let is_used_beside = |record: &EyeBufferRecord| {
        let [family, index] = record.queue;
        armed.layouts.is_used_on_other_queues(record.image, QueueId { family, index }) == Some(true)
    };
    let used_here = records.iter().filter(|record| !is_used_beside(record));
    let pictures: SmallVec<[_; 4]> =
        used_here.map(|record| (record, armed.layouts.left_in(record.image))).collect();
    if let Some(own) = armed.submitter() {
        // SAFETY: as `# Safety` demands.
        unsafe { armed.perception.analyze(own, &pictures) };
    }
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn eye_view(device: vk::Device, record: *const EyeViewRecord) {
    // SAFETY: as above.
    unsafe {
        with_armed("vkGetParafoveaLink.eye_view", device, record, |armed, record| {
            armed.perception.notify_view(record);
        });
    }
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn end_frame(
    device: vk::Device,
    submission: *const ShownRecord,
    report: *mut FrameReportRecord,
) -> u32 {
    guard(
        "vkGetParafoveaLink.end_frame",
        || 0,
        |_| {
            // SAFETY: the other half passes a live device, a valid record, and one to write to (link.rs).
            let (known, submission, report) =
                unsafe { (device::of(device), submission.as_ref(), report.as_mut()) };
            let armed = known.as_ref().and_then(|known| known.armed.as_ref());
            let (Some(armed), Some(submission), Some(report)) = (armed, submission, report) else { return 0 };
            // SAFETY: the record states the number of elements of each of its arrays (link.rs).
            let (views, flat, depth) = unsafe {
                (
                    slice(submission.views, submission.view_count as usize),
                    slice(submission.flat, submission.flat_count as usize),
                    slice(submission.depth, submission.depth_count as usize),
                )
            };
            armed.frame.skip(submission.skipped_frames);
            if armed.follows_passes() && armed.frame.learns() {
                armed.frame.shown(&armed.objects, views, flat, depth);
            } else {
                armed.frame.end_unlearned(&armed.objects);
            }
            // SAFETY: the words of the record begin at the address in it (link.rs).
            unsafe { write_report(armed, report) };
            1
        },
    )
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn stale(device: vk::Device, eye: u32, record: *mut StaleRecord) -> u32 {
    // SAFETY: the other half passes a live device, and a record to write to, whose words begin at the address in it (link.rs).
    guard(
        "vkGetParafoveaLink.stale",
        || 0,
        |_| unsafe {
            let known = device::of(device);
            let armed = known.as_ref().and_then(|known| known.armed.as_ref());
            let (Some(armed), Some(record)) = (armed, record.as_mut()) else { return 0 };
            write_stale(&armed.frame.log(), eye as usize, record);
            u32::from(record.count > 0)
        },
    )
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn copy_rates(device: vk::Device, record: *const RatesCopyRecord) -> u32 {
    // SAFETY: the other half passes a live device and a valid record, which describes its buffer and queue correctly (link.rs).
    guard(
        "vkGetParafoveaLink.copy_rates",
        || 0,
        |_| unsafe {
            let known = device::of(device);
            match (known.as_ref().and_then(|known| known.armed.as_ref()), record.as_ref()) {
                (Some(armed), Some(record)) => armed.perception.copy_rates(armed.submitter(), record),
                _ => RATES_OF_PLAN,
            }
        },
    )
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn on_device_destroyed(device: vk::Device, call: DestroyDeviceCallback) -> u32 {
    // SAFETY: the other half passes a live device (link.rs).
    guard(
        "vkGetParafoveaLink.on_device_destroyed",
        || 0,
        |_| unsafe {
            let known = device::of(device);
            known.as_ref().and_then(|known| known.armed.as_ref()).map_or(0, |armed| {
                armed.on_device_destroyed(call);
                1
            })
        },
    )
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn is_used_on_other_queues(
    device: vk::Device,
    image: vk::Image,
    queue: *const [u32; 2],
) -> u32 {
    // SAFETY: the other half passes a live device and two numbers (link.rs).
    guard(
        "vkGetParafoveaLink.is_used_on_other_queues",
        || 1,
        |_| unsafe {
            let known = device::of(device);
            let armed = known.as_ref().and_then(|known| known.armed.as_ref());
            let [family, index] = *queue;
            armed
                .map_or(0, |armed| u32::from(armed.is_used_on_other_queues(image, QueueId { family, index })))
        },
    )
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn layout(device: vk::Device, image: vk::Image) -> vk::ImageLayout {
    // SAFETY: the other half passes a live device (link.rs).
    guard(
        "vkGetParafoveaLink.layout",
        || vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        |_| unsafe {
            let known = device::of(device);
            let armed = known.as_ref().and_then(|known| known.armed.as_ref());
            armed.map_or(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL, |armed| armed.layouts.left_in(image))
        },
    )
}

/// # Safety
///
/// As the OpenXR half calls it: devices are live, and records valid for the time of the call (`link.rs`).
unsafe extern "C" fn decision(index: u32, record: *mut DecisionRecord) -> u32 {
    // SAFETY: the other half passes a record to write to (link.rs).
    guard(
        "vkGetParafoveaLink.decision",
        || 0,
        |_| unsafe {
            let (Some(found), Some(record)) = (status::decision(index as usize), record.as_mut()) else {
                return 0;
            };
            let reason = found.topic.reason();
            *record = DecisionRecord {
                topic: found.topic.number(),
                line: found.line.as_ptr(),
                line_len: found.line.len() as u32,
                reason: reason.as_ptr(),
                reason_len: reason.len() as u32,
            };
            1
        },
    )
}

/// An array of a record; empty if there is none.
///
/// # Safety
///
/// `first` is null, or points to `count` values that do not change for `'a`.
unsafe fn slice<'a, T>(first: *const T, count: usize) -> &'a [T] {
    if first.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: the values are there, as `# Safety` demands.
    unsafe { std::slice::from_raw_parts(first, count) }
}
