//! The two methods of a mask: a depth template, or an early return of fragment shaders.

use crate::backend::mask::DepthWork;
use crate::backend::mask::eligibility::{Eligible, MaskFacts, eligible, of_colors};
use crate::pass_detection::Unmasked;
use parafovea_core::mask::{DepthFormat, RETURNS};

/// Whether fragment shaders of some pipelines can return early.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EarlyReturnSupport {
    /// There is one.
    pub any: bool,
    /// There is one that covers the same samples, with the same depth, when it does.
    pub keeping_coverage: bool,
}

/// The means by which a pass skips fragments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MaskMethod {
    /// A template in depth.
    Template(Eligible),
    /// Fragment shaders return at their beginning; shaders without a return shade everything.
    Return {
        /// Only shaders do that cover the same samples, with the same depth: depth is as without, and so are the counts of queries and the
        /// outcome of conditions.
        keeps_coverage: bool,
        /// Reason for a missing template.
        instead: Unmasked,
    },
}

impl MaskMethod {
    /// The kind of the template of [`MaskMethod::Return`], which only shaders read.
    pub const RETURN: Eligible = Eligible {
        depths: RETURNS,
        format: DepthFormat::Blocks,
        drawn: None,
        work: DepthWork { covers: false, fills: false },
    };
}

/// The method of a pass's mask.
///
/// A template is used if there can be one, as fragments then never begin. Else fragment shaders return early: where depth is tested or
/// samples are counted, only shaders that change neither. An early fragment's colour is zero, blended with the loaded colour or not. It
/// lies in skipped blocks. Each stored colour attachment is filled in all of them after the pass, regardless of earlier passes: a
/// skipped block is skipped in all passes to a target, until its mask is written again between two submits. Later subpasses see zeros in
/// skipped blocks alone, as they read their own pixel.
///
/// # Errors
/// As for [`eligible`], if no shader can return early; or the reason against that.
pub fn method(facts: &MaskFacts) -> Result<MaskMethod, Unmasked> {
    let instead = match eligible(facts) {
        Ok(eligible) => return Ok(MaskMethod::Template(eligible)),
        Err(reason) => reason,
    };
    let returns = facts.pipelines.returns;
    let keeps_coverage = facts.depth.is_some() || facts.pass.is_queried;
    let can = if keeps_coverage { returns.keeping_coverage } else { returns.any };
    if !can || !allows_return(instead) {
        return Err(instead);
    }
    of_colors(facts.colors)?;
    Ok(MaskMethod::Return { keeps_coverage, instead })
}

/// Whether a pass without a template for this reason can have an early return, which leaves depth, stencil and the effects of other
/// shaders as they are.
fn allows_return(reason: Unmasked) -> bool {
    matches!(
        reason,
        Unmasked::NoDepth
            | Unmasked::Queried
            | Unmasked::SideEffects
            | Unmasked::ShadesHidden
            | Unmasked::RenderPass
            | Unmasked::DepthUndefined
            | Unmasked::DepthLoaded
            | Unmasked::DepthUncleared
            | Unmasked::DepthReadWithin
            | Unmasked::DepthFormat(_)
            | Unmasked::Transient
            | Unmasked::DepthResolved
            | Unmasked::DepthClearedLater
            | Unmasked::StencilLoaded
            | Unmasked::StencilStored
            | Unmasked::NotWritable
            | Unmasked::NotReadable
            | Unmasked::Layouts
            | Unmasked::Near(_)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::mask::eligibility::tests::{color, depth};
    use crate::backend::mask::eligibility::{ColorFacts, DepthFacts, PipelineFacts};
    use crate::pass_detection::PassFacts;
    use ash::vk;

    const KEEPING: EarlyReturnSupport = EarlyReturnSupport { any: true, keeping_coverage: true };
    const ANY: EarlyReturnSupport = EarlyReturnSupport { any: true, keeping_coverage: false };

    /// By depth, queries and fragment shaders of a pass.
    fn of(
        depth: Option<DepthFacts>,
        is_queried: bool,
        returns: EarlyReturnSupport,
        color: ColorFacts,
    ) -> Result<MaskMethod, Unmasked> {
        let pass = PassFacts { clears_depth: true, is_queried, ..PassFacts::default() };
        let pipelines = PipelineFacts { returns, ..PipelineFacts::default() };
        method(&MaskFacts { pass, depth, colors: &[color], pipelines, prefers_return: false })
    }

    #[test]
    fn a_template_comes_first() {
        assert!(matches!(of(Some(depth()), false, KEEPING, color()), Ok(MaskMethod::Template(_))));
    }

    #[test]
    fn without_depth_shaders_return_early() {
        let returned = |returns| of(None, false, returns, color());
        let method = MaskMethod::Return { keeps_coverage: false, instead: Unmasked::NoDepth };
        assert_eq!((returned(ANY), returned(KEEPING)), (Ok(method), Ok(method)));
        assert_eq!(returned(EarlyReturnSupport::default()), Err(Unmasked::NoDepth));
    }

    /// Counts, and depth that must stay as it is, do not change.
    #[test]
    fn where_coverage_counts_only_shaders_that_keep_it_return_early() {
        let queried = |depth, returns| of(depth, true, returns, color());
        let method = MaskMethod::Return { keeps_coverage: true, instead: Unmasked::Queried };
        for depth in [Some(depth()), None] {
            assert_eq!(queried(depth, KEEPING), Ok(method));
            assert_eq!(queried(depth, ANY), Err(Unmasked::Queried));
        }
        let transient = DepthFacts {
            usage: vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::TRANSIENT_ATTACHMENT,
            ..depth()
        };
        let method = MaskMethod::Return { keeps_coverage: true, instead: Unmasked::Transient };
        assert_eq!(of(Some(transient), false, KEEPING, color()), Ok(method));
        assert_eq!(of(Some(transient), false, ANY, color()), Err(Unmasked::Transient));
    }

    #[test]
    fn depth_that_cannot_be_loaded_or_has_separate_layouts_returns_early() {
        for (depth, instead) in [
            (DepthFacts { is_loadable: false, ..depth() }, Unmasked::RenderPass),
            (DepthFacts { is_separate: true, ..depth() }, Unmasked::Layouts),
        ] {
            let method = MaskMethod::Return { keeps_coverage: true, instead };
            assert_eq!(of(Some(depth), false, KEEPING, color()), Ok(method));
            assert_eq!(of(Some(depth), false, ANY, color()), Err(instead));
        }
    }

    /// A template keeps no work from a CPU that tests depth of several samples.
    #[test]
    fn several_samples_return_early_where_that_saves_more() {
        let pass = PassFacts { clears_depth: true, ..PassFacts::default() };
        let of = |samples, returns, prefers_return| {
            let pipelines = PipelineFacts { returns, ..PipelineFacts::default() };
            let depth = Some(DepthFacts { samples, ..depth() });
            method(&MaskFacts { pass, depth, colors: &[color()], pipelines, prefers_return })
        };
        let [one, four] = [vk::SampleCountFlags::TYPE_1, vk::SampleCountFlags::TYPE_4];
        let returned = MaskMethod::Return { keeps_coverage: true, instead: Unmasked::ShadesHidden };
        assert_eq!(of(four, KEEPING, true), Ok(returned));
        for template in [of(four, KEEPING, false), of(one, KEEPING, true)] {
            assert!(matches!(template, Ok(MaskMethod::Template(_))), "{template:?}");
        }
    }

    #[test]
    fn targets_that_cannot_be_filled_get_no_mask() {
        let format = vk::Format::R32_UINT;
        let identifiers = ColorFacts { format, ..color() };
        assert_eq!(of(None, false, KEEPING, identifiers), Err(Unmasked::ColorFormat(format)));
        let pass = PassFacts { has_own_rates: true, ..PassFacts::default() };
        let pipelines = PipelineFacts { returns: KEEPING, ..PipelineFacts::default() };
        let colors = &[color()];
        assert_eq!(
            method(&MaskFacts { pass, depth: None, colors, pipelines, prefers_return: false }),
            Err(Unmasked::OwnRates)
        );
    }
}
