//! What the application `parafovea-cases` draws and reports, for the tests that judge its runs.

pub mod life;
pub mod pattern;
pub mod report;
