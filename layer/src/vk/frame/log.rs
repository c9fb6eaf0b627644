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
    /// Passes that got the plan's rates, in the frame under way and in the last.
    with_rates: [u32; 2],
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

    /// A pass that is submitted has the plan's rates.
    pub fn has_rates(&mut self) {
        self.with_rates[0] = self.with_rates[0].saturating_add(1);
    }

    /// How many passes had the plan's rates in the last frame.
    pub fn with_rates(&self) -> u32 {
        self.with_rates[1]
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
        self.with_rates = [0, self.with_rates[0]];
    }
}
