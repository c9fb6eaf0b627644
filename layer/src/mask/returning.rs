//! By which of two ways fragments are kept from being shaded: a template in depth, or a return at the begin of their shaders.

use super::DepthWork;
use super::eligibility::{Eligible, MaskFacts, Reason, eligible, of_colors};
use parafovea_core::mask::{DepthFormat, RETURNS};

/// Whether fragment shaders of some pipelines can return early.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Returns {
    /// There is one.
    pub any: bool,
    /// There is one that covers the same samples, with the same depth, when it does.
    pub keeping_coverage: bool,
}

/// What keeps fragments from being shaded in a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// A template in depth.
    Template(Eligible),
    /// Fragment shaders return at their begin, as far as they can: others shade everything, which is as well.
    Return {
        /// Only those do that cover the same samples, with the same depth: depth is as without, and so is what queries count
        /// and what conditions decide.
        keeps_coverage: bool,
        /// Why there is no template.
        instead: Reason,
    },
}

impl Way {
    /// The kind of the template of [`Way::Return`], which only shaders read.
    pub const RETURN: Eligible = Eligible {
        depths: RETURNS,
        format: DepthFormat::Blocks,
        drawn: None,
        work: DepthWork { covers: false, fills: false },
    };
}

/// The way of a pass.
///
/// A template is taken where there can be one, as fragments then never begin. Else fragment shaders return early: where depth is
/// tested or samples are counted, only such that change neither. An early fragment's colour is zero, blended with what was
/// loaded or not; that lies in skipped blocks, all of which are filled after the pass, in each stored colour attachment, whatever
/// earlier passes drew there: a block that is skipped is so in all passes to a target, until its mask is written anew between two
/// submits. Later subpasses see zeros in skipped blocks alone, as they read their own pixel.
///
/// # Errors
/// As for [`eligible`], where no shader can return early; or what stands against that.
pub fn way(facts: &MaskFacts) -> Result<Way, Reason> {
    let instead = match eligible(facts) {
        Ok(eligible) => return Ok(Way::Template(eligible)),
        Err(reason) => reason,
    };
    let returns = facts.pipelines.returns;
    let keeps_coverage = facts.depth.is_some() || facts.pass.is_queried;
    let can = if keeps_coverage { returns.keeping_coverage } else { returns.any };
    if !can || !allows_return(instead) {
        return Err(instead);
    }
    of_colors(facts.colors)?;
    Ok(Way::Return { keeps_coverage, instead })
}

/// Whether what stands against a template does not stand against an early return, too: it leaves depth, stencil and the effects of
/// other shaders as they are.
fn allows_return(reason: Reason) -> bool {
    matches!(
        reason,
        Reason::NoDepth
            | Reason::Queried
            | Reason::SideEffects
            | Reason::DepthUndefined
            | Reason::DepthLoaded
            | Reason::DepthUncleared
            | Reason::DepthReadWithin
            | Reason::DepthFormat(_)
            | Reason::Transient
            | Reason::DepthRead
            | Reason::DepthResolved
            | Reason::DepthClearedLater
            | Reason::StencilLoaded
            | Reason::StencilStored
            | Reason::NotWritable
            | Reason::NotReadable
            | Reason::Near(_)
    )
}
