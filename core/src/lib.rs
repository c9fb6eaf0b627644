//! The models of Parafovea, as pure functions: no OpenXR, no Vulkan, no files, no clocks, no threads.
//!
//! In the order in which a frame passes through them: [`geometry`] says how far from the gaze a pixel is,
//! [`chroma`] how much colour the eye resolves there, [`color`] how colours are coded, and [`kernels`]
//! are the CPU references of what the layer does on the GPU, with parameters laid out as [`layout`] states.

#![forbid(unsafe_code)]

pub mod chroma;
pub mod color;
pub mod geometry;
pub mod kernels;
pub mod layout;
