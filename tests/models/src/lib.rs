//! What the models of `parafovea-core` are held against: [`mod@reference`]s in double precision, the papers' numbers
//! ([`checks`]), synthetic [`eyes`] with known truth, and a table of [`hard_cases`]. [`audio_visual`] is what sound saves on pictures, [`room`] the example of `core/README.md`,
//! [`debug_views`] the pictures of `manifest/HOW-IT-WORKS.md`. The benches of the models are in
//! `benches/`.

pub mod audio_visual;
pub mod checks;
pub mod debug_views;
pub mod eyes;
pub mod hard_cases;
pub mod rails;
pub mod reference;
pub mod room;
