//! A layer that does nothing: what any layer costs, as the baseline of the overhead bench.

use crate::layer::{Layer, NextDevice, Tracked, made_as_asked};
use ash::vk;
use std::ffi::CStr;

pub(crate) struct PassThrough {
    next: NextDevice,
}

static TRACKED: Tracked<PassThrough> = Tracked::new();

impl PassThrough {
    fn over(next: NextDevice) -> Self {
        Self { next }
    }
}

impl Layer for PassThrough {
    fn tracked() -> &'static Tracked<Self> {
        &TRACKED
    }

    made_as_asked!();

    fn hook(_: &CStr) -> vk::PFN_vkVoidFunction {
        None
    }

    fn next(&self) -> &NextDevice {
        &self.next
    }
}
