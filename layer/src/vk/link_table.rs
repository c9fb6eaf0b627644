//! What this half offers to the OpenXR half; see [`crate::link`].

use super::{device, runtime_section};
use crate::abi::guard;
use crate::link::{DeviceRecord, GetLink, LINK_VERSION, LinkTable};
use ash::vk;

static TABLE: LinkTable = LinkTable {
    version: LINK_VERSION,
    size: size_of::<LinkTable>() as u32,
    device: device_record,
    set_active,
    runtime_section: set_runtime_section,
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
        "parafovea_vkGetLink.device",
        || 0,
        |_| unsafe {
            let known = device::of(device).and_then(|device| device.record);
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
        "parafovea_vkGetLink.set_active",
        || (),
        |_| unsafe {
            if let Some(device) = device::of(device) {
                device.set_active(active != 0);
            }
        },
    );
}

unsafe extern "C" fn set_runtime_section(enter: u32) {
    runtime_section::set(enter != 0);
}
