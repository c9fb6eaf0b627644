//! `samples`: the skipped blocks of pictures and depth of several samples, which can be copied to no buffer and written by no compute
//! shader: they are drawn, from a copy.

use crate::gpu::{
    AppCommands, Bound, ComputeLayout, ComputeSet, DeviceBuffer, Gpu, GpuError, ImageDescription, ImagePart,
    Owned, OwnedImage, SampleAspect, SamplePass, SampleTarget, Scope, array_view, depth_view,
};
use ash::vk;
use parafovea_core::kernels::samples::SampleParams;
use std::ffi::CStr;
use std::sync::Arc;

/// Parameters, template, picture, depth.
const BINDINGS: [vk::DescriptorType; 4] = [
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::SAMPLED_IMAGE,
    vk::DescriptorType::SAMPLED_IMAGE,
];

/// Usage of images of several samples.
pub const USAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::TRANSFER_SRC;

/// Images that one pipeline fills.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SampleKind {
    /// Their format.
    pub format: vk::Format,
    /// Their samples.
    pub samples: vk::SampleCountFlags,
    /// Whether they are colour, or depth.
    pub is_color: bool,
}

/// The pass, compiled for images of one kind.
pub struct SampleKernel {
    // In the order in which each may be destroyed.
    pass: SamplePass,
    layout: ComputeLayout,
    kind: SampleKind,
}

impl SampleKernel {
    /// Compiles it.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>, kind: SampleKind) -> Result<Self, GpuError> {
        let entry: &CStr = if kind.is_color { c"color" } else { c"depth" };
        let layout = ComputeLayout::for_stage(gpu, &BINDINGS, vk::ShaderStageFlags::FRAGMENT)?;
        let spirv = include_bytes!(concat!(env!("OUT_DIR"), "/samples.spv"));
        let shaders = (&spirv[..], [c"corner", entry]);
        let pass = SamplePass::new(gpu, &layout, shaders, (kind.format, kind.samples), kind.aspect())?;
        Ok(Self { pass, layout, kind })
    }
}

impl SampleKind {
    fn aspect(self) -> SampleAspect {
        if self.is_color { SampleAspect::Color } else { SampleAspect::Depth }
    }
}

/// One image of the application's that is drawn to.
pub struct SampleFill {
    // In the order in which each may be destroyed.
    sets: Vec<ComputeSet>,
    _params: DeviceBuffer,
    _views: Vec<Owned<vk::ImageView>>,
    copy: OwnedImage,
    target: SampleTarget,
    kernel: Arc<SampleKernel>,
    aspects: vk::ImageAspectFlags,
    extent: vk::Extent2D,
    layers: u32,
}

/// Skipped blocks, for the GPU.
#[derive(Clone, Copy)]
pub struct Skipped {
    /// Parameters of reading the words.
    pub params: SampleParams,
    /// The template, a storage buffer that outlives all objects that name it.
    pub words: vk::Buffer,
}

impl SampleFill {
    /// Prepares to fill an image of the kernel's kind, of at least the size that is said; `picture` has the layers to be filled, and all of its
    /// aspects.
    ///
    /// # Errors
    /// A failed call, or [`GpuError::Unsupported`] where there can be no copy of such an image.
    pub fn new(
        gpu: &Arc<Gpu>,
        kernel: &Arc<SampleKernel>,
        picture: ImagePart,
        Skipped { params, words }: Skipped,
    ) -> Result<Self, GpuError> {
        let SampleKind { format, samples, is_color } = kernel.kind;
        let extent = vk::Extent2D { width: params.width, height: params.height };
        let aspect = kernel.kind.aspect();
        let target = SampleTarget::new(gpu, &kernel.pass, picture, format, (extent, aspect))?;
        let transfers = vk::ImageUsageFlags::TRANSFER_SRC | vk::ImageUsageFlags::TRANSFER_DST;
        let copy = OwnedImage::new(
            gpu,
            &ImageDescription {
                format,
                samples: if is_color { vk::SampleCountFlags::TYPE_1 } else { samples },
                extent,
                array_layers: picture.layers,
                usage: transfers | vk::ImageUsageFlags::SAMPLED,
                mutable: false,
                view_formats: &[],
            },
        )?;
        let params =
            DeviceBuffer::holding(gpu, vk::BufferUsageFlags::STORAGE_BUFFER, bytemuck::bytes_of(&params))?;
        let aspects = picture.aspects;
        let views: Vec<_> = if is_color {
            let part =
                ImagePart { image: copy.handle(), aspects, level: 0, first_layer: 0, layers: picture.layers };
            vec![array_view(gpu, part, format, vk::ImageUsageFlags::SAMPLED)?]
        } else {
            let of_layer = |layer| depth_view(gpu, copy.handle(), format, layer);
            (0..picture.layers).map(of_layer).collect::<Result<_, _>>()?
        };
        let binding = if is_color { 2 } else { 3 };
        let set = |view: &Owned<vk::ImageView>| {
            let bound = [
                (0, Bound::Buffer(params.handle())),
                (1, Bound::Buffer(words)),
                (binding, Bound::Image(view.handle())),
            ];
            ComputeSet::new(&kernel.layout, &bound)
        };
        let sets = views.iter().map(set).collect::<Result<_, _>>()?;
        let (kernel, layers) = (Arc::clone(kernel), picture.layers);
        Ok(Self { sets, _params: params, _views: views, copy, target, kernel, aspects, extent, layers })
    }

    /// Records the fill of a picture, which is in `layout` before and after; `fill` records that of a picture of one sample.
    pub fn record_color(
        &self,
        commands: &AppCommands,
        picture: ImagePart,
        layout: vk::ImageLayout,
        fill: impl FnOnce(ImagePart, vk::ImageLayout),
    ) {
        use vk::ImageLayout as Layout;
        let copy = self.copy();
        // As in `fill`: this comes between the application's pass and all of its waiting.
        commands.barrier(picture, (layout, Scope::ALL), (Layout::TRANSFER_SRC_OPTIMAL, READS));
        commands.barrier(copy, (Layout::UNDEFINED, Scope::ALL), (Layout::TRANSFER_DST_OPTIMAL, WRITES));
        commands.resolve_image(picture, copy, self.extent);
        let read = Layout::SHADER_READ_ONLY_OPTIMAL;
        commands.barrier(copy, (Layout::TRANSFER_DST_OPTIMAL, WRITES), (read, Scope::ALL));
        fill(copy, read);
        self.draw(commands, picture, layout);
    }

    /// Records the fill of depth, which is in `layout` before and after.
    pub fn record_depth(&self, commands: &AppCommands, depth: ImagePart, layout: vk::ImageLayout) {
        use vk::ImageLayout as Layout;
        let copy = self.copy();
        let area = vk::Rect2D { offset: vk::Offset2D::default(), extent: self.extent };
        commands.barrier(depth, (layout, Scope::ALL), (Layout::TRANSFER_SRC_OPTIMAL, READS));
        commands.barrier(copy, (Layout::UNDEFINED, Scope::ALL), (Layout::TRANSFER_DST_OPTIMAL, WRITES));
        commands.copy_depth(depth, copy, area);
        let read = Layout::SHADER_READ_ONLY_OPTIMAL;
        commands.barrier(copy, (Layout::TRANSFER_DST_OPTIMAL, WRITES), (read, Scope::ALL));
        self.draw(commands, depth, layout);
    }

    /// Draws from the copy to an image that is in TRANSFER_SRC_OPTIMAL, and in `layout` afterwards.
    fn draw(&self, commands: &AppCommands, part: ImagePart, layout: vk::ImageLayout) {
        let within = self.kernel.kind.aspect().layout();
        commands.barrier(part, (vk::ImageLayout::TRANSFER_SRC_OPTIMAL, READS), (within, Scope::ALL));
        commands.draw_samples(&self.target, &self.kernel.pass, (&self.kernel.layout, &self.sets));
        commands.barrier(part, (within, Scope::ALL), (layout, Scope::ALL));
    }

    fn copy(&self) -> ImagePart {
        ImagePart {
            image: self.copy.handle(),
            aspects: self.aspects,
            level: 0,
            first_layer: 0,
            layers: self.layers,
        }
    }

    /// Whether it fills colour.
    pub fn is_color(&self) -> bool {
        self.kernel.kind.is_color
    }
}

/// Read accesses of copies.
const READS: Scope =
    Scope { stages: vk::PipelineStageFlags::TRANSFER, access: vk::AccessFlags::TRANSFER_READ };

/// Write accesses of copies.
const WRITES: Scope =
    Scope { stages: vk::PipelineStageFlags::TRANSFER, access: vk::AccessFlags::TRANSFER_WRITE };
