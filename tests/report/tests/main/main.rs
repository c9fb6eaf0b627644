//! Content of the report, in files that can be read.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod jod;
mod made_up;
mod measured;
mod plans;
mod verdicts;
mod written;
