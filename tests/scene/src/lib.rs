//! `parafovea-scene`: an OpenXR application as one would write it in Rust, with [`openxr`] and [`wgpu`].
//! It knows nothing of Parafovea. Tests, benches and the demo run it as the application to be made faster, so its
//! images are frozen; the crate's README describes this, and the cost of a frame.

pub mod camera;
pub mod offscreen;
pub mod openxr_toolkit;
pub mod options;
pub mod renderer;
pub mod scene;
pub mod script;
pub mod xr;
