//! The C side of both halves: invariants of every function that a loader or an application calls.

pub mod audio_library;
pub mod copies;
pub mod cores;
pub mod cpu_time;
mod enablement;
mod executable;
pub mod guard;
pub mod local_time;
pub mod own_folder;
pub mod pnext;
pub mod threads;
pub mod time_slice;

pub use enablement::Enablement;
pub use executable::executable;
pub use guard::{Answer, attempt, guard};
