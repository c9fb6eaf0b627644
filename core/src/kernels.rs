//! CPU references of the GPU kernels. One stem names three files: the reference here, the shader
//! (`layer/shaders/<stem>.wgsl`) and the pass that records it (`layer/src/kernels/<stem>.rs`); the layer's
//! build fails where one is missing.

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
