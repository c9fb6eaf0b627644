//! The kernels of all masks of a device.

use crate::gpu::{Gpu, GpuError};
use crate::kernels::fill::Fill;
use crate::kernels::nearest::NearestKernels;
use std::sync::Arc;

/// The compiled kernels that masks share; a template's pipeline is its own.
pub struct MaskKernels {
    /// Interpolation of colour in skipped blocks.
    pub fill: Fill,
    /// Nearest texels in skipped blocks, of depth and of colour attachments without light.
    pub nearest: NearestKernels,
}

impl MaskKernels {
    /// Compiles them.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        Ok(Self { fill: Fill::new(gpu)?, nearest: NearestKernels::new(gpu)? })
    }
}
