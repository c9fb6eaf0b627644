//! Frame graphs as engines and games draw them, as the events that recognition learns from. Each pass has its truth:
//! an eye buffer, a texture, a full-screen pass. They run without a GPU, in milliseconds.
//!
//! `cargo dev bench recognition` prints precision and recall of every graph, and of random ones.

pub mod crowd;
mod engines;
mod frame;
mod graphs;
pub mod random;
mod score;
mod step;
mod textures;

pub use frame::{Arrangement, Frame, Image, Seen, World};
pub use graphs::{GRAPHS, Graph};
pub use score::{Score, feedback, run};
pub use step::{Step, Truth};
pub use textures::Texture;
