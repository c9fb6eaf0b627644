//! The kernels of all masks of a device.

use crate::gpu::{Gpu, GpuError};
use crate::kernels::depth::DepthKernels;
use crate::kernels::fill::Fill;
use std::sync::Arc;

/// The compiled kernels that masks share; a template's pipeline is its own.
pub struct MaskKernels {
    /// Fills skipped blocks of colour.
    pub fill: Fill,
    /// Covers and fills skipped blocks of depth.
    pub depth: DepthKernels,
}

impl MaskKernels {
    /// Compiles them.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        Ok(Self { fill: Fill::new(gpu)?, depth: DepthKernels::new(gpu)? })
    }
}
