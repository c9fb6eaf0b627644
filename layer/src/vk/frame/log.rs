//! What the application did since the last frame ended, and recognition, which learns from it.

use crate::scene::{Event, Match, Pass, Recognition, Unmatched};
use crate::vk::objects::Objects;

/// An application that does more than this in a frame, or shows no frames, is not followed further.
const MOST_EVENTS: usize = 16_384;

/// One frame's events, in the order of their submits.
#[derive(Default)]
pub struct Log {
    frame: u64,
    events: Vec<Event>,
    recognition: Recognition,
}

impl Log {
    /// Number of the frame under way.
    pub fn frame(&self) -> u64 {
        self.frame
    }

    /// What a pass is that is about to be submitted.
    pub fn recognise(&self, objects: &Objects, pass: &Pass) -> Result<Match, Unmatched> {
        self.recognition.of(pass, &self.events, |key| objects.describe(key))
    }

    /// Notes what is submitted.
    pub fn push(&mut self, event: &Event) {
        if self.events.len() < MOST_EVENTS {
            self.events.push(event.clone());
        }
    }

    /// Learns from the frame, and begins the next one.
    pub fn end_frame(&mut self, objects: &Objects, shown: &crate::scene::Shown) {
        self.recognition.frame(&self.events, |key| objects.describe(key), shown);
        self.recognition.news(|line| tracing::info!("{line}"));
        self.events.clear();
        objects.forget_departed();
        self.frame += 1;
    }
}
