//! What applications hear of a real sound server, whatever happens to it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod accuracy;
mod faults;
mod libraries;
mod limits;
mod pipewire;
mod silence;
mod soak;
mod wav;
