//! Sounds of known loudness ([`signals`]), played ([`player`]) into a real sound server without any sound card ([`server`], [`pipewire`]),
//! and the features in the plans of an application ([`feature_lines`], [`stage`]).

pub mod feature_lines;
pub mod lateness;
pub mod measure;
pub mod pipewire;
pub mod player;
pub mod server;
pub mod signals;
pub mod stage;
