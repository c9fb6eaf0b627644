//! Loudness after BS.1770-4 and the mel feature after paper A Eq. 2-6, without a library.

mod loudness;
mod mel;

pub use loudness::{Energies, K_WEIGHTING_48_KHZ};
pub use mel::{mean_mel, mel};
