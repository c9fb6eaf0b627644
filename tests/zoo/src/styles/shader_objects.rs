//! Shaders without pipelines (VK_EXT_shader_object): all state is dynamic.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, Gpu, ImageSpec, Kind, PassSpec, Shader};
use crate::scene::{BOXES, Draw, FORWARD, STAGES, Scene, VERTICES};
use crate::style::Style;
use crate::support::{Feature, Needs};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "shader-objects",
    says: "shader objects instead of pipelines, in dynamic rendering",
    needs: Needs {
        extensions: &[c"VK_EXT_shader_object"],
        features: &[Feature::DynamicRendering, Feature::ShaderObject],
        ..Needs::DYNAMIC
    },
    headers: 246,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start,
    ..Style::PLAIN
};

/// The shaders of a draw. Destroyed by themselves: the function for it is the extension's.
struct Shaders<'a> {
    gpu: &'a Gpu,
    api: ash::ext::shader_object::Device,
    boxes: [vk::ShaderEXT; 2],
    sky: [vk::ShaderEXT; 2],
}

impl Drop for Shaders<'_> {
    fn drop(&mut self) {
        // SAFETY: no other thread uses the queue; where waiting fails the device is lost. The shaders are live.
        unsafe {
            let _ = self.gpu.device_wait_idle();
            let shaders = self.boxes.iter().chain(&self.sky);
            shaders.for_each(|shader| self.api.destroy_shader(*shader, None));
        }
    }
}

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let eyes =
        app.eye_passes(Kind::Dynamic, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let api = ash::ext::shader_object::Device::new(&gpu.instance, gpu);
    let (boxes, sky) = (create(&api, &app.scene, FORWARD.boxes)?, create(&api, &app.scene, FORWARD.sky)?);
    let shaders = Shaders { gpu, api, boxes, sky };
    Ok(Box::new(move |frame| {
        let commands = frame.commands;
        for eye in EYES {
            let pass = &eyes[eye][frame.color[eye]];
            pass.begin(gpu, commands);
            app.scene.bind(gpu, commands, app.scene.set, frame.slot);
            app.scene.push(gpu, commands, &Draw { view: eye as u32, far: 1.0, ..Draw::default() });
            shaders.set_state(commands, app.size);
            shaders.draw(commands, shaders.boxes, Depth::LESS, [VERTICES, BOXES]);
            shaders.draw(commands, shaders.sky, Depth::LAST, [3, 1]);
            pass.end(gpu, commands);
        }
        Ok(())
    }))
}

fn create(
    api: &ash::ext::shader_object::Device,
    scene: &Scene,
    [vertex, fragment]: [Shader; 2],
) -> Result<[vk::ShaderEXT; 2]> {
    let sets = [scene.set_layout];
    let ranges = [vk::PushConstantRange { stage_flags: STAGES, offset: 0, size: size_of::<Draw>() as u32 }];
    let info = |shader: &Shader, stage, next| {
        vk::ShaderCreateInfoEXT::default()
            .stage(stage)
            .next_stage(next)
            .code_type(vk::ShaderCodeTypeEXT::SPIRV)
            .code(shader.module)
            .name(shader.entry)
            .set_layouts(&sets)
            .push_constant_ranges(&ranges)
    };
    let (first, last) = (vk::ShaderStageFlags::VERTEX, vk::ShaderStageFlags::FRAGMENT);
    let infos = [info(&vertex, first, last), info(&fragment, last, vk::ShaderStageFlags::empty())];
    // SAFETY: the structures and the SPIR-V that they point to outlive the call.
    let made = unsafe { api.create_shaders(&infos, None) }.map_err(|(_, result)| result)?;
    Ok([made[0], made[1]])
}

impl Shaders<'_> {
    /// Sets the common state of both draws: everything that a pipeline would contain.
    fn set_state(&self, commands: vk::CommandBuffer, [width, height]: [u32; 2]) {
        let (gpu, api) = (self.gpu, &self.api);
        let viewport = vk::Viewport { width: width as f32, height: height as f32, ..Default::default() };
        let viewport = vk::Viewport { max_depth: 1.0, ..viewport };
        let scissor = vk::Rect2D { offset: vk::Offset2D::default(), extent: vk::Extent2D { width, height } };
        let one = vk::SampleCountFlags::TYPE_1;
        // SAFETY: the command buffer is being recorded, on a device with the extension.
        unsafe {
            gpu.cmd_set_viewport_with_count(commands, &[viewport]);
            gpu.cmd_set_scissor_with_count(commands, &[scissor]);
            gpu.cmd_set_rasterizer_discard_enable(commands, false);
            gpu.cmd_set_primitive_topology(commands, vk::PrimitiveTopology::TRIANGLE_LIST);
            gpu.cmd_set_primitive_restart_enable(commands, false);
            gpu.cmd_set_cull_mode(commands, vk::CullModeFlags::NONE);
            gpu.cmd_set_front_face(commands, vk::FrontFace::COUNTER_CLOCKWISE);
            gpu.cmd_set_depth_test_enable(commands, true);
            gpu.cmd_set_depth_bias_enable(commands, false);
            gpu.cmd_set_depth_bounds_test_enable(commands, false);
            gpu.cmd_set_stencil_test_enable(commands, false);
            api.cmd_set_vertex_input(commands, &[], &[]);
            api.cmd_set_polygon_mode(commands, vk::PolygonMode::FILL);
            api.cmd_set_rasterization_samples(commands, one);
            api.cmd_set_sample_mask(commands, one, &[1]);
            api.cmd_set_alpha_to_coverage_enable(commands, false);
            api.cmd_set_color_blend_enable(commands, 0, &[vk::FALSE]);
            api.cmd_set_color_write_mask(commands, 0, &[vk::ColorComponentFlags::RGBA]);
        }
    }

    fn draw(
        &self,
        commands: vk::CommandBuffer,
        shaders: [vk::ShaderEXT; 2],
        depth: Depth,
        [vertices, instances]: [u32; 2],
    ) {
        let stages = [vk::ShaderStageFlags::VERTEX, vk::ShaderStageFlags::FRAGMENT];
        // SAFETY: as above; a pass was begun, and all state was set.
        unsafe {
            self.gpu.cmd_set_depth_write_enable(commands, depth.write);
            self.gpu.cmd_set_depth_compare_op(commands, depth.test.unwrap_or(vk::CompareOp::ALWAYS));
            self.api.cmd_bind_shaders(commands, &stages, &shaders);
            self.gpu.cmd_draw(commands, vertices, instances, 0, 0);
        }
    }
}
