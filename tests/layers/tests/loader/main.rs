//! The layers under the machine's own Vulkan loader, driver and validation layer.
//!
//! A layer is chosen by environment variables, so every program runs in a process of its own: this binary starts
//! itself for one of the ignored tests of [`programs`].

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod count;
mod device;
mod drop_barrier;
mod parafovea;
mod process;
mod programs;
mod shading_rate;
mod validation;
