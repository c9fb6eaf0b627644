//! Reasons why a pass has no mask.

use ash::vk;
use parafovea_core::mask::NoNearValue;
use std::fmt;

/// Reason why a pass is left alone. `Display` completes "no mask: ...".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unmasked {
    /// Rates are off, or this frame is one without.
    Off,
    /// No earlier frame has shown that it is the scene, and which commands it has.
    New,
    /// Its template is an image that was not drawn yet; the picture of the pass decides its content.
    Undrawn,
    /// One of its images is not known.
    Unknown,
    /// It is recorded in a secondary command buffer.
    Secondary,
    /// The bound compute state could not be restored after the fill.
    ComputeState,
    /// The bound graphics state could not be restored after pipelines of ours.
    GraphicsState,
    /// Pictures are drawn to in turn, frame by frame, as by temporal filters, which read their last output.
    History,
    /// No render pass that loads depth could be made of its own: colour of one sample is resolved in it, which breaks a rule (Vulkan
    /// specification, VUID-VkSubpassDescription-pResolveAttachments-00848), or its depth has a chain that is not known.
    RenderPass,
    /// Depth and stencil are in different layouts.
    Layouts,
    /// Its render area cannot be copied to.
    Area,
    /// Its depth is not cleared as in the frames before.
    Changes,
    /// An object that it needs could not be made on the device.
    Failed,
    /// No depth attachment, in which fragments could be masked.
    NoDepth,
    /// Depth is neither cleared nor loaded.
    DepthUndefined,
    /// Several samples are loaded, and no earlier pass of the command buffer had a template in them: buffers, in which depth is covered,
    /// cannot be copied to them (Vulkan specification, VUID-vkCmdCopyBufferToImage-dstImage-07973), and depth from another command buffer
    /// may hold another template.
    DepthLoaded,
    /// Depth is loaded, and its clear value is unknown.
    DepthUncleared,
    /// Depth is loaded, and shaders of the pass may read it.
    DepthReadWithin,
    /// Copies to depth of this format are not known.
    DepthFormat(vk::Format),
    /// The depth image has no memory that could be copied to.
    Transient,
    /// Depth is resolved to another image, which is not filled.
    DepthResolved,
    /// Depth is cleared within the pass.
    DepthClearedLater,
    /// Stencil of several samples from earlier passes is needed: a copy of depth alone between such images is untested.
    StencilLoaded,
    /// Stencil is written and stored, and would lack the draws in skipped blocks.
    StencilStored,
    /// Samples are counted, or their count decides which draws are executed.
    Queried,
    /// Shader objects, or pipelines with unknown shaders.
    UnknownPipelines,
    /// Fragment shaders write elsewhere than to the attachments.
    SideEffects,
    /// The application has shading rates of its own.
    OwnRates,
    /// Rendering that is suspended and resumed.
    Suspended,
    /// A CPU shades fragments all of whose samples have failed their depth tests.
    ShadesHidden,
    /// No visible attachment is stored.
    NothingStored,
    /// Pictures of this format cannot be interpolated.
    ColorFormat(vk::Format),
    /// The image does not allow to be copied.
    NotFillable,
    /// The depth image does not allow to be copied to.
    NotWritable,
    /// The depth image does not allow to be copied from.
    NotReadable,
    /// The nearest depth is uncertain.
    Near(NoNearValue),
}

impl fmt::Display for Unmasked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Off => "rates are off",
            Self::New => "absent from earlier frames",
            Self::Undrawn => "its mask template is not drawn yet",
            Self::Unknown => "unknown image",
            Self::Secondary => "recorded in a secondary command buffer",
            Self::ComputeState => "the compute state could not be restored after it",
            Self::GraphicsState => "the graphics state could not be restored after it",
            Self::History => "no depth attachment, and its images alternate between frames, like a history",
            Self::RenderPass => "the render pass cannot be changed",
            Self::Layouts => "depth and stencil are in different layouts",
            Self::Area => "the render area is not a valid region for copies",
            Self::Changes => "the clear value of depth changed",
            Self::Failed => "a Vulkan object could not be created",
            Self::NoDepth => "no depth attachment",
            Self::DepthUndefined => "depth is neither cleared nor loaded",
            Self::DepthLoaded => {
                "multisampled depth is loaded that no earlier pass of its command buffer cleared"
            }
            Self::DepthUncleared => "depth is loaded, and no recorded pass clears it",
            Self::DepthReadWithin => "depth is loaded in a layout that shaders may read",
            Self::DepthFormat(format) => return write!(f, "the depth format {format:?} is not supported"),
            Self::Transient => "depth is a transient attachment",
            Self::DepthResolved => "depth is resolved",
            Self::DepthClearedLater => "depth is cleared within the pass",
            Self::StencilLoaded => "multisampled stencil is loaded",
            Self::StencilStored => "stencil is written and stored",
            Self::Queried => "it contains an occlusion query or conditional rendering",
            Self::UnknownPipelines => "it uses shader objects or unknown pipelines",
            Self::SideEffects => "fragment shaders write to buffers or storage images",
            Self::OwnRates => "the application sets shading rates itself",
            Self::Suspended => "rendering is suspended or resumed",
            Self::ShadesHidden => "the device shades hidden fragments of multisampled passes",
            Self::NothingStored => "no colour attachment is stored",
            Self::ColorFormat(format) => return write!(f, "{format:?} cannot be interpolated"),
            Self::NotFillable => "a colour image cannot be copied",
            Self::NotWritable => "the depth image cannot be copied to",
            Self::NotReadable => "the depth image cannot be copied from",
            Self::Near(reason) => return reason.fmt(f),
        })
    }
}
