//! Mesa's real drivers on machines without a GPU, over Mesa's no-op kernel shims (Debian's package `mesa-drm-shim`).
//!
//! A shim fakes the kernel's device: the driver creates devices, compiles pipelines and records command buffers as on a
//! real GPU. Submissions execute nothing: fences and timeline semaphores signal at once, images stay as they were,
//! queries never become available. `cargo dev setup` unpacks the drivers below the target folder.

mod shim;

pub use shim::{Folder, ShimDevice};
