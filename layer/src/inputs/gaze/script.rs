//! A gaze in a file: recorded, or written by hand.
//!
//! A line is `seconds,left,up`: degrees from the centre of the view to the left and upwards, in the space of the head. Seconds alone mean
//! that the eyes are not tracked until the next line. Between two lines the gaze moves evenly; before the first line and after the last one
//! it is as in that line. Text after `#` is a comment.

use super::{degrees, direction};
use glam::Vec3;
use std::fmt;
use std::str::FromStr;

/// The gaze of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct GazeScript {
    lines: Vec<Line>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    seconds: f64,
    /// To the left, upwards; `None` if the eyes are not tracked.
    degrees: Option<[f32; 2]>,
}

/// Reason why a text is not a recording of the gaze.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GazeScriptError {
    /// A line that cannot be parsed.
    #[error("line {0}: expected seconds, or seconds, degrees left and degrees up, separated by commas")]
    Line(usize),
    /// Times that go back.
    #[error("line {0}: its time is earlier than the previous line's")]
    Order(usize),
    /// No line at all.
    #[error("the file has no gaze sample")]
    Empty,
}

impl FromStr for GazeScript {
    type Err = GazeScriptError;

    fn from_str(text: &str) -> Result<Self, GazeScriptError> {
        let mut lines: Vec<Line> = Vec::new();
        for (number, text) in (1..).zip(text.lines()) {
            let text = text.split('#').next().unwrap_or_default().trim();
            if text.is_empty() {
                continue;
            }
            let line = Line::read(text).ok_or(GazeScriptError::Line(number))?;
            if lines.last().is_some_and(|before| line.seconds < before.seconds) {
                return Err(GazeScriptError::Order(number));
            }
            lines.push(line);
        }
        if lines.is_empty() { Err(GazeScriptError::Empty) } else { Ok(Self { lines }) }
    }
}

impl GazeScript {
    /// Direction of the gaze after so many seconds, a unit vector; `None` if the eyes are not tracked then.
    pub fn at(&self, seconds: f64) -> Option<Vec3> {
        let next = self.lines.partition_point(|line| line.seconds <= seconds);
        let from = self.lines.get(next.saturating_sub(1))?;
        let start = from.degrees?;
        // The gaze does not move towards an untracked position.
        let to = self.lines.get(next).unwrap_or(from);
        let end = to.degrees.unwrap_or(start);
        let span = to.seconds - from.seconds;
        let part = if span > 0.0 { ((seconds - from.seconds) / span).clamp(0.0, 1.0) as f32 } else { 0.0 };
        Some(direction([0, 1].map(|axis| start[axis] + (end[axis] - start[axis]) * part)))
    }
}

impl Line {
    fn read(text: &str) -> Option<Self> {
        let mut fields = text.split(',').map(str::trim);
        let seconds: f64 = fields.next()?.parse().ok()?;
        let degrees = match (fields.next(), fields.next(), fields.next()) {
            (None, ..) => None,
            (Some(left), Some(up), None) => Some([left.parse().ok()?, up.parse().ok()?]),
            _ => return None,
        };
        let is_finite = seconds.is_finite() && degrees.iter().flatten().all(|angle: &f32| angle.is_finite());
        is_finite.then_some(Self { seconds, degrees })
    }
}

/// One line of a file, as [`GazeScript`] reads it.
#[derive(Clone, Copy, Debug)]
pub struct GazeLine {
    /// Seconds since the first.
    pub seconds: f64,
    /// Direction of the gaze, of any length but 0; `None` if the eyes were not tracked.
    pub direction: Option<Vec3>,
}

impl fmt::Display for GazeLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.6}", self.seconds)?;
        match self.direction {
            None => Ok(()),
            Some(direction) => {
                let [left, up] = degrees(direction);
                write!(f, ",{left},{up}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    proptest::proptest! {
        #[test]
        fn any_text_is_a_gaze_or_refused(text in "([-0-9.,e#\n ]|nan|inf|\u{0}){0,60}", seconds: f64) {
            if let Ok(script) = text.parse::<GazeScript>() {
                let look = script.at(seconds);
                proptest::prop_assert!(look.is_none_or(|look| (look.length() - 1.0).abs() < 1e-3), "{look:?}");
            }
        }
    }

    fn script(text: &str) -> GazeScript {
        text.parse().unwrap()
    }

    #[test]
    fn moves_evenly_jumps_and_is_not_seen() {
        let script = script("# by hand\n0,0,0\n1, 10, 5 # there\n1,-20,0\n2\n3,0,30\n");
        let left_up = |seconds| script.at(seconds).map(degrees);
        let near = |seconds, expected: [f32; 2]| {
            let seen = left_up(seconds).unwrap();
            assert!(seen.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3), "{seconds}: {seen:?}");
        };
        near(-1.0, [0.0, 0.0]);
        near(0.5, [5.0, 2.5]);
        near(1.0, [-20.0, 0.0]);
        near(1.9, [-20.0, 0.0]);
        assert_eq!((left_up(2.0), left_up(2.9)), (None, None));
        near(3.0, [0.0, 30.0]);
        near(100.0, [0.0, 30.0]);
    }

    #[test]
    fn invalid_lines_are_refused_with_their_number() {
        let error = |text: &str| text.parse::<GazeScript>().unwrap_err();
        assert_eq!(error("# nothing\n\n"), GazeScriptError::Empty);
        for wrong in ["x", "0,1", "0,1,2,3", "0,a,1", "nan,0,0", "0,inf,0", "0,,"] {
            assert_eq!(error(&format!("0,0,0\n{wrong}")), GazeScriptError::Line(2), "{wrong}");
        }
        assert_eq!(error("1,0,0\n0.5,0,0"), GazeScriptError::Order(2));
    }

    #[test]
    fn a_written_gaze_is_read_back() {
        let looks =
            [Some(Vec3::NEG_Z), None, Some(Vec3::new(0.3, -0.2, -1.0)), Some(Vec3::new(-0.9, 0.5, -0.7))];
        let lines = looks.iter().zip(0..);
        let text: String = lines
            .map(|(&direction, at)| format!("{}\n", GazeLine { seconds: f64::from(at) * 0.25, direction }))
            .collect();
        let script = script(&text);
        for (look, at) in looks.iter().zip(0..) {
            let read = script.at(f64::from(at) * 0.25);
            assert_eq!(look.is_some(), read.is_some());
            if let (Some(look), Some(read)) = (look, read) {
                assert!(look.normalize().abs_diff_eq(read, 1e-6), "{look} {read}");
            }
        }
    }
}
