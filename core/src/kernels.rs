//! CPU references of the GPU kernels. One stem names three files: the reference here, the shader
//! (`layer/shaders/<stem>.wgsl`) and the pass that records it (`layer/src/passes/<stem>.rs`); the layer's
//! build fails where one is missing. Kernels that do not exist yet have their references beside their models:
//! [`crate::plan::decide()`] and [`crate::perception::analyze`].

pub mod compose;
pub mod fill;
