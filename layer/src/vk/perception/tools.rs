//! The kernels, on one device.

use crate::gpu::{Compilation, Compiler, Gpu, GpuError, Later};
use crate::kernels::analyze::Analyze;
use crate::kernels::decide::Decide;
use crate::kernels::mask::MaskPass;
use crate::kernels::resolve::Resolve;
use crate::link::DeviceRecord;
use std::sync::Arc;

/// The kernels that analyse pictures and decide rates.
pub struct Tools {
    pub(super) gpu: Arc<Gpu>,
    pub(super) analyze: Analyze,
    pub(super) decide: Decide,
    pub(super) resolve: Resolve,
    pub(super) mask: MaskPass,
}

impl Tools {
    /// Has the kernels compiled.
    pub(super) fn ask(record: &DeviceRecord) -> Later<Self> {
        let record = *record;
        // SAFETY: the record is of this device, which is live; its compiler ends before it is destroyed, and all that is made of the
        // record is dropped.
        unsafe {
            let make =
                move |compilation: &Arc<Compilation>| Self::new(Gpu::without_queue(&record)?, compilation);
            Compiler::of(&record).ask("rings instead of rates by contrast", make)
        }
    }

    fn new(gpu: Arc<Gpu>, compilation: &Arc<Compilation>) -> Result<Self, GpuError> {
        gpu.compile_with(compilation);
        if !gpu.computes_where_it_draws() {
            return Err(GpuError::Unsupported("a queue with graphics but without compute"));
        }
        let (analyze, decide) = (Analyze::new(&gpu)?, Decide::new(&gpu)?);
        let (resolve, mask) = (Resolve::new(&gpu)?, MaskPass::new(&gpu)?);
        Ok(Self { gpu, analyze, decide, resolve, mask })
    }
}
