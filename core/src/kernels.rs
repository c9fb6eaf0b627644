//! CPU references of the GPU kernels. One stem names three files: the reference here, the shader
//! (`layer/shaders/<stem>.wgsl`) and the pass that records it (`layer/src/passes/<stem>.rs`); the layer's
//! build fails where one is missing. A kernel that does not exist yet has its reference beside its model:
//! [`crate::plan::decide()`].

pub mod analyze;
pub mod compose;
pub mod fill;
