//! Precision and recall of recognition.

use crate::frame_graphs::frame::{Seen, World};
use crate::frame_graphs::graphs::Graph;
use crate::frame_graphs::step::Truth;
use parafovea::pass_detection::{Eye, Eyes, Feedback, Match};
use std::collections::BTreeSet;
use std::ops::AddAssign;
use std::time::Duration;

/// From this frame of a graph on, or after a switch, its eyes count as missed where they are not recognised.
pub const SETTLED: u64 = 10;

/// Counts of right and wrong verdicts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Score {
    /// Passes of eyes that were recognised, from [`SETTLED`] on.
    pub eyes: u64,
    /// Passes of eyes that were not, from [`SETTLED`] on.
    pub missed: u64,
    /// Of all frames: passes that were taken for an eye, rightly.
    pub right: u64,
    /// Of all frames: passes that were taken for an eye and are none, or the other eye's.
    pub wrong: u64,
    /// Full-screen passes that shade nothing, from [`SETTLED`] on.
    pub full_screen: u64,
    /// Number of these that were to become coarse.
    pub coarse_full_screen: u64,
    /// The names of passes that were wrong.
    pub wrong_names: BTreeSet<&'static str>,
    /// The names of passes that were missed, with the reason.
    pub missed_names: BTreeSet<String>,
    /// Median time of recognition at the end of a frame; of several graphs, the longest.
    pub per_frame: Duration,
}

impl Score {
    /// The share of eyes among passes that were taken for one.
    pub fn precision(&self) -> f64 {
        share(self.right, self.wrong)
    }

    /// Of the passes of eyes, the share that was recognised.
    pub fn recall(&self) -> f64 {
        share(self.eyes, self.missed)
    }

    /// Of the full-screen passes, the share that stays at 1x1.
    pub fn full_screen_kept(&self) -> f64 {
        share(self.full_screen - self.coarse_full_screen, self.coarse_full_screen)
    }

    /// Counts a pass, so many frames after the graph began.
    pub fn count(&mut self, seen: &Seen, since: u64) {
        let is_settled = since >= SETTLED;
        match (seen.truth, &seen.outcome) {
            (Truth::Eye(eye) | Truth::Shading(eye), Ok(found)) => {
                if is_of(found, eye) {
                    self.right += 1;
                    self.eyes += u64::from(is_settled);
                } else {
                    self.wrong += 1;
                    self.missed += u64::from(is_settled);
                    self.wrong_names.insert(seen.name);
                }
            }
            (Truth::Eye(_) | Truth::Shading(_), Err(reason)) => {
                // A pass without colours to be made coarser is left alone, whose ever it is.
                let is_left_alone = matches!(
                    reason,
                    parafovea::pass_detection::Unmatched::NoColour
                        | parafovea::pass_detection::Unmatched::Format(_)
                );
                if is_settled && !is_left_alone {
                    self.missed += 1;
                    self.missed_names.insert(format!("{}: {reason}", seen.name));
                }
            }
            (Truth::FullScreen, outcome) => {
                self.full_screen += u64::from(is_settled);
                self.coarse_full_screen += u64::from(is_settled && outcome.is_ok());
            }
            (Truth::Texture | Truth::Ambiguous, Ok(_)) => {
                self.wrong += 1;
                self.wrong_names.insert(seen.name);
            }
            (Truth::Texture | Truth::Ambiguous, Err(_)) => {}
        }
    }
}

impl AddAssign<&Score> for Score {
    fn add_assign(&mut self, more: &Score) {
        self.eyes += more.eyes;
        self.missed += more.missed;
        self.right += more.right;
        self.wrong += more.wrong;
        self.full_screen += more.full_screen;
        self.coarse_full_screen += more.coarse_full_screen;
        self.wrong_names.extend(&more.wrong_names);
        self.missed_names.extend(more.missed_names.iter().cloned());
        self.per_frame = self.per_frame.max(more.per_frame);
    }
}

/// 1 where there is nothing.
fn share(of: u64, rest: u64) -> f64 {
    if of + rest == 0 { 1.0 } else { of as f64 / (of + rest) as f64 }
}

/// Whether a match has the rates of this eye, or of both.
fn is_of(found: &Match, eye: Option<Eye>) -> bool {
    let has = |eyes| found.parts.iter().any(|part| part.eyes == eyes || part.eyes == Eyes::Finer);
    match eye {
        Some(Eye::Left) => has(Eyes::Left),
        Some(Eye::Right) => has(Eyes::Right),
        None => has(Eyes::Left) && has(Eyes::Right),
    }
}

/// Draws all frames of a graph.
fn drawn(graph: &Graph) -> World {
    let mut world = World::default();
    for number in 0..graph.frames() {
        let scale = graph.scale(number);
        world.frame(graph.eye, graph.arrangement, scale, graph.is_bindless, |frame| graph.draw(frame));
    }
    world
}

/// Whether the image of a graph is made from images of earlier frames, by recognition at its end.
pub fn feedback(graph: &Graph) -> Feedback {
    drawn(graph).feedback()
}

/// Recognises the passes of all frames of a graph.
pub fn run(graph: &Graph) -> Score {
    let mut world = drawn(graph);
    let mut score = Score::default();
    for seen in &world.seen {
        score.count(seen, seen.frame % Graph::FRAMES);
    }
    world.spent.sort();
    score.per_frame = world.spent[world.spent.len() / 2];
    score
}
