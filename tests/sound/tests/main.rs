//! Sound capture of applications from a real sound server, with faults of all kinds.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod accuracy;
mod faults;
mod libraries;
mod limits;
mod pipewire;
mod silence;
mod soak;
mod wav;
