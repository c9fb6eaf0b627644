//! The pipeline to draw with, in one piece or linked from libraries.

use super::objects::{COLOUR, view_mask};
use super::setup::{SIZE, Setup, extent};
use crate::programs::triangle::SHADERS;
use ash::vk;
use vk::FragmentShadingRateCombinerOpKHR as Combiner;

pub struct Pipelines {
    pub layout: vk::PipelineLayout,
    /// The one to draw with first, libraries behind it.
    pub all: Vec<vk::Pipeline>,
}

fn fragment_size(setup: &Setup) -> vk::Extent2D {
    extent(match setup.plan.broken.as_str() {
        "no width" => [0, 1],
        "no height" => [1, 0],
        "width odd" => [3, 1],
        "height odd" => [1, 3],
        "too wide" => [8, 1],
        "too high" => [1, 8],
        "size" => [2, 2],
        _ => [1, 1],
    })
}

fn combiners(setup: &Setup) -> [Combiner; 2] {
    match setup.plan.broken.as_str() {
        "first combiner" => [Combiner::REPLACE, Combiner::KEEP],
        "trivial combiner" => [Combiner::KEEP, Combiner::MAX],
        "first combiner invalid" => [Combiner::from_raw(9), Combiner::REPLACE],
        "second combiner invalid" => [Combiner::KEEP, Combiner::from_raw(9)],
        _ if setup.plan.is("without_attachment") && !setup.plan.breaks("second combiner") => {
            [Combiner::KEEP; 2]
        }
        _ => [Combiner::KEEP, Combiner::REPLACE],
    }
}

/// The rate that the pipeline has, or the command sets.
pub fn rate(setup: &Setup) -> (vk::Extent2D, [Combiner; 2]) {
    (fragment_size(setup), combiners(setup))
}

/// A pipeline for the render pass, or for dynamic rendering where the form is that.
pub fn pipelines(setup: &Setup, render_pass: vk::RenderPass) -> Pipelines {
    let plan = &setup.plan;
    let vk = &setup.vk;
    let [width, height] = SIZE;
    let module = naga::front::wgsl::parse_str(SHADERS).unwrap();
    let valid =
        naga::valid::Validator::new(Default::default(), Default::default()).validate(&module).unwrap();
    let code = naga::back::spv::write_vec(&module, &valid, &Default::default(), None).unwrap();
    let viewport =
        [vk::Viewport { width: width as f32, height: height as f32, max_depth: 1.0, ..Default::default() }];
    let scissor = [vk::Rect2D::default().extent(extent(SIZE))];
    let blend =
        [vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA)];
    let formats = [COLOUR];
    // SAFETY: plain use of Vulkan.
    unsafe {
        let layout = vk.create_pipeline_layout(&Default::default(), None).unwrap();
        let shader = vk::ShaderModuleCreateInfo::default().code(&code);
        let shader = vk.create_shader_module(&shader, None).unwrap();
        let stage =
            |stage, name| vk::PipelineShaderStageCreateInfo::default().stage(stage).module(shader).name(name);
        let stages = [
            stage(vk::ShaderStageFlags::VERTEX, c"vertex"),
            stage(vk::ShaderStageFlags::FRAGMENT, c"fragment"),
        ];
        let vertices = vk::PipelineVertexInputStateCreateInfo::default();
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
            .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewports(&viewport).scissors(&scissor);
        let rasterization = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
        let samples = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blend);
        let dynamic = [vk::DynamicState::LINE_WIDTH, vk::DynamicState::FRAGMENT_SHADING_RATE_KHR];
        let set_by_command = plan.is("dynamic_state") || plan.breaks("dynamic state");
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(if set_by_command {
            &dynamic
        } else {
            &dynamic[..1]
        });
        let base = vk::GraphicsPipelineCreateInfo::default()
            .vertex_input_state(&vertices)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&rasterization)
            .multisample_state(&samples)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(layout);
        let in_render_pass = plan.is("framebuffer");
        let flag = vk::PipelineCreateFlags::RENDERING_FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
        let flags = if in_render_pass && !plan.breaks("flag") || plan.breaks("no flag") || plan.is("flags2") {
            vk::PipelineCreateFlags::empty()
        } else {
            flag
        };
        let (fragment_size, combiners) = rate(setup);
        let make = |flags: vk::PipelineCreateFlags,
                    parts: vk::GraphicsPipelineLibraryFlagsEXT,
                    from: &[_]| {
            let library = !parts.is_empty();
            let pre =
                !library || parts.contains(vk::GraphicsPipelineLibraryFlagsEXT::PRE_RASTERIZATION_SHADERS);
            let last = !library || parts.contains(vk::GraphicsPipelineLibraryFlagsEXT::FRAGMENT_SHADER);
            let (has_libraries, linked) = (!from.is_empty(), !from.is_empty() && !library);
            let size =
                if plan.breaks("library rate") && library && pre { extent([2, 2]) } else { fragment_size };
            let mut state = vk::PipelineFragmentShadingRateStateCreateInfoKHR::default()
                .fragment_size(size)
                .combiner_ops(combiners);
            let mut rendering = vk::PipelineRenderingCreateInfo::default()
                .view_mask(view_mask(setup))
                .color_attachment_formats(if last { &formats } else { &[] });
            let mut parts = vk::GraphicsPipelineLibraryCreateInfoEXT::default().flags(parts);
            let mut from = vk::PipelineLibraryCreateInfoKHR::default().libraries(from);
            let mut wide = vk::PipelineCreateFlags2CreateInfoKHR::default()
                .flags(vk::PipelineCreateFlags2KHR::RENDERING_FRAGMENT_SHADING_RATE_ATTACHMENT);
            let mut info =
                if linked { vk::GraphicsPipelineCreateInfo::default().layout(layout) } else { base };
            let flags_of_library =
                if library { vk::PipelineCreateFlags::LIBRARY_KHR } else { vk::PipelineCreateFlags::empty() };
            info = info.flags(flags | flags_of_library);
            if !linked {
                info = info.stages(match (pre, last) {
                    (true, true) => &stages,
                    (true, false) => &stages[..1],
                    _ => &stages[1..],
                });
            }
            if in_render_pass {
                info = info.render_pass(render_pass);
            } else if !linked {
                info = info.push_next(&mut rendering);
            }
            if !linked && (!plan.is("without_extension") || plan.breaks("pipeline state")) {
                info = info.push_next(&mut state);
            }
            if library {
                info = info.push_next(&mut parts);
            }
            if has_libraries {
                info = info.push_next(&mut from);
            }
            if plan.is("flags2") {
                info = info.push_next(&mut wide);
            }
            vk.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None).unwrap()[0]
        };
        type Parts = vk::GraphicsPipelineLibraryFlagsEXT;
        let all = if plan.is("libraries") {
            let first = make(
                plan.unless("library flag", flags, vk::PipelineCreateFlags::empty()),
                Parts::VERTEX_INPUT_INTERFACE | Parts::PRE_RASTERIZATION_SHADERS,
                &[],
            );
            let of_first = [first];
            let chained = plan.is("chained");
            let fragment = Parts::FRAGMENT_SHADER | Parts::FRAGMENT_OUTPUT_INTERFACE;
            let second = make(flags, fragment, if chained { &of_first } else { &[] });
            let all = if chained { vec![second] } else { vec![first, second] };
            vec![make(flags, Parts::empty(), &all), first, second]
        } else {
            vec![make(flags, Parts::empty(), &[])]
        };
        vk.destroy_shader_module(shader, None);
        Pipelines { layout, all }
    }
}
