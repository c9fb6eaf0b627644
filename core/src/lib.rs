//! The models of Parafovea, as pure functions: no OpenXR, no Vulkan, no files, no clocks, no threads.
//!
//! In the order in which a frame passes through them: [`geometry`] says how far from the gaze a pixel is, and
//! [`gaze`] how far the gaze itself can be trusted; [`audio`] measures what is heard, [`perception`] what contrast
//! there is and how much of it is seen; [`avpm`] turns both into a budget and [`frco`] the budget into a
//! [`rate::ShadingRate`], for which [`fixed_foveation`] is the baseline; [`schedule`] says which parts are rendered
//! anew, [`chroma`] how much colour the eye resolves. [`plan`] holds the answer for one frame, and [`presets`]
//! are the settings that people choose; [`gate`] judges by what frames cost whether a technique pays. Where a device has
//! no shading rates, [`mask`] says which blocks are skipped. [`reuse`] names the parts of a picture that are not rendered at all. [`color`] says how colours are coded, [`image`] how pictures
//! are kept, and [`kernels`] are the CPU references of what the layer does on the GPU, with parameters laid out as
//! [`layout`] states.

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
pub mod presets;
mod range;
pub mod rate;
pub mod reuse;
pub mod schedule;
