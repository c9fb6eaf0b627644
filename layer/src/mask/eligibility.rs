//! Which passes can have a mask without anybody noticing, and why others cannot.

use super::returning::Returns;
use crate::passes::fill::fill_format;
use crate::scene::PassFacts;
use ash::vk;
use parafovea_core::mask::{DepthFormat, Direction, NoNearValue, TemplateDepths, near_value};
use std::fmt;

/// What is known of a pass.
#[derive(Clone, Copy, Debug)]
pub struct MaskFacts<'a> {
    /// What was recorded.
    pub pass: PassFacts,
    /// Its depth attachment.
    pub depth: Option<DepthFacts>,
    /// Its colour attachments, and what they are resolved to in the pass; none of a depth pre-pass, which has a template for the sake of the
    /// passes that go on with its depth.
    pub colors: &'a [ColorFacts],
    /// The pipelines that are used in it, together.
    pub pipelines: PipelineFacts,
    /// Whether its fragment shaders return early where they can, as the device shades fragments of several samples whose depth tests have
    /// all failed.
    pub prefers_return: bool,
}

/// The depth attachment of a pass.
#[derive(Clone, Copy, Debug)]
pub struct DepthFacts {
    /// Its format.
    pub format: vk::Format,
    /// Its samples.
    pub samples: vk::SampleCountFlags,
    /// What the application made the image for.
    pub usage: vk::ImageUsageFlags,
    /// What it is cleared to, or was by the pass that was seen to clear it last; not a number if neither is known.
    pub clear: f32,
    /// Whether it is loaded.
    pub is_loaded: bool,
    /// Whether the pass can begin with depth that is loaded.
    pub is_loadable: bool,
    /// Whether an earlier pass of the command buffer had a template in it, which it still holds.
    pub is_covered: bool,
    /// Whether shaders of the pass may read it, by its layout in the pass.
    pub is_read_within: bool,
    /// Whether stencil is stored at the end.
    pub stores_stencil: bool,
    /// Whether another pass was seen to load it.
    pub is_loaded_later: bool,
    /// Whether it is one of an XR swapchain's images.
    pub is_submitted: bool,
    /// Whether it has been made to be copied to.
    pub is_writable: bool,
    /// Whether it has been made to be copied from.
    pub is_readable: bool,
}

/// A colour attachment of a pass, or what one is resolved to.
#[derive(Clone, Copy, Debug)]
pub struct ColorFacts {
    /// Its format.
    pub format: vk::Format,
    /// Its samples.
    pub samples: vk::SampleCountFlags,
    /// Whether it is stored at the end, as what is resolved to always is.
    pub is_stored: bool,
    /// Whether it has been made to be filled, see [`crate::passes::fill::USAGE`] and [`crate::passes::samples::USAGE`].
    pub is_fillable: bool,
}

/// Ways of the depth tests that were seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Directions {
    /// LESS or LESS_OR_EQUAL.
    pub less: bool,
    /// GREATER or GREATER_OR_EQUAL.
    pub greater: bool,
}

impl Directions {
    /// Notes a depth test; those that go neither way say nothing.
    pub fn see(&mut self, compare: vk::CompareOp) {
        self.less |= matches!(compare, vk::CompareOp::LESS | vk::CompareOp::LESS_OR_EQUAL);
        self.greater |= matches!(compare, vk::CompareOp::GREATER | vk::CompareOp::GREATER_OR_EQUAL);
    }

    fn iter(self) -> impl Iterator<Item = Direction> {
        let less = self.less.then_some(Direction::Less);
        less.into_iter().chain(self.greater.then_some(Direction::Greater))
    }
}

/// The parts of a pipeline's stencil tests that are dynamic state, set by commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DynamicStencil {
    /// Whether stencil is tested.
    pub test: bool,
    /// Operations of both faces.
    pub op: bool,
}

/// What the pipelines of a pass do, as far as it matters here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PipelineFacts {
    /// One has a fragment shader that writes to a buffer or to a storage image, or counts atomically.
    pub have_side_effects: bool,
    /// One may write stencil.
    pub write_stencil: bool,
    /// The parts of that which are dynamic state.
    pub dynamic_stencil: DynamicStencil,
    /// One cannot be looked into.
    pub are_unknown: bool,
    /// Their depth tests.
    pub directions: Directions,
    /// Whether their fragment shaders can return early.
    pub returns: Returns,
}

impl PipelineFacts {
    /// Of what cannot be looked into.
    pub const UNKNOWN: Self = Self {
        have_side_effects: true,
        write_stencil: true,
        dynamic_stencil: DynamicStencil { test: false, op: false },
        are_unknown: true,
        directions: Directions { less: false, greater: false },
        returns: Returns { any: false, keeping_coverage: false },
    };

    /// One more is used.
    pub fn see(&mut self, other: Self) {
        self.have_side_effects |= other.have_side_effects;
        self.write_stencil |= other.write_stencil;
        self.dynamic_stencil.test |= other.dynamic_stencil.test;
        self.dynamic_stencil.op |= other.dynamic_stencil.op;
        self.are_unknown |= other.are_unknown;
        self.directions.less |= other.directions.less;
        self.directions.greater |= other.directions.greater;
        self.returns.any |= other.returns.any;
        self.returns.keeping_coverage |= other.returns.keeping_coverage;
    }

    /// The same, but for stencil where dynamic state decides whether it is written.
    pub fn without_dynamic_stencil(self) -> Self {
        let DynamicStencil { test, op } = self.dynamic_stencil;
        Self { write_stencil: self.write_stencil && !test && !op, ..self }
    }
}

/// What a mask needs to know of a pass that can have one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eligible {
    /// What its template holds.
    pub depths: TemplateDepths,
    /// How the template is laid out.
    pub format: DepthFormat,
    /// Format and samples of an image that it is drawn to and copied from; None if it is copied from a buffer, which takes an
    /// image of one sample (Vulkan specification, "Copying Data Between Buffers and Images").
    pub drawn: Option<(vk::Format, vk::SampleCountFlags)>,
    /// What else is done with depth.
    pub work: DepthWork,
}

/// What is done with depth that is older than its pass, or outlives it, see [`crate::passes::depth`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DepthWork {
    /// It is loaded: skipped blocks are covered, where a template would replace the rest too.
    pub covers: bool,
    /// It is read, submitted or loaded later: skipped blocks are filled.
    pub fills: bool,
}

impl DepthWork {
    /// Whether there is any.
    pub fn is_any(self) -> bool {
        self.covers || self.fills
    }
}

/// Why a pass is left alone. `Display` completes "no mask: ...".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// Rates are off, or this frame is one without.
    Off,
    /// No earlier frame has shown that it is the scene, and what it does.
    New,
    /// Its template is an image that was not drawn yet; what the pass shows says what that shall hold.
    Undrawn,
    /// One of its images is not known.
    Unknown,
    /// It is recorded in a secondary command buffer.
    Secondary,
    /// What is bound for compute could not be restored after the fill.
    ComputeState,
    /// What is bound for drawing could not be restored after pipelines of ours.
    GraphicsState,
    /// Pictures are drawn to in turn, frame by frame, as temporal filters do, which read what they drew.
    History,
    /// No render pass that loads depth could be made of its own: colour of one sample is resolved in it, which breaks a rule (Vulkan
    /// specification, VUID-VkSubpassDescription-pResolveAttachments-00848), or its depth has more to say than is known.
    RenderPass,
    /// Depth and stencil are in different layouts.
    Layouts,
    /// Its render area cannot be copied to.
    Area,
    /// Its depth is not cleared as in the frames before.
    Changes,
    /// What it needs could not be made on the device.
    Failed,
    /// There is no depth attachment: nothing that could keep fragments out.
    NoDepth,
    /// Depth is neither cleared nor loaded.
    DepthUndefined,
    /// Several samples are loaded, and no earlier pass of the command buffer had a template in them: buffers, in which depth is covered, cannot
    /// be copied to them (Vulkan specification, VUID-vkCmdCopyBufferToImage-dstImage-07973), and what another command buffer left may be of
    /// another template.
    DepthLoaded,
    /// Depth is loaded, and nothing tells what it was cleared to.
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
    /// What earlier passes left in stencil of several samples is needed: a copy of depth alone between such images is untested.
    StencilLoaded,
    /// Stencil is written and stored: in skipped blocks it would be as if nothing were there.
    StencilStored,
    /// Samples are counted, or what they count decides what is drawn.
    Queried,
    /// It has shader objects, or pipelines that cannot be looked into.
    UnknownPipelines,
    /// Fragment shaders write elsewhere than to the attachments.
    SideEffects,
    /// The application has shading rates of its own.
    OwnRates,
    /// Rendering that is suspended and resumed.
    Suspended,
    /// A CPU shades fragments all of whose samples have failed their depth tests.
    ShadesHidden,
    /// Nothing is stored that shows.
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

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Off => "rates are off",
            Self::New => "absent from earlier frames",
            Self::Undrawn => "its mask template is not drawn yet",
            Self::Unknown => "unknown image",
            Self::Secondary => "recorded in a secondary command buffer",
            Self::ComputeState => "the compute state could not be restored after it",
            Self::GraphicsState => "the graphics state could not be restored after it",
            Self::History => "no depth attachment, and its images take turns, as those of a history do",
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
            Self::ShadesHidden => "the device shades hidden fragments of several samples",
            Self::NothingStored => "no colour attachment is stored",
            Self::ColorFormat(format) => return write!(f, "{format:?} cannot be interpolated"),
            Self::NotFillable => "a colour image cannot be copied",
            Self::NotWritable => "the depth image cannot be copied to",
            Self::NotReadable => "the depth image cannot be copied from",
            Self::Near(reason) => return reason.fmt(f),
        })
    }
}

/// How the depth aspect of a format is laid out in buffers.
pub fn depth_format(format: vk::Format) -> Option<DepthFormat> {
    match format {
        vk::Format::D16_UNORM | vk::Format::D16_UNORM_S8_UINT => Some(DepthFormat::Unorm16),
        vk::Format::X8_D24_UNORM_PACK32 | vk::Format::D24_UNORM_S8_UINT => Some(DepthFormat::Unorm24),
        vk::Format::D32_SFLOAT | vk::Format::D32_SFLOAT_S8_UINT => Some(DepthFormat::Float32),
        _ => None,
    }
}

/// Usages by which what a pass has stored is read.
const READS: vk::ImageUsageFlags = vk::ImageUsageFlags::from_raw(
    vk::ImageUsageFlags::SAMPLED.as_raw()
        | vk::ImageUsageFlags::STORAGE.as_raw()
        | vk::ImageUsageFlags::TRANSFER_SRC.as_raw()
        | vk::ImageUsageFlags::INPUT_ATTACHMENT.as_raw(),
);

/// Whether a pass can have a mask: what is shaded is bit for bit as without, and nobody reads what is not.
///
/// # Errors
/// The first reason against it.
pub fn eligible(facts: &MaskFacts) -> Result<Eligible, Reason> {
    of_pass(&facts.pass)?;
    if facts.pipelines.are_unknown {
        return Err(Reason::UnknownPipelines);
    }
    if facts.pipelines.have_side_effects {
        return Err(Reason::SideEffects);
    }
    let depth = facts.depth.ok_or(Reason::NoDepth)?;
    if facts.prefers_return && depth.samples != vk::SampleCountFlags::TYPE_1 {
        return Err(Reason::ShadesHidden);
    }
    let (format, work) = of_depth(&depth, facts)?;
    if !facts.colors.is_empty() {
        of_colors(facts.colors)?;
    }
    let depths = near_value(facts.pipelines.directions.iter(), depth.clear).map_err(Reason::Near)?;
    let is_drawn = depth.samples != vk::SampleCountFlags::TYPE_1;
    Ok(Eligible { depths, format, drawn: is_drawn.then_some((depth.format, depth.samples)), work })
}

fn of_pass(pass: &PassFacts) -> Result<(), Reason> {
    let against = [
        (pass.has_own_rates, Reason::OwnRates),
        (pass.is_suspended, Reason::Suspended),
        (pass.is_queried, Reason::Queried),
        (pass.clears_depth_later, Reason::DepthClearedLater),
        (pass.resolves_depth, Reason::DepthResolved),
    ];
    first(&against)
}

/// Depth that is loaded, and depth that is needed after the pass, are copied to a buffer and back, where skipped blocks are
/// covered and filled: outside of those every pass finds the depth that it would find without a mask. Depth of several samples is
/// filled by a draw, and covered by the template of the pass that cleared it.
fn of_depth(depth: &DepthFacts, facts: &MaskFacts) -> Result<(DepthFormat, DepthWork), Reason> {
    let pass = &facts.pass;
    let is_needed = depth.usage.intersects(READS) || depth.is_submitted || depth.is_loaded_later;
    let work = DepthWork { covers: !pass.clears_depth, fills: pass.stores_depth && is_needed };
    let is_multisampled = depth.samples != vk::SampleCountFlags::TYPE_1;
    let is_transient = depth.usage.contains(vk::ImageUsageFlags::TRANSIENT_ATTACHMENT);
    first(&[
        (work.covers && !depth.is_loaded, Reason::DepthUndefined),
        (!depth.is_loadable, Reason::RenderPass),
        (work.covers && is_multisampled && !depth.is_covered, Reason::DepthLoaded),
        (work.covers && depth.is_read_within, Reason::DepthReadWithin),
        (work.covers && depth.clear.is_nan(), Reason::DepthUncleared),
        (is_transient, Reason::Transient),
        (pass.loads_stencil && is_multisampled && !depth.is_covered, Reason::StencilLoaded),
        (depth.stores_stencil && facts.pipelines.write_stencil, Reason::StencilStored),
        (!depth.is_writable, Reason::NotWritable),
        (work.is_any() && !depth.is_readable, Reason::NotReadable),
    ])?;
    let format = depth_format(depth.format).ok_or(Reason::DepthFormat(depth.format))?;
    Ok((format, work))
}

pub(super) fn of_colors(colors: &[ColorFacts]) -> Result<(), Reason> {
    let stored = || colors.iter().filter(|color| color.is_stored);
    for color in stored() {
        first(&[
            (fill_format(color.format).is_none(), Reason::ColorFormat(color.format)),
            (!color.is_fillable, Reason::NotFillable),
        ])?;
    }
    first(&[(stored().next().is_none(), Reason::NothingStored)])
}

fn first(against: &[(bool, Reason)]) -> Result<(), Reason> {
    against.iter().find(|(holds, _)| *holds).map_or(Ok(()), |(_, reason)| Err(*reason))
}

#[cfg(test)]
mod tests;
