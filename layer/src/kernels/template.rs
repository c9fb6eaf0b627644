//! `template`: a depth template as an image of several samples, from which it is copied to the application's depth.

use crate::gpu::{
    AppCommands, ComputeLayout, ComputeSet, DepthTarget, DepthTargetDescription, DeviceBuffer, Gpu, GpuError,
    ImagePart,
};
use ash::vk;
use parafovea_core::kernels::template::TemplateParams;
use parafovea_core::mask::TemplateDepths;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Parameters, template.
const BINDINGS: [vk::DescriptorType; 2] = [vk::DescriptorType::STORAGE_BUFFER; 2];

/// A template in an image, drawn from the buffer that holds it.
pub struct TemplateImage {
    // In the order in which each may be destroyed.
    set: ComputeSet,
    _params: DeviceBuffer,
    target: DepthTarget,
    layout: ComputeLayout,
    is_drawn: AtomicBool,
}

impl TemplateImage {
    /// Prepares to draw the template in the storage buffer `words`, which outlives the result, to an image of this format and these
    /// samples. `params` describes the template.
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] if there is no such image; a failed call.
    pub fn new(
        gpu: &Arc<Gpu>,
        (format, samples): (vk::Format, vk::SampleCountFlags),
        (extent, layers): ([u32; 2], u32),
        (params, depths): (TemplateParams, TemplateDepths),
        words: vk::Buffer,
    ) -> Result<Self, GpuError> {
        let layout = ComputeLayout::for_stage(gpu, &BINDINGS, vk::ShaderStageFlags::FRAGMENT)?;
        let [width, height] = extent;
        let description = DepthTargetDescription {
            format,
            samples,
            extent: vk::Extent2D { width, height },
            layers,
            cleared: depths.shaded,
            drawn: depths.skipped,
        };
        let spirv = include_bytes!(concat!(env!("OUT_DIR"), "/template.spv"));
        let target = DepthTarget::new(gpu, &layout, spirv, [c"corner", c"skipped"], &description)?;
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let params = DeviceBuffer::holding(gpu, storage, bytemuck::bytes_of(&params))?;
        let set = ComputeSet::of_buffers(&layout, &[params.handle(), words])?;
        Ok(Self { set, _params: params, target, layout, is_drawn: AtomicBool::new(false) })
    }

    /// Whether it was drawn: before, it must not be read.
    pub fn is_drawn(&self) -> bool {
        self.is_drawn.load(Ordering::Acquire)
    }

    /// Records a draw of the template's content at execution, in order with earlier and later copies from it on this queue.
    pub fn record(&self, commands: &AppCommands) {
        commands.draw_depth(&self.target, &self.layout, &self.set);
        self.is_drawn.store(true, Ordering::Release);
    }

    /// The image, in TRANSFER_SRC_OPTIMAL, once it was drawn.
    pub fn part(&self) -> ImagePart {
        self.target.part()
    }
}
