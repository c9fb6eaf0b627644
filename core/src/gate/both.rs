//! Both techniques together.

use super::{Gate, GateFrame, GateMode};
use crate::gaze::GazePhase;

/// One value for each technique that a gate judges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Techniques<T> {
    /// Shading rates.
    pub rates: T,
    /// Re-use of earlier pictures.
    pub reuse: T,
}

/// A frame that was rendered, as [`GateFrame`], for both techniques.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedFrame {
    /// [`GateFrame::time_ns`].
    pub time_ns: i64,
    /// [`GateFrame::cost_ns`].
    pub cost_ns: Option<u64>,
    /// Which techniques were at work in that frame.
    pub was_on: Techniques<bool>,
    /// [`GateFrame::phase`].
    pub phase: GazePhase,
    /// [`GateFrame::passes`].
    pub passes: Option<u32>,
    /// [`GateFrame::waited`].
    pub waited: bool,
}

/// A gate for each technique. While one has a trial the other stays, and frames count for one alone: a difference is
/// always that of one technique, with the other at its stand.
#[derive(Clone, Debug)]
pub struct Gates {
    gates: Techniques<Gate>,
}

impl Gates {
    /// Gates that have seen nothing. One of a technique that is not configured is [`GateMode::Off`].
    pub fn new(mode: Techniques<GateMode>) -> Self {
        Self { gates: Techniques { rates: Gate::new(mode.rates), reuse: Gate::new(mode.reuse) } }
    }

    /// The gates, for people.
    pub fn gates(&self) -> &Techniques<Gate> {
        &self.gates
    }

    /// Changes who decides.
    pub fn set_mode(&mut self, mode: Techniques<GateMode>) {
        self.gates.rates.set_mode(mode.rates);
        self.gates.reuse.set_mode(mode.reuse);
    }

    /// Takes a frame that was rendered; says which techniques are to be at work in the next.
    pub fn frame(&mut self, frame: &JudgedFrame) -> Techniques<bool> {
        let Techniques { rates, reuse } = &mut self.gates;
        let [rates_tries, reuse_tries] = [rates.is_trying(), reuse.is_trying()];
        let seen = |was_on, other_was_on, other: &Gate| GateFrame {
            time_ns: frame.time_ns,
            cost_ns: frame.cost_ns.filter(|_| !other.is_trying() && other_was_on == other.is_kept()),
            was_on,
            phase: frame.phase,
            passes: frame.passes,
            waited: frame.waited,
        };
        let Techniques { rates: rates_on, reuse: reuse_on } = frame.was_on;
        let rates_frame = seen(rates_on, reuse_on, reuse);
        let reuse_frame = seen(reuse_on, rates_on, rates);
        let on = rates.frame(&rates_frame, !reuse_tries);
        Techniques { rates: on, reuse: reuse.frame(&reuse_frame, !rates_tries && !rates.is_trying()) }
    }
}
