//! Pipelines linked from libraries (VK_EXT_graphics_pipeline_library).

use super::{Gpu, Made};
use anyhow::Result;
use ash::vk;

type Part = vk::GraphicsPipelineLibraryFlagsEXT;

impl Gpu {
    /// Makes the parts of the pipeline `whole` as libraries, which are kept, and links them; structures of its chain for the parts ahead of
    /// fragments come apart.
    ///
    /// # Errors
    /// Errors of the calls.
    pub(super) fn linked(
        &self,
        whole: vk::GraphicsPipelineCreateInfo,
        stages: &[vk::PipelineShaderStageCreateInfo],
        layout: vk::PipelineLayout,
        (view_mask, rate): (u32, Option<vk::PipelineFragmentShadingRateStateCreateInfoKHR<'static>>),
    ) -> Result<vk::Pipeline> {
        let (vertex, fragment) = stages.split_at(1);
        let parts = [
            (Part::VERTEX_INPUT_INTERFACE, &[][..]),
            (Part::PRE_RASTERIZATION_SHADERS, vertex),
            // In two libraries older validation misses, in each, the other one's state.
            (Part::FRAGMENT_SHADER | Part::FRAGMENT_OUTPUT_INTERFACE, fragment),
        ];
        let mut libraries = Vec::new();
        for (part, stages) in parts {
            let with_fragments = part.contains(Part::FRAGMENT_OUTPUT_INTERFACE);
            let mut part = vk::GraphicsPipelineLibraryCreateInfoEXT::default().flags(part);
            let mut rendering = vk::PipelineRenderingCreateInfo::default().view_mask(view_mask);
            let mut rate = rate.filter(|_| part.flags.contains(Part::PRE_RASTERIZATION_SHADERS));
            let mut info = whole;
            if !with_fragments {
                // Formats are for the output alone.
                info.p_next = std::ptr::null();
                info = info.push_next(&mut rendering);
                if let Some(rate) = &mut rate {
                    info = info.push_next(rate);
                }
            }
            let library = self.create(
                info.flags(whole.flags | vk::PipelineCreateFlags::LIBRARY_KHR)
                    .stages(stages)
                    .layout(layout)
                    .push_next(&mut part),
            )?;
            self.keep(Made::Pipeline(library));
            libraries.push(library);
        }
        let mut linked = vk::PipelineLibraryCreateInfoKHR::default().libraries(&libraries);
        let info = vk::GraphicsPipelineCreateInfo::default().flags(whole.flags).layout(layout);
        self.create(info.push_next(&mut linked))
    }
}
