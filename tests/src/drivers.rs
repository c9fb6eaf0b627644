//! Mesa's real drivers on machines without a GPU, over Mesa's no-op kernel shims (Debian's package `mesa-drm-shim`), and a
//! matrix of programs, stacks of layers and configurations on them.
//!
//! A shim fakes the kernel's device: the driver creates devices, compiles pipelines and records command buffers as on a
//! real GPU. Submissions execute nothing: fences and timeline semaphores signal at once, images stay as they were,
//! queries never become available. `cargo dev setup` unpacks the drivers below the target folder.
//!
//! [`ShimDevice`] puts a program on such a device. A [`Row`] is one [`Program`] on one [`Target`]: [`judge`] runs it
//! without the layer and then in each of its [`Cell`]s, and compares; [`Matrix`] makes many rows, and a table of them.

mod cell;
pub mod direct3d;
pub mod kernels;
mod matrix;
pub mod profiles;
mod program;
mod quick3d;
mod row;
mod shim;
mod target;
mod warm;

pub use cell::{Cell, End, Engaged, Mode, Seen, Stack};
pub use matrix::Matrix;
pub use program::Program;
pub use row::{JsonCell, Row, cells, judge};
pub use shim::{Folder, ShimDevice};
pub use target::Target;
pub use warm::{Warmth, warmth};
