//! Shading rates on devices without any: pixels that need no shading are kept from it by a depth template, and filled
//! after the pass.
//!
//! For a pass that is [`eligible`], the depth buffer is filled from a [`DepthTemplate`] ahead of the pass, which then
//! loads depth where the application clears it; where the application loads depth, skipped blocks are covered in that, and where
//! it needs depth later, they are filled (see [`crate::passes::depth`]). In a pass without depth, or with depth that must stay as it is,
//! fragment shaders return early in skipped blocks instead (see [`Way`]). Directly after the pass, [`crate::passes::fill`] fills what was skipped,
//! in every colour attachment that is stored. Both are recorded once; what is skipped is up to the content of the
//! template and of the skip list, which change between submits.

mod eligibility;
mod images;
mod kernels;
mod map;
mod returning;
mod template;
mod views;

pub use eligibility::{
    ColorFacts, DepthFacts, DepthWork, Directions, DynamicStencil, Eligible, MaskFacts, PipelineFacts,
    Reason, depth_format, eligible,
};
pub use images::added_usage;
pub use kernels::MaskKernels;
pub use map::MaskMap;
pub use returning::{Returns, Way, way};
pub use template::DepthTemplate;
pub use views::{lay_mask, mask_views};
