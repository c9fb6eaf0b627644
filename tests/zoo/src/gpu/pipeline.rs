//! Graphics pipelines.

use super::{Gpu, HeapBinding, Made, Target, heaps};
use anyhow::Result;
use ash::vk;
use std::ffi::CStr;

/// An entry point of a shader.
#[derive(Clone, Copy)]
pub struct Shader {
    /// The bytes of its SPIR-V module.
    pub module: &'static [u8],
    pub entry: &'static CStr,
}

/// A shader of `shaders/`: `shader!("forward", "sky_fs")`.
#[macro_export]
#[doc(hidden)]
macro_rules! shader {
    ($module:literal, $entry:literal) => {
        $crate::gpu::Shader {
            module: include_bytes!(concat!(env!("OUT_DIR"), "/", $module, ".spv")),
            entry: match std::ffi::CStr::from_bytes_with_nul(concat!($entry, "\0").as_bytes()) {
                Ok(entry) => entry,
                Err(_) => panic!("an entry point with a zero in its name"),
            },
        }
    };
}

/// Depth test and depth write of a pipeline.
#[derive(Clone, Copy)]
pub struct Depth {
    pub test: Option<vk::CompareOp>,
    pub write: bool,
}

impl Depth {
    pub const NONE: Self = Self { test: None, write: false };
    pub const LESS: Self = Self { test: Some(vk::CompareOp::LESS), write: true };
    /// For the last draws, at the far plane.
    pub const LAST: Self = Self { test: Some(vk::CompareOp::LESS_OR_EQUAL), write: false };
}

/// Method of creating a pipeline.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Making {
    /// All at once.
    Whole,
    /// From libraries (VK_EXT_graphics_pipeline_library).
    Libraries,
    /// All at once, its flags in VkPipelineCreateFlags2CreateInfoKHR.
    Flags2,
    /// All at once, without a layout, its descriptors in a heap.
    Heap(HeapBinding),
}

/// Description of a pipeline.
#[derive(Clone)]
pub struct PipelineSpec {
    pub vertex: Shader,
    /// None: depth alone.
    pub fragment: Option<Shader>,
    pub depth: Depth,
    /// Whether colour is written.
    pub color: bool,
    pub blend: Option<vk::PipelineColorBlendAttachmentState>,
    pub alpha_to_coverage: bool,
    /// Whether the fragment shader discards.
    pub discards: bool,
    /// Viewports, of which all are dynamic.
    pub viewports: u32,
    /// Two floats for each vertex, from binding 0.
    pub vertices: bool,
    /// The pipeline's own shading rate; None: no such state.
    pub rate: Option<[u32; 2]>,
    /// Whether the rate attachment's rates hold instead of that.
    pub obeys_rates: bool,
    pub flags: vk::PipelineCreateFlags,
    pub making: Making,
}

impl PipelineSpec {
    pub const fn new(vertex: Shader, fragment: Shader, depth: Depth) -> Self {
        Self {
            vertex,
            fragment: Some(fragment),
            depth,
            color: true,
            blend: None,
            alpha_to_coverage: false,
            discards: false,
            viewports: 1,
            vertices: false,
            rate: None,
            obeys_rates: false,
            flags: vk::PipelineCreateFlags::empty(),
            making: Making::Whole,
        }
    }
}

impl PipelineSpec {
    /// The state of the pipeline's own shading rate.
    fn rate_state(&self) -> Option<vk::PipelineFragmentShadingRateStateCreateInfoKHR<'static>> {
        let [width, height] = self.rate?;
        // The pipeline's own rate, and behind it the attachment's.
        let keep = vk::FragmentShadingRateCombinerOpKHR::KEEP;
        let second = if self.obeys_rates { vk::FragmentShadingRateCombinerOpKHR::REPLACE } else { keep };
        let state = vk::PipelineFragmentShadingRateStateCreateInfoKHR::default();
        Some(state.fragment_size(vk::Extent2D { width, height }).combiner_ops([keep, second]))
    }
}

impl Gpu {
    /// Makes a graphics pipeline for the passes of `target`, and keeps it.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn pipeline(
        &self,
        spec: &PipelineSpec,
        layout: vk::PipelineLayout,
        target: &Target,
    ) -> Result<vk::Pipeline> {
        let shaders = [
            (vk::ShaderStageFlags::VERTEX, Some(spec.vertex)),
            (vk::ShaderStageFlags::FRAGMENT, spec.fragment),
        ];
        let mut stages = Vec::new();
        for (stage, shader) in shaders {
            if let Some(shader) = shader {
                let module = self.module(shader.module)?;
                let info = vk::PipelineShaderStageCreateInfo::default();
                stages.push(info.stage(stage).module(module).name(shader.entry));
            }
        }
        let spec = &self.with_rates(spec, target);
        let state = State::new(spec, target);
        let made = |stages: &[vk::PipelineShaderStageCreateInfo]| {
            self.of_stages(spec, &state, stages, layout, target)
        };
        let pipeline = match spec.making {
            Making::Heap(binding) => binding.chained(|mapping| {
                stages.iter_mut().for_each(|stage| stage.p_next = mapping);
                made(&stages)
            }),
            _ => made(&stages),
        }?;
        self.keep(Made::Pipeline(pipeline));
        Ok(pipeline)
    }

    fn of_stages(
        &self,
        spec: &PipelineSpec,
        state: &State,
        stages: &[vk::PipelineShaderStageCreateInfo],
        layout: vk::PipelineLayout,
        target: &Target,
    ) -> Result<vk::Pipeline> {
        state.with(spec, target, stages, |info| match spec.making {
            Making::Whole => self.create(info.layout(layout)),
            Making::Libraries => self.linked(info, stages, layout, (target.view_mask, spec.rate_state())),
            Making::Heap(_) => {
                let mut flags = vk::PipelineCreateFlags2CreateInfoKHR::default()
                    .flags(vk::PipelineCreateFlags2KHR::from_raw(heaps::PIPELINE_FLAG));
                self.create(info.push_next(&mut flags))
            }
            Making::Flags2 => {
                let bits = u64::from(spec.flags.as_raw());
                let mut flags = vk::PipelineCreateFlags2CreateInfoKHR::default()
                    .flags(vk::PipelineCreateFlags2KHR::from_raw(bits));
                self.create(info.layout(layout).push_next(&mut flags))
            }
        })
    }

    /// Makes a compute pipeline, and keeps it.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn compute_pipeline(&self, shader: Shader, layout: vk::PipelineLayout) -> Result<vk::Pipeline> {
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(self.module(shader.module)?)
            .name(shader.entry);
        let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout);
        // SAFETY: module and layout are live.
        let made = unsafe { self.device.create_compute_pipelines(vk::PipelineCache::null(), &[info], None) };
        let pipeline = made.map_err(|(_, result)| result)?[0];
        self.keep(Made::Pipeline(pipeline));
        Ok(pipeline)
    }

    fn module(&self, bytes: &[u8]) -> Result<vk::ShaderModule> {
        let words = ash::util::read_spv(&mut std::io::Cursor::new(bytes))?;
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the words are a SPIR-V module.
        let module = unsafe { self.device.create_shader_module(&info, None) }?;
        self.keep(Made::Module(module));
        Ok(module)
    }

    pub(super) fn create(&self, info: vk::GraphicsPipelineCreateInfo) -> Result<vk::Pipeline> {
        // SAFETY: all that the structures name is live and outlives the call.
        let made = unsafe { self.device.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None) };
        Ok(made.map_err(|(_, result)| result)?[0])
    }
}

/// The state that a pipeline's description points to.
struct State {
    bindings: Vec<vk::VertexInputBindingDescription>,
    attributes: Vec<vk::VertexInputAttributeDescription>,
    blends: Vec<vk::PipelineColorBlendAttachmentState>,
    dynamic: Vec<vk::DynamicState>,
}

impl State {
    fn new(spec: &PipelineSpec, target: &Target) -> Self {
        let (mut bindings, mut attributes) = (Vec::new(), Vec::new());
        if spec.vertices {
            bindings.push(vk::VertexInputBindingDescription::default().stride(8));
            let format = vk::Format::R32G32_SFLOAT;
            attributes.push(vk::VertexInputAttributeDescription::default().format(format));
        }
        let mask = if spec.color { vk::ColorComponentFlags::RGBA } else { vk::ColorComponentFlags::empty() };
        let blend = spec.blend.unwrap_or_default().color_write_mask(mask);
        Self {
            bindings,
            attributes,
            blends: vec![blend; target.colors.len()],
            dynamic: vec![vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR],
        }
    }

    fn with<R>(
        &self,
        spec: &PipelineSpec,
        target: &Target,
        stages: &[vk::PipelineShaderStageCreateInfo],
        call: impl FnOnce(vk::GraphicsPipelineCreateInfo) -> R,
    ) -> R {
        let input = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(&self.bindings)
            .vertex_attribute_descriptions(&self.attributes);
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
            .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default()
            .viewport_count(spec.viewports)
            .scissor_count(spec.viewports);
        let rasterization = vk::PipelineRasterizationStateCreateInfo::default()
            .polygon_mode(vk::PolygonMode::FILL)
            .cull_mode(vk::CullModeFlags::NONE)
            .line_width(1.0);
        let multisample = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(vk::SampleCountFlags::from_raw(target.samples))
            .alpha_to_coverage_enable(spec.alpha_to_coverage);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(spec.depth.test.is_some())
            .depth_compare_op(spec.depth.test.unwrap_or(vk::CompareOp::ALWAYS))
            .depth_write_enable(spec.depth.write);
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&self.blends);
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&self.dynamic);
        let mut rendering = vk::PipelineRenderingCreateInfo::default()
            .view_mask(target.view_mask)
            .color_attachment_formats(&target.colors)
            .depth_attachment_format(target.depth);
        let mut rate = spec.rate_state();
        let mut info = vk::GraphicsPipelineCreateInfo::default()
            .flags(spec.flags)
            .stages(stages)
            .vertex_input_state(&input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&rasterization)
            .multisample_state(&multisample)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .render_pass(target.render_pass)
            .subpass(target.subpass);
        if target.render_pass == vk::RenderPass::null() {
            info = info.push_next(&mut rendering);
        }
        if let Some(rate) = &mut rate {
            info = info.push_next(rate);
        }
        call(info)
    }
}
