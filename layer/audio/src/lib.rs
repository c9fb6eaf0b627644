//! Captures the system's sound: loudness and pitch of the last seconds, for the layer.
//!
//! A shared library of its own, so that ALSA's library is not in every game: the layer loads it when sound is asked for,
//! and finds its table ([`abi`]). A [`Capture`] has two threads. One takes samples from a [`sources`], and does nothing
//! else with them than to write them into a ring ([`ring`]); the other ([`analysis`]) computes features from them and
//! publishes those ([`published`]) for threads that must not wait.
//!
//! # Privacy
//! Samples are in the ring and in the windows of the features, nowhere else, and never in a file. Only sound that the system plays is
//! captured: never a microphone.

// Unsafe code stays within one module.
#![deny(unsafe_code)]

#[allow(unsafe_code)]
mod abi;
mod analysis;
pub mod capture;
mod messages;
mod published;
pub mod ring;
mod settings;
mod shared;
mod sources;
pub mod wav;

pub use capture::{Capture, CapturedFeatures};
pub use settings::{Settings, Source};
