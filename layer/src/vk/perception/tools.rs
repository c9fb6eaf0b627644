//! The kernels, on one device.

use crate::gpu::{Gpu, GpuError};
use crate::passes::analyze::Analyze;
use crate::passes::decide::Decide;
use crate::passes::lay::Lay;
use crate::passes::mask::MaskPass;
use crate::vk::armed::Armed;
use std::sync::Arc;

/// What pictures are analysed with, and rates decided.
pub struct Tools {
    pub(super) gpu: Arc<Gpu>,
    pub(super) analyze: Analyze,
    pub(super) decide: Decide,
    pub(super) lay: Lay,
    pub(super) mask: MaskPass,
}

impl Tools {
    /// Compiles the kernels; nothing, with one line in the log, where that fails.
    pub(super) fn new(armed: &Armed) -> Option<Self> {
        let make = || {
            // SAFETY: the record is of this device, which is live; all that is made of it is dropped before it is destroyed.
            let gpu = unsafe { Gpu::without_queue(&armed.record) }?;
            if !gpu.computes_where_it_draws() {
                return Err(GpuError::Unsupported("a queue that can draw and not compute"));
            }
            let (analyze, decide) = (Analyze::new(&gpu)?, Decide::new(&gpu)?);
            let (lay, mask) = (Lay::new(&gpu)?, MaskPass::new(&gpu)?);
            Ok(Self { gpu, analyze, decide, lay, mask })
        };
        make().inspect_err(|error| error.tell("rates by eccentricity alone")).ok()
    }
}
