//! What the application `parafovea-cases` draws and reports, for the tests that judge its runs.

pub mod pattern;
pub mod report;
