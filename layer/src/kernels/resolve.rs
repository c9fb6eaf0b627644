//! `resolve`: the rates of [`super::decide`], resolved over the picture of a pass of the application.

pub use parafovea_core::kernels::resolve::{RateMapTable, ResolveParams};

use super::analyze::ViewTiles;
use crate::gpu::{
    AppCommands, COMPUTES, ComputeLayout, ComputeSet, DeviceBuffer, Gpu, GpuError, Owned, READS_OF_RESULTS,
    serial,
};
use ash::vk;
use std::sync::Arc;

/// Parameters, table, rates of the left and of the right eye, texels.
const BINDINGS: [vk::DescriptorType; 5] = [vk::DescriptorType::STORAGE_BUFFER; 5];

/// Threads of a workgroup, with four texels for each. The shader has the same number.
const THREADS: u32 = 64;

/// The pass.
pub struct Resolve {
    pipeline: Owned<vk::Pipeline>,
    layout: ComputeLayout,
    gpu: Arc<Gpu>,
}

/// The texels of one rate image.
pub struct RateMapTexels {
    // In the order in which each may be destroyed.
    set: ComputeSet,
    _params: DeviceBuffer,
    _table: DeviceBuffer,
    texels: DeviceBuffer,
    _eyes: [Arc<ViewTiles>; 2],
    len: u32,
    serial: u64,
}

impl RateMapTexels {
    /// The texels, a byte each, row by row, layer by layer, valid as long as `self`. Copies and compute shaders may read them.
    pub fn texels(&self) -> vk::Buffer {
        self.texels.handle()
    }

    /// A number that no other object has ([`crate::gpu::serial`]).
    pub fn serial(&self) -> u64 {
        self.serial
    }

    /// Number of texels.
    pub fn len(&self) -> usize {
        self.len as usize
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}

impl Resolve {
    /// Prepares the pass.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        let layout = ComputeLayout::new(gpu, &BINDINGS)?;
        let spirv = include_bytes!(concat!(env!("OUT_DIR"), "/resolve.spv"));
        Ok(Self { pipeline: layout.pipeline(spirv, c"resolve")?, layout, gpu: Arc::clone(gpu) })
    }

    /// Prepares to resolve the rates of both eyes' tiles by `table`, whose pictures are within those tiles; all texels are 1x1 until then.
    ///
    /// # Errors
    /// A failed call, or [`GpuError::Unsupported`] for more texels than the device takes.
    pub fn target(
        &self,
        table: &RateMapTable,
        eyes: [&Arc<ViewTiles>; 2],
        available: [u8; 16],
        leaves_out: bool,
    ) -> Result<RateMapTexels, GpuError> {
        let gpu = &self.gpu;
        let params = table.params(eyes.map(|eye| eye.tiles()[0]), available, leaves_out);
        let [columns, rows] = params.texels;
        let len = [columns, rows, params.layers]
            .into_iter()
            .try_fold(1u32, |all, more| all.checked_mul(more))
            .ok_or(GpuError::Unsupported("a rate image of this size"))?;
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let params_buffer = DeviceBuffer::holding(gpu, storage, bytemuck::bytes_of(&params))?;
        // A buffer has at least one word.
        let words = if table.words().is_empty() { &[0] } else { table.words() };
        let table = DeviceBuffer::holding(gpu, storage, bytemuck::cast_slice(words))?;
        let usage = storage | vk::BufferUsageFlags::TRANSFER_SRC;
        let texels = DeviceBuffer::new(gpu, usage, u64::from(len).next_multiple_of(4).max(4), |_| {})?;
        let [left, right] = eyes.map(|eye| eye.rates());
        let bound = [params_buffer.handle(), table.handle(), left, right, texels.handle()];
        let set = ComputeSet::of_buffers(&self.layout, &bound)?;
        let eyes = eyes.map(Arc::clone);
        Ok(RateMapTexels {
            set,
            _params: params_buffer,
            _table: table,
            texels,
            _eyes: eyes,
            len,
            serial: serial(),
        })
    }

    /// Records that the texels of `target` are resolved from the rates at execution, ready for copies and for reads by compute shaders.
    pub fn record(&self, commands: &AppCommands, target: &RateMapTexels) {
        commands.memory_barrier(READS_OF_RESULTS, COMPUTES);
        let groups = target.len.div_ceil(4).div_ceil(THREADS);
        commands.dispatch(&self.layout, &self.pipeline, &target.set, [groups, 1]);
        commands.memory_barrier(COMPUTES, READS_OF_RESULTS);
    }
}
