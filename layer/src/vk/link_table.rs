//! What this half offers to the OpenXR half; see [`crate::link`].

use super::armed::Armed;
use super::timing::FrameTime;
use super::{device, runtime_section};
use crate::abi::guard;
use crate::link::{
    DecisionRecord, DeviceEnds, DeviceRecord, FrameTimeRecord, GetLink, LINK_VERSION, LinkTable, OfferRecord,
    PictureRecord, PlanRecord, RATES_OF_PLAN, RatesCopyRecord, SettingsRecord, ShownRecord, StaleRecord,
    SwapchainRecord,
};
use crate::status;
use ash::vk;

static TABLE: LinkTable = LinkTable {
    version: LINK_VERSION,
    size: size_of::<LinkTable>() as u32,
    device: device_record,
    set_active,
    runtime_section: set_runtime_section,
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
};

/// The function behind [`crate::link::GET_LINK_NAME`].
pub fn get_link() -> unsafe extern "system" fn() {
    // SAFETY: any function pointer may be carried as PFN_vkVoidFunction; the other half casts it back to
    // GetLink, by its name.
    unsafe { std::mem::transmute::<GetLink, unsafe extern "system" fn()>(table) }
}

unsafe extern "C" fn table() -> *const LinkTable {
    &TABLE
}

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

unsafe extern "C" fn set_active(device: vk::Device, active: u32) {
    // SAFETY: the other half passes a live device (link.rs).
    guard(
        "vkGetParafoveaLink.set_active",
        || (),
        |_| unsafe {
            if let Some(device) = device::of(device) {
                device.set_active(active != 0);
                if let (0, Some(armed)) = (active, &device.armed) {
                    armed.perception.forget();
                }
            }
        },
    );
}

unsafe extern "C" fn set_runtime_section(enter: u32) {
    runtime_section::set(enter != 0);
}

/// Runs `act` for an armed device and a record.
///
/// # Safety
///
/// The device is live; `record` is null, or valid with what it points to during the call.
unsafe fn told<T>(call: &'static str, device: vk::Device, record: *const T, act: impl FnOnce(&Armed, &T)) {
    guard(
        call,
        || (),
        |_| {
            // SAFETY: the caller vouches for both.
            let (device, record) = unsafe { (device::of(device), record.as_ref()) };
            if let (Some(armed), Some(record)) = (device.as_ref().and_then(|d| d.armed.as_ref()), record) {
                act(armed, record);
            }
        },
    );
}

unsafe extern "C" fn offer(device: vk::Device, record: *mut OfferRecord) -> u32 {
    // SAFETY: the other half passes a live device, and a record to write to (link.rs).
    guard(
        "vkGetParafoveaLink.offer",
        || 0,
        |_| unsafe {
            let known = device::of(device);
            match (known.as_ref().and_then(|known| known.armed.as_ref()), record.as_mut()) {
                (Some(armed), Some(record)) => {
                    *record = armed.offer();
                    1
                }
                _ => 0,
            }
        },
    )
}

unsafe extern "C" fn swapchain(device: vk::Device, record: *const SwapchainRecord) {
    // SAFETY: the other half passes a live device and a valid record (link.rs).
    unsafe {
        told("vkGetParafoveaLink.swapchain", device, record, |armed, record| {
            armed.tell_swapchain(record, slice(record.images, record.image_count as usize));
        });
    }
}

unsafe extern "C" fn plan(device: vk::Device, record: *const PlanRecord) {
    // SAFETY: as above; each map has a rate for each tile.
    unsafe {
        told("vkGetParafoveaLink.plan", device, record, |armed, record| {
            let rates = record.eyes.map(|eye| {
                let [columns, rows] = eye.tiles.map(|count| count as usize);
                slice(eye.rates, columns.saturating_mul(rows))
            });
            armed.frame.set_plan(record, rates);
        });
    }
}

unsafe extern "C" fn picture(device: vk::Device, record: *const PictureRecord) {
    // SAFETY: as above; the image is live until its swapchain is said to end, and this thread may use the queue.
    unsafe {
        told("vkGetParafoveaLink.picture", device, record, |armed, record| {
            armed.perception.analyze(armed, record);
        });
    }
}

unsafe extern "C" fn shown(device: vk::Device, record: *const ShownRecord) {
    // SAFETY: as above.
    unsafe {
        told("vkGetParafoveaLink.shown", device, record, |armed, record| {
            armed.frame.shown(
                &armed.objects,
                slice(record.views, record.view_count as usize),
                slice(record.flat, record.flat_count as usize),
                slice(record.depth, record.depth_count as usize),
            );
        });
    }
}

unsafe extern "C" fn settings(device: vk::Device, record: *const SettingsRecord) {
    // SAFETY: as above.
    unsafe {
        told("vkGetParafoveaLink.settings", device, record, |armed, record| {
            armed.tell_settings(record, slice(record.passes, record.passes_len as usize));
        });
    }
}

unsafe extern "C" fn stale(device: vk::Device, eye: u32, record: *mut StaleRecord) -> u32 {
    // SAFETY: the other half passes a live device, and a record to write to, whose words begin where it says (link.rs).
    guard(
        "vkGetParafoveaLink.stale",
        || 0,
        |_| unsafe {
            let known = device::of(device);
            let (Some(armed), Some(record)) =
                (known.as_ref().and_then(|known| known.armed.as_ref()), record.as_mut())
            else {
                return 0;
            };
            let log = armed.frame.log();
            let Some(stale) = log.stale(eye as usize).filter(|stale| !stale.is_empty()) else { return 0 };
            let words = stale.words();
            record.extent = stale.extent();
            record.texel = stale.texel();
            record.count = words.len() as u32;
            if record.count <= record.capacity && !record.words.is_null() {
                record.words.copy_from_nonoverlapping(words.as_ptr(), words.len());
            }
            1
        },
    )
}

unsafe extern "C" fn passes_with_rates(device: vk::Device) -> u32 {
    // SAFETY: the other half passes a live device (link.rs).
    guard(
        "vkGetParafoveaLink.passes_with_rates",
        || 0,
        |_| unsafe {
            let known = device::of(device);
            known
                .as_ref()
                .and_then(|known| known.armed.as_ref())
                .map_or(0, |armed| armed.frame.log().with_rates())
        },
    )
}

unsafe extern "C" fn eye_passes(device: vk::Device) -> u32 {
    // SAFETY: the other half passes a live device (link.rs).
    guard(
        "vkGetParafoveaLink.eye_passes",
        || 0,
        |_| unsafe {
            let known = device::of(device);
            known
                .as_ref()
                .and_then(|known| known.armed.as_ref())
                .map_or(0, |armed| armed.frame.log().eye_passes())
        },
    )
}

unsafe extern "C" fn frames_ended(device: vk::Device) -> u64 {
    // SAFETY: the other half passes a live device (link.rs).
    guard(
        "vkGetParafoveaLink.frames_ended",
        || 0,
        |_| unsafe {
            let known = device::of(device);
            known.as_ref().and_then(|known| known.armed.as_ref()).map_or(0, |armed| armed.frame.log().frame())
        },
    )
}

unsafe extern "C" fn frame_time(device: vk::Device, record: *mut FrameTimeRecord) -> u32 {
    // SAFETY: the other half passes a live device, and a record to write to (link.rs).
    guard(
        "vkGetParafoveaLink.frame_time",
        || 0,
        |_| unsafe {
            let known = device::of(device);
            let time = known.as_ref().and_then(|known| known.armed.as_ref()).and_then(|armed| {
                let under_way = armed.frame.log().frame();
                armed.timing.next(under_way)
            });
            match (time, record.as_mut()) {
                (Some(FrameTime { frame, ns }), Some(record)) => {
                    // Frames are numbered from 0 here.
                    *record = FrameTimeRecord { frame: frame + 1, ns };
                    1
                }
                _ => 0,
            }
        },
    )
}

unsafe extern "C" fn copy_rates(device: vk::Device, record: *const RatesCopyRecord) -> u32 {
    // SAFETY: the other half passes a live device and a valid record, whose buffer and queue are as it says (link.rs).
    guard(
        "vkGetParafoveaLink.copy_rates",
        || 0,
        |_| unsafe {
            let known = device::of(device);
            match (known.as_ref().and_then(|known| known.armed.as_ref()), record.as_ref()) {
                (Some(armed), Some(record)) => armed.perception.copy_rates(armed, record),
                _ => RATES_OF_PLAN,
            }
        },
    )
}

unsafe extern "C" fn when_it_ends(device: vk::Device, call: DeviceEnds) -> u32 {
    // SAFETY: the other half passes a live device (link.rs).
    guard(
        "vkGetParafoveaLink.when_it_ends",
        || 0,
        |_| unsafe {
            let known = device::of(device);
            known.as_ref().and_then(|known| known.armed.as_ref()).map_or(0, |armed| {
                armed.when_it_ends(call);
                1
            })
        },
    )
}

unsafe extern "C" fn layout(device: vk::Device, image: vk::Image) -> vk::ImageLayout {
    // SAFETY: the other half passes a live device (link.rs).
    guard(
        "vkGetParafoveaLink.layout",
        || vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        |_| unsafe {
            let known = device::of(device);
            let armed = known.as_ref().and_then(|known| known.armed.as_ref());
            armed
                .and_then(|armed| armed.layouts.of(image))
                .unwrap_or(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
        },
    )
}

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

/// An array of a record; empty where there is none.
///
/// # Safety
///
/// `first` is null, or `count` values begin there that nobody changes for `'a`.
unsafe fn slice<'a, T>(first: *const T, count: usize) -> &'a [T] {
    if first.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: the caller vouches for the values.
    unsafe { std::slice::from_raw_parts(first, count) }
}
