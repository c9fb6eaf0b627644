//! Unmodified engines on a real runtime: Debian sid's Godot and Qt Quick 3D XR on Monado and lavapipe, without the layer and with it.
//!
//! `cargo dev engines` unpacks the [`System`]. An engine renders a scene of ours (`tests/engines`), heavy in fragment shading, with the head
//! held still. Each [`Engine`] has timed turns (without the layer, with the gate deciding, and with it open, one after the other), counted runs,
//! runs whose pictures are saved, and validated runs; a [`Finding`] is their result for one gate. Some engines have a light scene, a flat one
//! without anything to gain, an eye tracker, MangoHud and vkBasalt beside the layer, or another preset.

mod engine;
mod finding;
mod pictures;
mod rates;
mod seen;
mod system;

pub use engine::{Engine, Mode, Settings};
pub use finding::{Checks, Finding, judge, print_table};
pub use pictures::Errors;
pub use system::System;
