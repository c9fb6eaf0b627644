//! In release builds: no file of passes. Such a file reveals the gaze.

use super::MapContent;
use crate::pass_detection::{Event, Match, Unmatched};
use crate::vk::objects::Objects;
use std::sync::Arc;

/// Keeps nothing.
#[derive(Default)]
pub struct Notes;

impl Notes {
    /// Never.
    pub fn is_wanted(&self) -> bool {
        false
    }

    /// Keeps nothing.
    pub fn push<C: MapContent>(&mut self, _: Option<&Result<Match, Unmatched>>, _: Option<&Arc<C>>) {}

    /// Writes nothing.
    pub fn end_frame(&mut self, _: &Objects, _: u64, _: &[Event]) {}
}
