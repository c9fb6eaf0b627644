//! `lay`: the rates that [`super::decide`] found, laid over what a pass of the application draws.

pub use parafovea_core::kernels::lay::{LayParams, LayTable};

use super::analyze::ViewTiles;
use crate::gpu::{
    AppCommands, Bound, COMPUTES, ComputeLayout, ComputeSet, DeviceBuffer, Gpu, GpuError, Owned, Scope,
};
use ash::vk;
use std::sync::Arc;

/// Parameters, table, rates of the left and of the right eye, texels.
const BINDINGS: [vk::DescriptorType; 5] = [
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
];

/// Threads of a workgroup, each of which lays four texels. The shader has the same number.
const THREADS: u32 = 64;

/// The pass.
pub struct Lay {
    pipeline: Owned<vk::Pipeline>,
    layout: ComputeLayout,
    gpu: Arc<Gpu>,
}

/// The texels of one rate image.
pub struct LayTarget {
    // In the order in which each may be destroyed.
    set: ComputeSet,
    _params: DeviceBuffer,
    _table: DeviceBuffer,
    texels: DeviceBuffer,
    _eyes: [Arc<ViewTiles>; 2],
    len: u32,
}

impl LayTarget {
    /// The texels, a byte each, row by row, layer by layer, valid as long as `self`. Copies and compute shaders may read them.
    pub fn texels(&self) -> vk::Buffer {
        self.texels.handle()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.len as usize
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}

impl Lay {
    /// Prepares the pass.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        let layout = ComputeLayout::new(gpu, &BINDINGS)?;
        let spirv = include_bytes!(concat!(env!("OUT_DIR"), "/lay.spv"));
        Ok(Self { pipeline: layout.pipeline(spirv, c"lay")?, layout, gpu: Arc::clone(gpu) })
    }

    /// Prepares to lay the rates of both eyes' tiles by `table`, whose pictures are within those tiles; all texels are 1x1 until then.
    ///
    /// # Errors
    /// A failed call, or [`GpuError::Unsupported`] for more texels than the device takes.
    pub fn target(
        &self,
        table: &LayTable,
        eyes: [&Arc<ViewTiles>; 2],
        available: [u8; 16],
        leaves_out: bool,
    ) -> Result<LayTarget, GpuError> {
        let gpu = &self.gpu;
        let params = table.params(eyes.map(|eye| eye.tiles()[0]), available, leaves_out);
        let [columns, rows] = params.texels;
        let len = [columns, rows, params.layers]
            .into_iter()
            .try_fold(1u32, |all, more| all.checked_mul(more))
            .ok_or(GpuError::Unsupported("a rate image of this size"))?;
        let filled = |usage, bytes: &[u8]| {
            DeviceBuffer::new(gpu, usage, bytes.len() as u64, |content| content.copy_from_slice(bytes))
        };
        let params_buffer = filled(vk::BufferUsageFlags::STORAGE_BUFFER, bytemuck::bytes_of(&params))?;
        // A buffer has at least one word.
        let words = if table.words().is_empty() { &[0] } else { table.words() };
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let table = filled(storage, bytemuck::cast_slice(words))?;
        let usage = storage | vk::BufferUsageFlags::TRANSFER_SRC;
        let texels = DeviceBuffer::new(gpu, usage, u64::from(len).next_multiple_of(4).max(4), |_| {})?;
        let bound = [
            (0, Bound::Buffer(params_buffer.handle())),
            (1, Bound::Buffer(table.handle())),
            (2, Bound::Buffer(eyes[0].rates())),
            (3, Bound::Buffer(eyes[1].rates())),
            (4, Bound::Buffer(texels.handle())),
        ];
        let set = ComputeSet::new(&self.layout, &bound)?;
        let eyes = eyes.map(Arc::clone);
        Ok(LayTarget { set, _params: params_buffer, _table: table, texels, _eyes: eyes, len })
    }

    /// Records that the texels of `target` are laid from the rates as they are by then, ready to be copied or to be read by
    /// compute shaders.
    pub fn record(&self, commands: &AppCommands, target: &LayTarget) {
        commands.memory_barrier(TEXELS_READ, COMPUTES);
        let groups = target.len.div_ceil(4).div_ceil(THREADS);
        commands.dispatch(&self.layout, &self.pipeline, &target.set, [groups, 1]);
        commands.memory_barrier(COMPUTES, TEXELS_READ);
    }
}

/// Who uses the texels: copies to a rate image, and what makes a mask of them.
const TEXELS_READ: Scope = Scope {
    stages: vk::PipelineStageFlags::from_raw(
        vk::PipelineStageFlags::COMPUTE_SHADER.as_raw() | vk::PipelineStageFlags::TRANSFER.as_raw(),
    ),
    access: vk::AccessFlags::from_raw(
        vk::AccessFlags::SHADER_READ.as_raw()
            | vk::AccessFlags::SHADER_WRITE.as_raw()
            | vk::AccessFlags::TRANSFER_READ.as_raw(),
    ),
};
