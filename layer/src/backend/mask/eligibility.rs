//! Passes that can have a mask without a visible difference, and the reasons why others cannot.

use crate::backend::mask::color_fill::FillKind;
use crate::backend::mask::method::EarlyReturnSupport;
use crate::pass_detection::{PassFacts, Unmasked};
use ash::vk;
use parafovea_core::mask::{DepthFormat, Direction, TemplateDepths, near_value};

/// Facts about a pass.
#[derive(Clone, Copy, Debug)]
pub struct MaskFacts<'a> {
    /// Facts of its recording.
    pub pass: PassFacts,
    /// Its depth attachment.
    pub depth: Option<DepthFacts>,
    /// Its colour attachments, and their resolve targets in the pass; none of a depth pre-pass, which has a template for the sake of the
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
    /// The application's usage of the image.
    pub usage: vk::ImageUsageFlags,
    /// Its clear value, or that of the last pass that cleared it; not a number if neither is known.
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
    /// Whether stencil has a layout of its own, which barriers of a template do not name.
    pub is_separate: bool,
    /// Whether it has been made to be copied to.
    pub is_writable: bool,
    /// Whether it has been made to be copied from.
    pub is_readable: bool,
}

/// A colour attachment of a pass, or its resolve target.
#[derive(Clone, Copy, Debug)]
pub struct ColorFacts {
    /// Its format.
    pub format: vk::Format,
    /// Its samples.
    pub samples: vk::SampleCountFlags,
    /// Whether it is stored at the end, as resolve targets always are, and may be read after it: transient colour that no pass was seen to load
    /// and no shader reads is not.
    pub is_stored: bool,
    /// Whether it has been made to be filled, see [`crate::kernels::fill::USAGE`] and [`crate::kernels::samples::USAGE`].
    pub is_fillable: bool,
}

/// Directions of the depth tests so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Directions {
    /// LESS or LESS_OR_EQUAL.
    pub less: bool,
    /// GREATER or GREATER_OR_EQUAL.
    pub greater: bool,
}

impl Directions {
    /// Notes a depth test; tests in neither direction have no effect.
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

/// Effects of the pipelines of a pass, as far as they matter here.
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
    pub returns: EarlyReturnSupport,
}

impl PipelineFacts {
    /// Of pipelines that cannot be looked into.
    pub const UNKNOWN: Self = Self {
        have_side_effects: true,
        write_stencil: true,
        dynamic_stencil: DynamicStencil { test: false, op: false },
        are_unknown: true,
        directions: Directions { less: false, greater: false },
        returns: EarlyReturnSupport { any: false, keeping_coverage: false },
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

/// The template of a pass that can have a mask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eligible {
    /// The depths in its template.
    pub depths: TemplateDepths,
    /// Layout of the template.
    pub format: DepthFormat,
    /// Format and samples of an image that it is drawn to and copied from; None if it is copied from a buffer, which takes an
    /// image of one sample (Vulkan specification, "Copying Data Between Buffers and Images").
    pub drawn: Option<(vk::Format, vk::SampleCountFlags)>,
    /// Further work on depth.
    pub work: DepthWork,
}

/// Work on depth that is older than its pass, or outlives it, see [`crate::kernels::nearest`].
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

/// Layout of a format's depth aspect in buffers; `None` for a format without depth.
pub fn depth_format(format: vk::Format) -> Option<DepthFormat> {
    match format {
        vk::Format::D16_UNORM | vk::Format::D16_UNORM_S8_UINT => Some(DepthFormat::Unorm16),
        vk::Format::X8_D24_UNORM_PACK32 | vk::Format::D24_UNORM_S8_UINT => Some(DepthFormat::Unorm24),
        vk::Format::D32_SFLOAT | vk::Format::D32_SFLOAT_S8_UINT => Some(DepthFormat::Float32),
        _ => None,
    }
}

/// Usages that read stored attachments of a pass.
const READS: vk::ImageUsageFlags = vk::ImageUsageFlags::from_raw(
    vk::ImageUsageFlags::SAMPLED.as_raw()
        | vk::ImageUsageFlags::STORAGE.as_raw()
        | vk::ImageUsageFlags::TRANSFER_SRC.as_raw()
        | vk::ImageUsageFlags::INPUT_ATTACHMENT.as_raw(),
);

/// Whether a pass can have a mask: shaded pixels are bit-identical to rendering without it, and the others are not read.
///
/// # Errors
/// The first reason against it.
pub fn eligible(facts: &MaskFacts) -> Result<Eligible, Unmasked> {
    of_pass(&facts.pass)?;
    if facts.pipelines.are_unknown {
        return Err(Unmasked::UnknownPipelines);
    }
    if facts.pipelines.have_side_effects {
        return Err(Unmasked::SideEffects);
    }
    let depth = facts.depth.ok_or(Unmasked::NoDepth)?;
    if facts.prefers_return && depth.samples != vk::SampleCountFlags::TYPE_1 {
        return Err(Unmasked::ShadesHidden);
    }
    let (format, work) = of_depth(&depth, facts)?;
    if !facts.colors.is_empty() {
        of_colors(facts.colors)?;
    }
    let depths = near_value(facts.pipelines.directions.iter(), depth.clear).map_err(Unmasked::Near)?;
    let is_drawn = depth.samples != vk::SampleCountFlags::TYPE_1;
    Ok(Eligible { depths, format, drawn: is_drawn.then_some((depth.format, depth.samples)), work })
}

fn of_pass(pass: &PassFacts) -> Result<(), Unmasked> {
    let against = [
        (pass.has_own_rates, Unmasked::OwnRates),
        (pass.is_suspended, Unmasked::Suspended),
        (pass.is_queried, Unmasked::Queried),
        (pass.clears_depth_later, Unmasked::DepthClearedLater),
        (pass.resolves_depth, Unmasked::DepthResolved),
    ];
    first(&against)
}

/// Depth that is loaded, and depth that is needed after the pass, are copied to a buffer and back, where skipped blocks are
/// covered and filled: outside of those every pass finds the depth that it would find without a mask. Depth of several samples is
/// filled by a draw, and covered by the template of the pass that cleared it.
fn of_depth(depth: &DepthFacts, facts: &MaskFacts) -> Result<(DepthFormat, DepthWork), Unmasked> {
    let pass = &facts.pass;
    let is_needed = depth.usage.intersects(READS) || depth.is_submitted || depth.is_loaded_later;
    let work = DepthWork { covers: !pass.clears_depth, fills: pass.stores_depth && is_needed };
    let is_multisampled = depth.samples != vk::SampleCountFlags::TYPE_1;
    let is_transient = depth.usage.contains(vk::ImageUsageFlags::TRANSIENT_ATTACHMENT);
    first(&[
        (work.covers && !depth.is_loaded, Unmasked::DepthUndefined),
        (!depth.is_loadable, Unmasked::RenderPass),
        (work.covers && is_multisampled && !depth.is_covered, Unmasked::DepthLoaded),
        (work.covers && depth.is_read_within, Unmasked::DepthReadWithin),
        (work.covers && depth.clear.is_nan(), Unmasked::DepthUncleared),
        (is_transient, Unmasked::Transient),
        (pass.loads_stencil && is_multisampled && !depth.is_covered, Unmasked::StencilLoaded),
        (depth.stores_stencil && facts.pipelines.write_stencil, Unmasked::StencilStored),
        (!depth.is_writable, Unmasked::NotWritable),
        (work.is_any() && !depth.is_readable, Unmasked::NotReadable),
        (depth.is_separate, Unmasked::Layouts),
    ])?;
    let format = depth_format(depth.format).ok_or(Unmasked::DepthFormat(depth.format))?;
    Ok((format, work))
}

/// Motion, indices and the like are filled beside colour that is interpolated. A pass that stores nothing else is left alone: it shades
/// little, and the pass that reads it can have a mask.
pub(super) fn of_colors(colors: &[ColorFacts]) -> Result<(), Unmasked> {
    let stored = || colors.iter().filter(|color| color.is_stored);
    let mut is_color = false;
    for color in stored() {
        let kind = FillKind::of(color.format, color.samples);
        is_color |= matches!(kind, Some(FillKind::Interpolated(_)));
        first(&[
            (kind.is_none(), Unmasked::ColorFormat(color.format)),
            (!color.is_fillable, Unmasked::NotFillable),
        ])?;
    }
    let one = stored().next().ok_or(Unmasked::NothingStored)?;
    first(&[(!is_color, Unmasked::ColorFormat(one.format))])
}

fn first(against: &[(bool, Unmasked)]) -> Result<(), Unmasked> {
    against.iter().find(|(holds, _)| *holds).map_or(Ok(()), |(_, reason)| Err(*reason))
}

#[cfg(test)]
pub(super) mod tests;
