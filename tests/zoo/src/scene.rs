//! The scene's side on the device: parameters of a frame, and the draws.

mod uniforms;

pub use uniforms::{FAR, NEAR, Projection, Uniforms};

use crate::gpu::{Buffer, Depth, Gpu, Image, Made, PipelineSpec, Shader, Target};
use crate::shader;
use anyhow::Result;
use ash::vk;

/// Boxes in the scene, floor and wall among them.
pub const BOXES: u32 = 240;

/// Vertices of a box.
pub const VERTICES: u32 = 36;

/// Frames that may be on their way at once.
pub const IN_FLIGHT: usize = 2;

/// Bytes from one frame's uniforms to the next one's, a multiple that every device allows.
pub const STRIDE: usize = 512;

/// Every stage that there is here.
pub const STAGES: vk::ShaderStageFlags = vk::ShaderStageFlags::from_raw(
    vk::ShaderStageFlags::VERTEX.as_raw()
        | vk::ShaderStageFlags::FRAGMENT.as_raw()
        | vk::ShaderStageFlags::COMPUTE.as_raw(),
);

/// Textures that a set has room for, from binding 1 on.
const TEXTURES: u32 = 4;

/// Parameters of a draw, as `Draw` in `scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable, Default)]
pub struct Draw {
    pub view: u32,
    pub far: f32,
    pub value: f32,
    pub count: u32,
}

/// Common parts of all pipelines and sets.
pub struct Scene {
    pub layout: vk::PipelineLayout,
    pub set_layout: vk::DescriptorSetLayout,
    pub uniforms: Buffer,
    /// With the uniforms and nothing else.
    pub set: vk::DescriptorSet,
    pool: vk::DescriptorPool,
    sampler: vk::Sampler,
}

/// The pipelines of the scene's two draws.
#[derive(Clone, Copy)]
pub struct Pipelines {
    pub boxes: vk::Pipeline,
    pub sky: vk::Pipeline,
    /// Depth of the far plane.
    pub far: f32,
    /// Vertices of the sky's draw.
    pub sky_vertices: u32,
}

/// The four shaders of the two draws.
#[derive(Clone, Copy)]
pub struct Shaders {
    pub boxes: [Shader; 2],
    pub sky: [Shader; 2],
    /// Vertices of the sky's draw.
    pub sky_vertices: u32,
}

/// For one view a draw.
pub const FORWARD: Shaders = Shaders {
    boxes: [shader!("forward", "boxes_vs"), shader!("forward", "boxes_fs")],
    sky: [shader!("forward", "sky_vs"), shader!("forward", "sky_fs")],
    sky_vertices: 3,
};

/// Vertices of the screen in `multiview.wgsl`.
pub const FAN: u32 = 12;

/// For both views at once.
pub const MULTIVIEW: Shaders = Shaders {
    boxes: [shader!("multiview", "boxes_vs"), shader!("forward", "boxes_fs")],
    sky: [shader!("multiview", "sky_vs"), shader!("forward", "sky_fs")],
    sky_vertices: FAN,
};

impl Scene {
    /// Makes layouts, uniforms and the set for them.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn new(gpu: &Gpu) -> Result<Self> {
        let set_layout = set_layout(gpu)?;
        let layout = pipeline_layout(gpu, set_layout)?;
        let pool = pool(gpu)?;
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(vk::Filter::LINEAR)
            .min_filter(vk::Filter::LINEAR)
            .address_mode_u(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_v(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .max_lod(vk::LOD_CLAMP_NONE);
        // SAFETY: the structure outlives the call.
        let sampler = unsafe { gpu.create_sampler(&info, None) }?;
        gpu.keep(Made::Sampler(sampler));
        let usage = vk::BufferUsageFlags::UNIFORM_BUFFER | vk::BufferUsageFlags::STORAGE_BUFFER;
        let uniforms = gpu.buffer(STRIDE * IN_FLIGHT, usage)?;
        let set = vk::DescriptorSet::null();
        let mut scene = Self { layout, set_layout, uniforms, set, pool, sampler };
        scene.set = scene.textured(gpu, &[])?;
        Ok(scene)
    }

    /// A set with the uniforms and these textures, in SHADER_READ_ONLY_OPTIMAL, from binding 1 on.
    ///
    /// # Errors
    /// Errors of vkAllocateDescriptorSets.
    pub fn textured(&self, gpu: &Gpu, textures: &[Image]) -> Result<vk::DescriptorSet> {
        let layouts = [self.set_layout];
        let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(self.pool).set_layouts(&layouts);
        // SAFETY: pool and layout are live, and the pool has room for the sets of every style.
        let set = unsafe { gpu.allocate_descriptor_sets(&info) }?[0];
        let buffer = [vk::DescriptorBufferInfo::default()
            .buffer(self.uniforms.handle)
            .range(size_of::<Uniforms>() as u64)];
        let sampler = [vk::DescriptorImageInfo::default().sampler(self.sampler)];
        let images: Vec<_> = textures
            .iter()
            .map(|texture| {
                [vk::DescriptorImageInfo::default()
                    .image_view(texture.view)
                    .image_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)]
            })
            .collect();
        let write = || vk::WriteDescriptorSet::default().dst_set(set);
        let mut writes = vec![
            write().descriptor_type(vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC).buffer_info(&buffer),
            write().dst_binding(5).descriptor_type(vk::DescriptorType::SAMPLER).image_info(&sampler),
        ];
        for (binding, image) in (1..).zip(&images) {
            let ty = vk::DescriptorType::SAMPLED_IMAGE;
            writes.push(write().dst_binding(binding).descriptor_type(ty).image_info(image));
        }
        // SAFETY: the set is new, so nothing uses it; buffer, sampler and views are live.
        unsafe { gpu.update_descriptor_sets(&writes, &[]) };
        Ok(set)
    }

    /// As [`Self::textured`], with the textures written by an update template, as blade-graphics writes all descriptors.
    ///
    /// # Errors
    /// Errors of vkAllocateDescriptorSets and vkCreateDescriptorUpdateTemplate.
    pub fn textured_by_template(&self, gpu: &Gpu, textures: &[Image]) -> Result<vk::DescriptorSet> {
        let set = self.textured(gpu, &[])?;
        let data: Vec<_> = textures
            .iter()
            .map(|texture| {
                vk::DescriptorImageInfo::default()
                    .image_view(texture.view)
                    .image_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)
            })
            .collect();
        let stride = size_of::<vk::DescriptorImageInfo>();
        let entries: Vec<_> = (0..textures.len())
            .map(|index| {
                vk::DescriptorUpdateTemplateEntry::default()
                    .dst_binding(index as u32 + 1)
                    .descriptor_count(1)
                    .descriptor_type(vk::DescriptorType::SAMPLED_IMAGE)
                    .offset(index * stride)
                    .stride(stride)
            })
            .collect();
        let info = vk::DescriptorUpdateTemplateCreateInfo::default()
            .descriptor_update_entries(&entries)
            .template_type(vk::DescriptorUpdateTemplateType::DESCRIPTOR_SET)
            .descriptor_set_layout(self.set_layout);
        // SAFETY: the set is new, so nothing uses it; the views are live, and the data is as long as the entries need.
        unsafe {
            let template = gpu.create_descriptor_update_template(&info, None)?;
            gpu.update_descriptor_set_with_template(set, template, data.as_ptr().cast());
            gpu.destroy_descriptor_update_template(template, None);
        }
        Ok(set)
    }

    /// Gives a set a storage buffer, at binding 6.
    pub fn with_storage(&self, gpu: &Gpu, set: vk::DescriptorSet, buffer: vk::Buffer) {
        let info = [vk::DescriptorBufferInfo::default().buffer(buffer).range(vk::WHOLE_SIZE)];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(set)
            .dst_binding(6)
            .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
            .buffer_info(&info);
        // SAFETY: no submitted work uses the set, and the buffer is live.
        unsafe { gpu.update_descriptor_sets(&[write], &[]) };
    }

    /// Gives a set a storage image in GENERAL, at binding 8.
    pub fn with_storage_image(&self, gpu: &Gpu, set: vk::DescriptorSet, image: &Image) {
        let info = [vk::DescriptorImageInfo::default()
            .image_view(image.view)
            .image_layout(vk::ImageLayout::GENERAL)];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(set)
            .dst_binding(8)
            .descriptor_type(vk::DescriptorType::STORAGE_IMAGE)
            .image_info(&info);
        // SAFETY: as above.
        unsafe { gpu.update_descriptor_sets(&[write], &[]) };
    }

    /// Gives a set an input attachment, at binding 7.
    pub fn with_input(&self, gpu: &Gpu, set: vk::DescriptorSet, image: &Image) {
        let info = [vk::DescriptorImageInfo::default()
            .image_view(image.view)
            .image_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(set)
            .dst_binding(7)
            .descriptor_type(vk::DescriptorType::INPUT_ATTACHMENT)
            .image_info(&info);
        // SAFETY: as above.
        unsafe { gpu.update_descriptor_sets(&[write], &[]) };
    }

    /// Writes a slot's uniforms: no submitted work reads them any more.
    pub fn write(&self, slot: usize, uniforms: &Uniforms) {
        self.uniforms.write(slot * STRIDE, bytemuck::bytes_of(uniforms));
    }

    /// The pipelines for passes of `target`, with depth LESS and the sky LESS_OR_EQUAL.
    ///
    /// # Errors
    /// Errors of [`Gpu::pipeline`].
    pub fn pipelines(&self, gpu: &Gpu, target: &Target, shaders: &Shaders) -> Result<Pipelines> {
        self.pipelines_with(gpu, target, shaders, |_| {})
    }

    /// As [`Self::pipelines`], where `change` alters both.
    ///
    /// # Errors
    /// Errors of [`Gpu::pipeline`].
    pub fn pipelines_with(
        &self,
        gpu: &Gpu,
        target: &Target,
        shaders: &Shaders,
        change: impl Fn(&mut PipelineSpec),
    ) -> Result<Pipelines> {
        let make = |[vertex, fragment]: [Shader; 2], depth| {
            let mut spec = PipelineSpec::new(vertex, fragment, depth);
            change(&mut spec);
            gpu.pipeline(&spec, self.layout, target)
        };
        Ok(Pipelines {
            boxes: make(shaders.boxes, Depth::LESS)?,
            sky: make(shaders.sky, Depth::LAST)?,
            far: 1.0,
            sky_vertices: shaders.sky_vertices,
        })
    }

    /// Binds a set with the uniforms of a slot.
    pub fn bind(&self, gpu: &Gpu, commands: vk::CommandBuffer, set: vk::DescriptorSet, slot: usize) {
        let point = vk::PipelineBindPoint::GRAPHICS;
        let offsets = [(slot * STRIDE) as u32];
        // SAFETY: the command buffer is being recorded; layout and set are live.
        unsafe { gpu.cmd_bind_descriptor_sets(commands, point, self.layout, 0, &[set], &offsets) };
    }

    /// Sets the parameters of the next draws.
    pub fn push(&self, gpu: &Gpu, commands: vk::CommandBuffer, draw: &Draw) {
        // SAFETY: as above; the layout has room for it.
        unsafe { gpu.cmd_push_constants(commands, self.layout, STAGES, 0, bytemuck::bytes_of(draw)) };
    }

    /// Draws the scene for a view: boxes, then the sky. The pass is the caller's.
    pub fn draw(
        &self,
        gpu: &Gpu,
        commands: vk::CommandBuffer,
        pipelines: &Pipelines,
        slot: usize,
        view: u32,
    ) {
        self.bind(gpu, commands, self.set, slot);
        self.push(gpu, commands, &Draw { view, far: pipelines.far, ..Draw::default() });
        // SAFETY: a pass that the pipelines fit was begun, and all that they need is bound.
        unsafe {
            gpu.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, pipelines.boxes);
            gpu.cmd_draw(commands, VERTICES, BOXES, 0, 0);
            gpu.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, pipelines.sky);
            gpu.cmd_draw(commands, pipelines.sky_vertices, 1, 0, 0);
        }
    }

    /// Draws the boxes alone for a view, with a set.
    pub fn draw_boxes(
        &self,
        gpu: &Gpu,
        commands: vk::CommandBuffer,
        pipeline: vk::Pipeline,
        (set, slot): (vk::DescriptorSet, usize),
        view: usize,
    ) {
        self.bind(gpu, commands, set, slot);
        self.push(gpu, commands, &Draw { view: view as u32, ..Draw::default() });
        // SAFETY: as above.
        unsafe {
            gpu.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, pipeline);
            gpu.cmd_draw(commands, VERTICES, BOXES, 0, 0);
        }
    }

    /// Draws a triangle over the whole pass, with a set and the shader's parameters.
    pub fn draw_screen(
        &self,
        gpu: &Gpu,
        commands: vk::CommandBuffer,
        pipeline: vk::Pipeline,
        (set, slot): (vk::DescriptorSet, usize),
        draw: &Draw,
    ) {
        self.bind(gpu, commands, set, slot);
        self.push(gpu, commands, draw);
        // SAFETY: as above.
        unsafe {
            gpu.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, pipeline);
            gpu.cmd_draw(commands, 3, 1, 0, 0);
        }
    }
}

/// One layout for the sets of all shaders: the uniforms, four textures, a sampler, a storage buffer, an input
/// attachment and a storage image. Bindings that a shader does not use are not written.
fn set_layout(gpu: &Gpu) -> Result<vk::DescriptorSetLayout> {
    let binding = |number, ty, stages| {
        vk::DescriptorSetLayoutBinding::default()
            .binding(number)
            .descriptor_type(ty)
            .descriptor_count(1)
            .stage_flags(stages)
    };
    let reads = vk::ShaderStageFlags::FRAGMENT | vk::ShaderStageFlags::COMPUTE;
    let mut bindings = vec![
        binding(0, vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC, STAGES),
        binding(5, vk::DescriptorType::SAMPLER, reads),
        binding(6, vk::DescriptorType::STORAGE_BUFFER, reads),
        binding(7, vk::DescriptorType::INPUT_ATTACHMENT, vk::ShaderStageFlags::FRAGMENT),
        binding(8, vk::DescriptorType::STORAGE_IMAGE, vk::ShaderStageFlags::COMPUTE),
    ];
    bindings.extend((1..=TEXTURES).map(|number| binding(number, vk::DescriptorType::SAMPLED_IMAGE, reads)));
    let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
    // SAFETY: the structure outlives the call.
    let layout = unsafe { gpu.create_descriptor_set_layout(&info, None) }?;
    gpu.keep(Made::SetLayout(layout));
    Ok(layout)
}

/// The layout with one set, and room for [`Draw`].
///
/// # Errors
/// Errors of vkCreatePipelineLayout.
pub fn pipeline_layout(gpu: &Gpu, set_layout: vk::DescriptorSetLayout) -> Result<vk::PipelineLayout> {
    let sets = [set_layout];
    let ranges = [vk::PushConstantRange { stage_flags: STAGES, offset: 0, size: size_of::<Draw>() as u32 }];
    let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets).push_constant_ranges(&ranges);
    // SAFETY: the set layout is live.
    let layout = unsafe { gpu.create_pipeline_layout(&info, None) }?;
    gpu.keep(Made::PipelineLayout(layout));
    Ok(layout)
}

/// Room for the sets of every style.
fn pool(gpu: &Gpu) -> Result<vk::DescriptorPool> {
    const SETS: u32 = 32;
    let size = |ty, each| vk::DescriptorPoolSize { ty, descriptor_count: SETS * each };
    let sizes = [
        size(vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC, 1),
        size(vk::DescriptorType::SAMPLED_IMAGE, TEXTURES),
        size(vk::DescriptorType::SAMPLER, 1),
        size(vk::DescriptorType::STORAGE_BUFFER, 1),
        size(vk::DescriptorType::INPUT_ATTACHMENT, 1),
        size(vk::DescriptorType::STORAGE_IMAGE, 1),
    ];
    let info = vk::DescriptorPoolCreateInfo::default().max_sets(SETS).pool_sizes(&sizes);
    // SAFETY: the structure outlives the call.
    let pool = unsafe { gpu.create_descriptor_pool(&info, None) }?;
    gpu.keep(Made::DescriptorPool(pool));
    Ok(pool)
}
