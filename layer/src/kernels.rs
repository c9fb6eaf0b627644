//! The passes, in the order in which a frame goes through them. Each has one stem in three places: the
//! shader in `layer/shaders`, the CPU reference in `parafovea_core::kernels`, and the pass here.

pub mod analyze;
pub mod change;
pub mod compose;
pub mod debug_view;
pub mod decide;
pub mod fill;
pub mod mask;
pub mod nearest;
pub mod resolve;
pub mod samples;
pub mod template;
