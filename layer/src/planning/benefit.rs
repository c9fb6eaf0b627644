//! Whether rates pay: what frames cost goes to the gate of the models, and its answer to the Vulkan half.

use crate::inputs::cost::CpuCost;
use parafovea_core::gate::{Gate, GateFrame, GateMode};
use parafovea_core::gaze::GazePhase;

/// A frame that ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndedFrame {
    /// When it is shown, nanoseconds.
    pub time_ns: i64,
    /// CPU time that the process has spent so far, nanoseconds; none where the device is no CPU.
    pub process_cpu_ns: Option<u64>,
    /// Whether the Vulkan half was told to give rates to what it recognises.
    pub wanted_rates: bool,
    /// How many passes it gave rates to.
    pub passes: u32,
    /// What the eyes do.
    pub phase: GazePhase,
}

/// Judges whether rates pay in a session.
#[derive(Clone, Debug)]
pub struct Benefit {
    gate: Gate,
    cost: CpuCost,
    /// Passes with rates in the last frame that had any.
    passes: u32,
}

impl Default for Benefit {
    fn default() -> Self {
        Self { gate: Gate::new(GateMode::Auto), cost: CpuCost::default(), passes: 0 }
    }
}

impl Benefit {
    /// Takes who decides.
    pub fn set_mode(&mut self, mode: GateMode) {
        self.gate.set_mode(mode);
    }

    /// Whether the next frame shall have rates.
    pub fn is_on(&self) -> bool {
        self.gate.is_on()
    }

    /// Takes a frame that ended; returns what people should know, where the gate changed its mind.
    ///
    /// The number of passes with rates tells a scene from another: which images they draw to changes from frame to frame
    /// in many applications, and with dynamic resolution their sizes do.
    pub fn frame_ended(&mut self, frame: &EndedFrame) -> Option<String> {
        let cost_ns = self.cost.frame_ended(frame.process_cpu_ns);
        let was_on = frame.wanted_rates && frame.passes > 0;
        let scene_changed = was_on && frame.passes != self.passes;
        if was_on {
            self.passes = frame.passes;
        }
        let was_kept = self.gate.is_kept();
        self.gate.frame(
            &GateFrame {
                time_ns: frame.time_ns,
                cost_ns,
                was_on,
                phase: frame.phase,
                scene_changed,
                // CPU time has no waiting in it, whatever the frame waits for.
                waited: false,
            },
            true,
        );
        (self.gate.is_kept() != was_kept).then(|| self.news()).flatten()
    }

    fn news(&self) -> Option<String> {
        let (ratio, [low, high]) = self.gate.evidence().ratio()?;
        let what = if self.gate.is_kept() {
            "shading rates are taken up again"
        } else {
            "shading rates are dropped"
        };
        Some(format!("{what}: frames cost {ratio:.2} ({low:.2} to {high:.2}) times as much with them"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs frames of which those with rates cost `ratio` times 10 ms, and returns what was said.
    fn run(
        benefit: &mut Benefit,
        clock: &mut (i64, u64),
        frames: u32,
        passes: u32,
        ratio: f64,
    ) -> Vec<String> {
        let frame = |number| {
            let on = benefit.is_on();
            let jitter = 1.0 + 0.01 * f64::from(number % 7);
            clock.0 += 11_111_111;
            clock.1 += (1e7 * jitter * if on && passes > 0 { ratio } else { 1.0 }) as u64;
            benefit.frame_ended(&EndedFrame {
                time_ns: clock.0,
                process_cpu_ns: Some(clock.1),
                wanted_rates: on,
                passes: if on { passes } else { 0 },
                phase: GazePhase::Fixation,
            })
        };
        (0..frames).filter_map(frame).collect()
    }

    #[test]
    fn what_costs_more_is_dropped_and_another_scene_judged_anew() {
        let (mut benefit, mut clock) = (Benefit::default(), (0, 0));
        let said = run(&mut benefit, &mut clock, 200, 2, 1.3);
        assert_eq!((said.len(), benefit.is_on()), (1, false));
        assert!(said[0].starts_with("shading rates are dropped: frames cost 1.3"), "{}", said[0]);
        // A look half a minute later finds more passes, and that they pay.
        let said = run(&mut benefit, &mut clock, 40 * 90, 3, 0.6);
        assert_eq!((said.len(), benefit.is_on()), (1, true));
        assert!(said[0].contains("again: frames cost 0.6"), "{}", said[0]);
    }

    /// Without passes to judge, or without costs, rates stay wanted.
    #[test]
    fn nothing_known_changes_nothing() {
        let (mut benefit, mut clock) = (Benefit::default(), (0, 0));
        assert_eq!(run(&mut benefit, &mut clock, 1000, 0, 2.0), [""; 0]);
        for time_ns in 0..1000 {
            let phase = GazePhase::Saccade;
            let frame = EndedFrame { time_ns, process_cpu_ns: None, wanted_rates: true, passes: 2, phase };
            assert_eq!((benefit.frame_ended(&frame), benefit.is_on()), (None, true));
        }
    }

    #[test]
    fn what_is_set_holds() {
        let (mut benefit, mut clock) = (Benefit::default(), (0, 0));
        benefit.set_mode(GateMode::On);
        assert_eq!(run(&mut benefit, &mut clock, 500, 2, 3.0), [""; 0]);
        assert!(benefit.is_on());
        benefit.set_mode(GateMode::Off);
        assert!(!benefit.is_on());
    }
}
