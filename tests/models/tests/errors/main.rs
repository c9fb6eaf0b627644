//! Known degradations of a moving picture, in the ring that they concern; and figures of others.

#![expect(clippy::unwrap_used, reason = "a test says where it failed")]

mod age;
mod degradation;
mod fvvdp;
mod report;
mod ring;
mod scene;
