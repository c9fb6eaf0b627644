//! The listing of passes, for the log: the verdict on each kind of pass.

use super::pass_history::PassSignature;
use crate::pass_detection::{Eyes, Match, Orientation, Unmatched};
use crate::status::Topic;
use smallvec::SmallVec;
use std::fmt;

/// Most lines: images recreated at every size of dynamic resolution would fill the log.
const MOST_LINES: usize = 100;

/// The listed verdicts.
#[derive(Debug, Default)]
pub(super) struct Listing {
    /// The last listed verdicts on passes of each signature.
    logged: Vec<(PassSignature, SmallVec<[Verdict; 2]>)>,
    lines: usize,
}

/// The verdict on a pass, without parts that change from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Verdict(Result<[Option<(Eyes, Orientation)>; 2], Unmatched>);

impl Verdict {
    fn new(outcome: &Result<Match, Unmatched>) -> Self {
        Self(outcome.as_ref().map_err(|reason| *reason).map(|found| {
            let mut parts = found.parts.iter().map(|part| (part.eyes, part.orientation));
            [parts.next(), parts.next()]
        }))
    }
}

impl Listing {
    /// Lists each pass with a verdict that none of its signature has had.
    pub(super) fn log_new_verdicts<'a>(
        &mut self,
        passes: impl Iterator<Item = (&'a PassSignature, &'a Result<Match, Unmatched>)>,
        mut log: impl FnMut(Topic, &dyn fmt::Display),
    ) {
        for (shape, outcome) in passes {
            if self.lines >= MOST_LINES {
                return;
            }
            let verdict = Verdict::new(outcome);
            let index = self.logged.iter().position(|(logged, _)| logged == shape).unwrap_or_else(|| {
                self.logged.push((*shape, SmallVec::new()));
                self.logged.len() - 1
            });
            let verdicts = &mut self.logged[index].1;
            if !verdicts.contains(&verdict) {
                verdicts.push(verdict);
                self.lines += 1;
                let topic = if outcome.is_ok() { Topic::Scene } else { Topic::OtherPass };
                log(topic, &Line { shape, outcome });
                if self.lines == MOST_LINES {
                    log(Topic::OtherPass, &"further passes are not listed");
                }
            }
        }
    }
}

struct Line<'a> {
    shape: &'a PassSignature,
    outcome: &'a Result<Match, Unmatched>,
}

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "pass {}: ", self.shape)?;
        match self.outcome {
            Err(reason) => write!(f, "not the scene: {reason}"),
            Ok(found) => {
                f.write_str("the scene: ")?;
                for (index, part) in found.parts.iter().enumerate() {
                    let separator = if index == 0 { "" } else { " and " };
                    let eyes = match part.eyes {
                        Eyes::Left => "left eye",
                        Eyes::Right => "right eye",
                        Eyes::Finer => "both eyes (finer rate)",
                    };
                    let way_up = match part.orientation {
                        Orientation::Upright => "",
                        Orientation::UpsideDown => ", upside-down",
                        Orientation::Unknown => ", unknown orientation",
                    };
                    write!(f, "{separator}{eyes}{way_up}")?;
                }
                write!(f, ": {}", found.how)
            }
        }
    }
}
