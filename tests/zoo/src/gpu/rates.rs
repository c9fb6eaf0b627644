//! Shading rates that the application sets itself: each pass that draws colour has a rate attachment, which becomes the pass's
//! map before it begins, in the same command buffer.

use super::{Attachment, Buffer, Gpu, Image, ImageSpec, Made, PassSpec, PipelineSpec, RatesFile, Target};
use anyhow::Result;
use ash::vk;
use std::collections::HashMap;

/// The format of rate images.
const FORMAT: vk::Format = vk::Format::R8_UINT;

const LAYOUT: vk::ImageLayout = vk::ImageLayout::FRAGMENT_SHADING_RATE_ATTACHMENT_OPTIMAL_KHR;

/// Copies begin at multiples of this many bytes.
const ALIGNMENT: usize = 4;

/// Users of the maps.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum RatesUse {
    /// The device, by rate attachments.
    Attachment,
    /// Shaders, which show how it looks.
    Look,
}

/// All maps, on the device from the start.
pub struct Rates {
    used: RatesUse,
    texel: [u32; 2],
    /// Whether a layer of the rate image serves each view.
    is_layered: bool,
    buffer: Buffer,
    /// Offset of the map of each pass of a frame, and its numbers of tiles and layers.
    places: HashMap<(u64, usize), Place>,
    /// Offset of the zeros, enough for the largest image.
    zeros: vk::DeviceSize,
}

#[derive(Clone, Copy)]
struct Place {
    offset: vk::DeviceSize,
    tiles: [u32; 3],
}

/// Texels of the largest rate image that there may be without a map in the file: 8192 pixels, 8 a texel, two layers.
const MOST_TEXELS: usize = 2 * 1024 * 1024;

impl Rates {
    /// # Errors
    /// Errors of the calls.
    pub fn new(gpu: &Gpu, used: RatesUse, file: RatesFile) -> Result<Self> {
        let mut offsets: HashMap<Vec<u8>, vk::DeviceSize> = HashMap::new();
        let (mut places, mut end) = (HashMap::new(), 0);
        for (number, map) in file.maps {
            let size = map.texels.len().next_multiple_of(ALIGNMENT);
            let offset = *offsets.entry(map.texels).or_insert_with(|| {
                end += size;
                (end - size) as vk::DeviceSize
            });
            places.insert(number, Place { offset, tiles: map.tiles });
        }
        let buffer = gpu.buffer(end + MOST_TEXELS, vk::BufferUsageFlags::TRANSFER_SRC)?;
        offsets.iter().for_each(|(texels, &offset)| buffer.write(offset as usize, texels));
        buffer.write(end, &vec![0; MOST_TEXELS]);
        let is_layered = used == RatesUse::Attachment && gpu.has_layered_rates();
        Ok(Self { used, texel: file.texel, is_layered, buffer, places, zeros: end as vk::DeviceSize })
    }
}

impl Gpu {
    /// Whether a pass has rates.
    pub(super) fn sets_rates(&self, spec: &PassSpec) -> bool {
        self.has_attachments() && !spec.colors.is_empty()
    }

    fn has_attachments(&self) -> bool {
        self.rates.as_ref().is_some_and(|rates| rates.used == RatesUse::Attachment)
    }

    fn has_layered_rates(&self) -> bool {
        let mut rates = vk::PhysicalDeviceFragmentShadingRatePropertiesKHR::default();
        let mut all = vk::PhysicalDeviceProperties2::default().push_next(&mut rates);
        // SAFETY: the physical device is of this instance, and has the extension.
        unsafe { self.instance.get_physical_device_properties2(self.physical, &mut all) };
        rates.layered_shading_rate_attachments == vk::TRUE
    }

    /// The rate image of a pass of that size, where it has rates.
    ///
    /// # Errors
    /// Errors of the calls.
    pub(super) fn rate_image(&self, spec: &PassSpec, extent: [u32; 2]) -> Result<Option<Image>> {
        let Some(rates) = self.rates.as_ref().filter(|_| self.sets_rates(spec)) else { return Ok(None) };
        let tiles = [0, 1].map(|axis| extent[axis].div_ceil(rates.texel[axis]));
        let layers = if rates.is_layered { spec.view_mask.count_ones().max(1) } else { 1 };
        let usage =
            vk::ImageUsageFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR | vk::ImageUsageFlags::TRANSFER_DST;
        Ok(Some(self.image(&ImageSpec::new(FORMAT, tiles).layers(layers).usage(usage))?))
    }

    /// Writes the map of a pass, given by number of frame and pass, to a rate image: 1x1 if the pass has none.
    pub(super) fn write_rates(&self, commands: vk::CommandBuffer, image: &Image, number: (u64, usize)) {
        self.write_map(commands, image, number, LAYOUT);
    }

    /// An image for the map of passes of this size, which shaders read.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn look_image(&self, extent: [u32; 2]) -> Result<Image> {
        let texel = self.texel();
        let tiles = [extent[0].div_ceil(texel.width.max(1)), extent[1].div_ceil(texel.height.max(1))];
        let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
        self.image(&ImageSpec::new(FORMAT, tiles).usage(usage))
    }

    /// Writes the map of the next pass to an image that shaders read.
    pub fn write_look_map(&self, commands: vk::CommandBuffer, image: &Image) {
        self.write_map(commands, image, self.next_pass(), vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL);
    }

    fn write_map(
        &self,
        commands: vk::CommandBuffer,
        image: &Image,
        number: (u64, usize),
        layout: vk::ImageLayout,
    ) {
        let Some(rates) = &self.rates else { return };
        let [width, height] = image.extent;
        let fits = |place: &&Place| place.tiles == [width, height, image.layers];
        let place = rates.places.get(&number);
        assert!(place.is_none_or(|place| fits(&place)), "a map of another size for pass {number:?}");
        let region = vk::BufferImageCopy::default()
            .buffer_offset(place.map_or(rates.zeros, |place| place.offset))
            .image_subresource(image.subresource())
            .image_extent(vk::Extent3D { width, height, depth: 1 });
        let copied = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        self.transition(commands, image, vk::ImageLayout::UNDEFINED, copied);
        let from = rates.buffer.handle;
        // SAFETY: the command buffer is being recorded, outside of a render pass; the buffer has a map of this size there,
        // and the image is in that layout.
        unsafe { self.cmd_copy_buffer_to_image(commands, from, image.handle, copied, &[region]) };
        self.transition(commands, image, copied, layout);
    }

    /// For vkCmdBeginRendering.
    pub(super) fn rate_attachment(
        &self,
        image: &Image,
    ) -> vk::RenderingFragmentShadingRateAttachmentInfoKHR<'static> {
        vk::RenderingFragmentShadingRateAttachmentInfoKHR::default()
            .image_view(image.view)
            .image_layout(LAYOUT)
            .shading_rate_attachment_texel_size(self.texel())
    }

    fn texel(&self) -> vk::Extent2D {
        let [width, height] = self.rates.as_ref().map_or([0; 2], |rates| rates.texel);
        vk::Extent2D { width, height }
    }

    /// A pipeline for a pass, which obeys rates where the pass has them, unless it has holes whose edges that would coarsen.
    pub(super) fn with_rates(&self, spec: &PipelineSpec, target: &Target) -> PipelineSpec {
        let mut spec = spec.clone();
        if self.has_attachments() && !target.colors.is_empty() {
            spec.rate = spec.rate.or(Some([1, 1]));
            spec.obeys_rates = !spec.discards && !spec.alpha_to_coverage;
            if target.render_pass == vk::RenderPass::null() {
                spec.flags |= vk::PipelineCreateFlags::RENDERING_FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
            }
        }
        spec
    }

    /// Makes a render pass of one subpass, with a rate attachment behind all others.
    ///
    /// # Errors
    /// Errors of vkCreateRenderPass2.
    pub(super) fn render_pass_with_rates(&self, spec: &PassSpec) -> Result<vk::RenderPass> {
        let rates = vk::AttachmentDescription2::default()
            .format(FORMAT)
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::LOAD)
            .store_op(vk::AttachmentStoreOp::STORE)
            .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
            .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
            .initial_layout(LAYOUT)
            .final_layout(LAYOUT);
        let attachments: Vec<_> = spec.attachments().map(description2).chain([rates]).collect();
        let reference = |index: usize, layout, aspect| {
            vk::AttachmentReference2::default().attachment(index as u32).layout(layout).aspect_mask(aspect)
        };
        let color = |index| {
            let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
            reference(index, layout, vk::ImageAspectFlags::COLOR)
        };
        let (count, resolves) = (spec.colors.len(), spec.resolves.len());
        let colors: Vec<_> = (0..count).map(color).collect();
        let resolved: Vec<_> = (count..count + resolves).map(color).collect();
        let layout = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
        let depth = reference(count + resolves, layout, vk::ImageAspectFlags::DEPTH);
        let rates = reference(attachments.len() - 1, LAYOUT, vk::ImageAspectFlags::COLOR);
        let mut rates = vk::FragmentShadingRateAttachmentInfoKHR::default()
            .fragment_shading_rate_attachment(&rates)
            .shading_rate_attachment_texel_size(self.texel());
        let mut subpass = vk::SubpassDescription2::default()
            .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
            .view_mask(spec.view_mask)
            .color_attachments(&colors)
            .push_next(&mut rates);
        if !resolved.is_empty() {
            subpass = subpass.resolve_attachments(&resolved);
        }
        if spec.depth.is_some() {
            subpass = subpass.depth_stencil_attachment(&depth);
        }
        let (subpasses, masks) = ([subpass], [spec.view_mask]);
        let dependencies = super::pass::dependencies(0).map(|before| {
            vk::SubpassDependency2::default()
                .src_subpass(before.src_subpass)
                .dst_subpass(before.dst_subpass)
                .src_stage_mask(before.src_stage_mask)
                .dst_stage_mask(before.dst_stage_mask)
                .src_access_mask(before.src_access_mask)
                .dst_access_mask(before.dst_access_mask)
                .dependency_flags(before.dependency_flags)
        });
        let mut info = vk::RenderPassCreateInfo2::default()
            .attachments(&attachments)
            .subpasses(&subpasses)
            .dependencies(&dependencies);
        if spec.view_mask != 0 {
            info = info.correlated_view_masks(&masks);
        }
        // SAFETY: the structures outlive the call; Vulkan 1.2 was asked for, and the device has the extension.
        let render_pass = unsafe { self.device.create_render_pass2(&info, None) }?;
        self.keep(Made::RenderPass(render_pass));
        Ok(render_pass)
    }
}

fn description2(attachment: &Attachment) -> vk::AttachmentDescription2<'static> {
    let before = attachment.description();
    vk::AttachmentDescription2::default()
        .format(before.format)
        .samples(before.samples)
        .load_op(before.load_op)
        .store_op(before.store_op)
        .stencil_load_op(before.stencil_load_op)
        .stencil_store_op(before.stencil_store_op)
        .initial_layout(before.initial_layout)
        .final_layout(before.final_layout)
}
