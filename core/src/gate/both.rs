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

/// A rendered frame, as [`GateFrame`], for both techniques.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredFrame {
    /// [`GateFrame::time_ns`].
    pub time_ns: i64,
    /// [`GateFrame::cost_ns`].
    pub cost_ns: Option<u64>,
    /// Techniques that were on in that frame.
    pub was_on: Techniques<bool>,
    /// [`GateFrame::phase`].
    pub phase: GazePhase,
    /// [`GateFrame::passes`].
    pub passes: Option<u32>,
    /// [`GateFrame::pixels`].
    pub pixels: u32,
}

/// A gate for each technique. Only one of them has a trial at a time, so that a difference in cost is always that of one technique.
#[derive(Clone, Debug)]
pub struct Gates {
    gates: Techniques<Gate>,
}

impl Gates {
    /// Gates before the first frame, with [`GateMode::Off`] for a technique that is not configured.
    pub fn new(mode: Techniques<GateMode>) -> Self {
        Self { gates: Techniques { rates: Gate::new(mode.rates), reuse: Gate::new(mode.reuse) } }
    }

    /// The gates, for reports.
    pub fn gates(&self) -> &Techniques<Gate> {
        &self.gates
    }

    /// [`Gate::rests_ns`] of both.
    pub fn rests_ns(&self, now: i64) -> i64 {
        self.gates.rates.rests_ns(now).min(self.gates.reuse.rests_ns(now))
    }

    /// Changes the source of each decision. A technique that comes or goes by it ends a trial of the other one, whose frames would cost
    /// more or less from then on.
    pub fn set_mode(&mut self, mode: Techniques<GateMode>) {
        let Techniques { rates, reuse } = &mut self.gates;
        let were_kept = [rates.is_kept(), reuse.is_kept()];
        rates.set_mode(mode.rates);
        reuse.set_mode(mode.reuse);
        if reuse.is_kept() != were_kept[1] {
            rates.drop_trial();
        }
        if rates.is_kept() != were_kept[0] {
            reuse.drop_trial();
        }
    }

    /// [`Gate::forget_decisions`] of both.
    pub fn forget_decisions(&mut self) {
        self.gates.rates.forget_decisions();
        self.gates.reuse.forget_decisions();
    }

    /// Records a rendered frame, and returns the techniques that are on in the next one.
    pub fn frame(&mut self, frame: &MeasuredFrame) -> Techniques<bool> {
        let Techniques { rates, reuse } = &mut self.gates;
        let [rates_has_trial, reuse_has_trial] = [rates.has_trial(), reuse.has_trial()];
        let seen = |was_on, other_was_on, other: &Gate| GateFrame {
            time_ns: frame.time_ns,
            cost_ns: frame.cost_ns.filter(|_| !other.has_trial() && other_was_on == other.is_kept()),
            was_on,
            phase: frame.phase,
            passes: frame.passes,
            pixels: frame.pixels,
        };
        let Techniques { rates: rates_on, reuse: reuse_on } = frame.was_on;
        let rates_frame = seen(rates_on, reuse_on, reuse);
        let reuse_frame = seen(reuse_on, rates_on, rates);
        let on = rates.frame(&rates_frame, !reuse_has_trial);
        Techniques { rates: on, reuse: reuse.frame(&reuse_frame, !rates_has_trial && !rates.has_trial()) }
    }
}
