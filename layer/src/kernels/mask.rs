//! `mask`: the blocks that a pass of the application skips, from the texels that [`super::resolve`] wrote.

pub use parafovea_core::kernels::mask::MaskParams;

use super::resolve::RateMapTexels;
use crate::gpu::{
    AppCommands, COMPUTES, ComputeLayout, ComputeSet, DeviceBuffer, Gpu, GpuError, Owned, Scope,
};
use ash::vk;
use parafovea_core::kernels::mask::view_words;
use parafovea_core::mask::{DepthFormat, MaskView, TemplateDepths};
use std::sync::Arc;

/// Parameters, views, texels, list, template, which blocks are shaded.
const BINDINGS: [vk::DescriptorType; 6] = [vk::DescriptorType::STORAGE_BUFFER; 6];

/// Side of the blocks that one workgroup decides, and threads of one that writes bits. The shader has the same numbers.
const GROUP_SIDE: u32 = 8;
const THREADS: u32 = 64;

/// The buffers of a mask that the kernel writes.
pub trait MaskOutput: Send + Sync {
    /// The list of skipped blocks.
    fn list(&self) -> vk::Buffer;

    /// The template; `None` where compute shaders cannot write it.
    fn template(&self) -> Option<vk::Buffer>;

    /// The format of the template, and its depths.
    fn kind(&self) -> (DepthFormat, TemplateDepths);

    /// Size of the masked target, pixels.
    fn extent(&self) -> [u32; 2];

    /// Array layers of the masked target.
    fn layers(&self) -> u32;

    /// Records the draw of a template that is an image, from its buffer.
    fn redraw(&self, commands: &AppCommands);
}

/// The pass.
pub struct MaskPass {
    shaded: Owned<vk::Pipeline>,
    blocks: Owned<vk::Pipeline>,
    seal: Owned<vk::Pipeline>,
    sources: Owned<vk::Pipeline>,
    layout: ComputeLayout,
    gpu: Arc<Gpu>,
}

/// The mask of one target.
pub struct MaskTarget {
    // In the order in which each may be destroyed.
    set: ComputeSet,
    _params: DeviceBuffer,
    _views: DeviceBuffer,
    _bits: DeviceBuffer,
    _texels: Arc<RateMapTexels>,
    map: Arc<dyn MaskOutput>,
    /// The template of `map`, and its words where blocks are shaded.
    template: vk::Buffer,
    shaded: u32,
    groups: [u32; 2],
    bit_groups: u32,
}

impl MaskPass {
    /// Prepares the pass.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        let layout = ComputeLayout::new(gpu, &BINDINGS)?;
        let spirv = include_bytes!(concat!(env!("OUT_DIR"), "/mask.spv"));
        let [shaded, blocks, seal, sources] =
            [c"shaded", c"blocks", c"seal", c"sources"].map(|entry| layout.pipeline(spirv, entry));
        let gpu = Arc::clone(gpu);
        Ok(Self { shaded: shaded?, blocks: blocks?, seal: seal?, sources: sources?, layout, gpu })
    }

    /// Prepares to write `map` from `texels`, which are of `tiles` columns and rows of tiles of `texel` pixels in `rate_layers` layers, or in one
    /// that serves all. Where two of `views`, each in an array layer, overlap, the first one counts.
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] for a mask that the kernel cannot generate; a failed call.
    pub fn target(
        &self,
        map: Arc<dyn MaskOutput>,
        texels: &Arc<RateMapTexels>,
        (texel, tiles, rate_layers): ([u32; 2], [u32; 2], u32),
        views: &[MaskView],
    ) -> Result<MaskTarget, GpuError> {
        let gpu = &self.gpu;
        let unsupported = GpuError::Unsupported("a mask of this kind that is generated on the GPU");
        let template = map.template().ok_or(unsupported)?;
        let kind = map.kind();
        let extent = map.extent();
        let rows = views.len() as u32;
        let params = MaskParams::new(extent, map.layers(), kind, (texel, tiles), rows).ok_or(unsupported)?;
        let rate_layer = |view: &MaskView| if rate_layers == 1 { 0 } else { view.layer };
        let words: Vec<u32> =
            views.iter().flat_map(|view| view_words(view, rate_layer(view), extent)).collect();
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let params_buffer = DeviceBuffer::holding(gpu, storage, bytemuck::bytes_of(&params))?;
        let table = DeviceBuffer::holding(gpu, storage, bytemuck::cast_slice(&words))?;
        let bits = DeviceBuffer::without_content(gpu, storage, u64::from(params.bit_words()) * 4)?;
        let bound =
            [params_buffer.handle(), table.handle(), texels.texels(), map.list(), template, bits.handle()];
        let set = ComputeSet::of_buffers(&self.layout, &bound)?;
        Ok(MaskTarget {
            set,
            _params: params_buffer,
            _views: table,
            _bits: bits,
            _texels: Arc::clone(texels),
            map,
            template,
            shaded: params.shaded,
            groups: params.blocks.map(|count| count.div_ceil(GROUP_SIDE).max(1)),
            bit_groups: params.bit_words().div_ceil(THREADS),
        })
    }

    /// Records a write of the mask of `target` from its texels at execution, in order with earlier and later passes on this queue.
    pub fn record(&self, commands: &AppCommands, target: &MaskTarget) {
        commands.reads_to_copies();
        // Nothing is listed yet, and everything is shaded.
        commands.update_words(target.map.list(), 0, &[0; 4]);
        commands.fill_words(target.template, target.shaded);
        commands.memory_barrier(WRITTEN_BEFORE, COMPUTES);
        commands.dispatch(&self.layout, &self.shaded, &target.set, [target.bit_groups, 1]);
        commands.dispatch(&self.layout, &self.blocks, &target.set, target.groups);
        commands.computed_to_computed();
        commands.dispatch(&self.layout, &self.seal, &target.set, [1, 1]);
        commands.computed_to_computed();
        commands.computes_to_reads();
        commands.dispatch_indirect(&self.layout, &self.sources, &target.set, (target.map.list(), 0));
        commands.computes_to_reads();
        target.map.redraw(commands);
    }
}

/// The accesses before the kernel's writes: the emptied list and template, and copies of earlier content.
const WRITTEN_BEFORE: Scope = Scope {
    stages: vk::PipelineStageFlags::TRANSFER,
    access: vk::AccessFlags::from_raw(
        vk::AccessFlags::TRANSFER_READ.as_raw() | vk::AccessFlags::TRANSFER_WRITE.as_raw(),
    ),
};
