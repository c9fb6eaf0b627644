//! Synthetic gaze with known truth, a simulated eye tracker, and the accuracy of the region at full rate:
//! [`GazeTracker`](parafovea_core::gaze::GazeTracker) beside an unfiltered tracker and the One Euro filter.
//!
//! All of it is made from seeds. [`TUNING_SEEDS`] may be used to choose parameters (of both filters); reported figures come
//! from [`SEEDS`].

mod baselines;
mod path;
mod random;
mod region;
mod report;
mod score;
mod tracker;

pub use baselines::{OneEuro, TUNED};
pub use path::{Event, EyePath, HALF_IPD_M, Look};
pub use random::Random;
pub use region::{Region, union_area_deg2};
pub use report::{Row, rows, table};
pub use score::{Follower, Method, Radius, Score, follow, foveal_radii_deg};
pub use tracker::{LATENCY_S, Report, TrackerErrors, TrackerModel, nanoseconds};

/// Seeds of the reported runs.
pub const SEEDS: [u64; 5] = [7, 19, 42, 77, 105];

/// Seeds on which parameters were chosen.
pub const TUNING_SEEDS: [u64; 3] = [1001, 1002, 1003];

/// Length of the gaze of one seed, seconds.
pub const DURATION_S: f64 = 120.0;
