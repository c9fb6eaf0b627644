//! Running real applications through the real loaders, with and without the layer, and judging the result.
//!
//! From the outside in: [`demo`], [`engines`], [`monado`], [`overhead`], [`break_even`] and [`native`] are the programs for people; [`run::Run`]
//! starts one application with a [`scenario::Scenario`] for the mock runtime in an environment of its own ([`installation`]), from the libraries and
//! programs that cargo built ([`artifacts`]); its results are a [`record::Record`] and [`picture::Picture`]s, which [`compare`] compares.

pub mod artifacts;
pub mod break_even;
pub mod churn;
pub mod compare;
pub mod demo;
pub mod detail;
pub mod device;
pub mod dist;
pub mod drivers;
pub mod engines;
pub mod error;
pub mod frame_graphs;
pub mod installation;
pub mod measure;
pub mod monado;
pub mod native;
pub mod openxr_loader;
pub mod osc;
pub mod overhead;
pub mod picture;
pub mod planted;
pub mod progress;
pub mod record;
pub mod run;
pub mod scenario;

pub use error::HarnessError;
