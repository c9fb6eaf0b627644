//! Checks of the models of `parafovea-core`: [`mod@reference`]s in double precision, the papers' numbers ([`checks`]), synthetic [`eyes`]
//! with known truth, and a table of [`hard_cases`]. [`avpm`] fits coefficients to a user study; [`chroma_report`] sums up chroma; [`audio_visual`] measures the saving of
//! sound on pictures; [`room`] is the example of `core/README.md`, and [`debug_views`] draws the pictures of `manifest/HOW-IT-WORKS.md`.
//! The benches of the models are in `benches/`.

pub mod audio_visual;
pub mod avpm;
pub mod checks;
pub mod chroma_report;
pub mod debug_views;
pub mod errors;
pub mod eyes;
pub mod hard_cases;
pub mod prediction;
pub mod reference;
pub mod room;
pub mod safety;
