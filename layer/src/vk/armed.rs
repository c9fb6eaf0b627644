//! Everything that is kept of an armed device.

use super::frame::Frame;
use crate::link::{BACKEND_NONE, DeviceRecord, OfferRecord};

/// A device of an enabled process whose loader lets layers make objects of their own.
pub struct Armed {
    /// What the OpenXR half may know.
    pub record: DeviceRecord,
    /// What the OpenXR half told, and what the frame under way did.
    pub frame: Frame,
}

impl Armed {
    /// For the device of that record.
    pub fn new(record: DeviceRecord) -> Self {
        Self { record, frame: Frame::default() }
    }

    /// What the device's backend can do.
    pub fn offer(&self) -> OfferRecord {
        OfferRecord { backend: BACKEND_NONE, texel: [1, 1], rate_count: 0, rates: [0; 16], is_cpu: 0 }
    }
}
