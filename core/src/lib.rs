//! The models of Parafovea, as pure functions: no OpenXR, no Vulkan, no files, no clocks, no threads.
//!
//! In the order of a frame: [`geometry`] measures eccentricity, and [`gaze`] filters the samples of the eye tracker; [`audio`] measures
//! loudness and pitch, [`perception`] contrast and sensitivity to it; [`avpm`] turns both into a budget of visible contrast, and [`frco`] the
//! budget into a [`rate::ShadingRate`], with [`fixed_foveation`] as the baseline; [`schedule`] decides when parts of the view are updated, and
//! [`chroma`] how much chroma they keep. [`plan`] joins them in the plan of one frame. [`gate`] measures whether a technique saves time.
//! [`mask`] has the blocks that are skipped on devices without shading rates, and [`reuse`] the tiles that are taken from earlier
//! images. [`color`] has transfer functions, [`image`] buffers of pixels, and [`kernels`] the CPU references of the layer's kernels, with
//! parameters laid out as [`layout`] states.

#![forbid(unsafe_code)]

pub mod audio;
pub mod avpm;
pub mod chroma;
pub mod color;
pub mod fixed_foveation;
pub mod frco;
pub mod gate;
pub mod gaze;
pub mod geometry;
pub mod image;
pub mod kernels;
pub mod layout;
pub mod mask;
pub mod perception;
pub mod plan;
mod range;
pub mod rate;
pub mod reuse;
pub mod schedule;
