//! Images and reports of the application `parafovea-cases`, for the tests that check its runs.

pub mod life;
pub mod pattern;
pub mod report;
