//! `decide`: the rate of each tile of a view, ahead of the passes that draw it, by the newest gaze and sound and by the
//! contrast that [`super::analyze`] found in the last picture.

pub use parafovea_core::kernels::decide::DecideParams;

use super::analyze::{ViewTiles, rate_row_bytes};
use crate::gpu::{
    AppCommands, COMPUTES, ComputeLayout, ComputeSet, DeviceBuffer, Gpu, GpuError, Owned, READS_OF_RESULTS,
    Scope, serial,
};
use ash::vk;
use parafovea_core::perception::csf::Stimulus;
use parafovea_core::perception::csf::castle::FovealTable;
use std::ffi::CStr;
use std::sync::Arc;

/// Parameters, contrast, the table of sensitivities, memory of tiles, rates, left-out tiles.
const BINDINGS: [vk::DescriptorType; 6] = [vk::DescriptorType::STORAGE_BUFFER; 6];

/// Threads of a workgroup, each of which decides four tiles. The shader has the same number.
const THREADS: u32 = 64;

/// Entry points by [`DecideParams::sensitivity`]: for a view in which contrast was measured, and for one turned from it.
const ENTRIES: [[&CStr; 2]; 3] = [
    [c"decide_rings"; 2],
    [c"decide_castle", c"decide_castle_turned"],
    [c"decide_tursun", c"decide_tursun_turned"],
];

/// The pass.
pub struct Decide {
    /// As [`ENTRIES`].
    pipelines: Vec<[Owned<vk::Pipeline>; 2]>,
    layout: ComputeLayout,
    /// castleCSF at the gaze.
    foveal: DeviceBuffer,
    gpu: Arc<Gpu>,
}

/// The tiles of one view, and their memory from frame to frame.
pub struct DecideTarget {
    // In the order in which each may be destroyed.
    set: ComputeSet,
    params: DeviceBuffer,
    stale: DeviceBuffer,
    _memory: DeviceBuffer,
    tiles: Arc<ViewTiles>,
    serial: u64,
}

impl Decide {
    /// Prepares the pass.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        let layout = ComputeLayout::new(gpu, &BINDINGS)?;
        let spirv = include_bytes!(concat!(env!("OUT_DIR"), "/decide.spv"));
        let both = |[still, turned]: [&CStr; 2]| {
            Ok::<_, GpuError>([layout.pipeline(spirv, still)?, layout.pipeline(spirv, turned)?])
        };
        let pipelines = ENTRIES.map(both).into_iter().collect::<Result<_, _>>()?;
        let usual = Stimulus::default();
        let table = FovealTable::new(usual.temporal_hz, usual.area_deg2);
        let bytes = bytemuck::cast_slice(table.texels());
        let foveal = DeviceBuffer::holding(gpu, vk::BufferUsageFlags::STORAGE_BUFFER, bytes)?;
        Ok(Self { pipelines, layout, foveal, gpu: Arc::clone(gpu) })
    }

    /// Prepares to decide `tiles`, which all are at full rate until then.
    ///
    /// # Errors
    /// A failed call.
    pub fn target(&self, tiles: &Arc<ViewTiles>) -> Result<DecideTarget, GpuError> {
        let gpu = &self.gpu;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
        let params = DeviceBuffer::new(gpu, usage, size_of::<DecideParams>() as u64, |_| {})?;
        let [columns, rows] = tiles.tiles();
        let bytes = u64::from(rate_row_bytes(columns)) * u64::from(rows);
        // Coarseness, and time since the rate changed.
        let remembered = 2 * bytes.max(4);
        let memory = DeviceBuffer::new(gpu, vk::BufferUsageFlags::STORAGE_BUFFER, remembered, |_| {})?;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
        let stale = DeviceBuffer::new(gpu, usage, stale_words([columns, rows]) as u64 * 4, |_| {})?;
        let (contrast, rates) = (tiles.contrast(), tiles.rates());
        let bound = [params.handle(), contrast, self.foveal.handle(), memory.handle(), rates, stale.handle()];
        let set = ComputeSet::of_buffers(&self.layout, &bound)?;
        Ok(DecideTarget { set, params, stale, _memory: memory, tiles: Arc::clone(tiles), serial: serial() })
    }

    /// Records a write of the parameters of a decision on the tiles of `target` without its `stale` ones
    /// ([`parafovea_core::reuse::StaleTiles::words`]: no word, or all words), in order with earlier decisions; returns the variant of
    /// [`Self::record`] that decides by them.
    ///
    /// # Errors
    /// [`GpuError::Invalid`] where `params` or `stale` are of other tiles, or `params` of no kind; then nothing is recorded.
    pub fn write(
        &self,
        commands: &AppCommands,
        target: &DecideTarget,
        params: &DecideParams,
        stale: &[u32],
    ) -> Result<DecideVariant, GpuError> {
        let tiles = target.tiles.tiles();
        let has_stale = !stale.is_empty();
        if params.tiles != tiles || (has_stale && stale.len() != stale_words(tiles)) {
            return Err(GpuError::Invalid("parameters for other tiles"));
        }
        let sensitivity = params.sensitivity as usize;
        if sensitivity >= self.pipelines.len() {
            return Err(GpuError::Invalid("an unknown sensitivity"));
        }
        let params = DecideParams { has_stale: has_stale.into(), ..*params };
        commands.write_parameters(&target.params, bytemuck::bytes_of(&params));
        for (part, words) in (0u64..).zip(stale.chunks(UPDATE_WORDS)) {
            commands.update_words(target.stale.handle(), part * UPDATE_WORDS as u64 * 4, words);
        }
        commands.memory_barrier(UPDATES, COMPUTES);
        Ok(DecideVariant { sensitivity, is_turned: params.is_turned != 0 })
    }

    /// Records the decision by the written parameters. [`ViewTiles::rates`] hold it afterwards, ready to be copied or to be read by compute
    /// shaders.
    pub fn record(&self, commands: &AppCommands, target: &DecideTarget, variant: DecideVariant) {
        let [columns, rows] = target.tiles.tiles();
        let [still, turned] = &self.pipelines[variant.sensitivity];
        let pipeline = if variant.is_turned { turned } else { still };
        commands.memory_barrier(READS_OF_RESULTS, COMPUTES);
        let words = rate_row_bytes(columns) / 4 * rows;
        commands.dispatch(&self.layout, pipeline, &target.set, [words.div_ceil(THREADS), 1]);
        commands.memory_barrier(COMPUTES, READS_OF_RESULTS);
    }
}

/// The shader of a decision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DecideVariant {
    /// [`DecideParams::sensitivity`], in range.
    sensitivity: usize,
    is_turned: bool,
}

impl DecideVariant {
    /// A number that no other variant has.
    pub fn index(self) -> u64 {
        self.sensitivity as u64 * 2 + u64::from(self.is_turned)
    }
}

impl DecideTarget {
    /// A number that no other object has ([`crate::gpu::serial`]).
    pub fn serial(&self) -> u64 {
        self.serial
    }
}

/// Number of words with one bit for each tile: whether it is left out.
fn stale_words([columns, rows]: [u32; 2]) -> usize {
    (columns as usize * rows as usize).div_ceil(u32::BITS as usize)
}

/// Most words in one update of a buffer (vkCmdUpdateBuffer: 65,536 bytes).
const UPDATE_WORDS: usize = 16_384;

/// The write of left-out tiles.
const UPDATES: Scope =
    Scope { stages: vk::PipelineStageFlags::TRANSFER, access: vk::AccessFlags::TRANSFER_WRITE };
