//! Whether rates pay: what frames cost goes to the gate of the models, and its answer to the Vulkan half.

use crate::inputs::cost::{CpuCost, Late};
use crate::link::FrameTimeRecord;
use parafovea_core::gate::{Gate, GateFrame, GateMode};
use parafovea_core::gaze::GazePhase;

/// A frame that ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndedFrame {
    /// When it is shown, nanoseconds.
    pub time_ns: i64,
    /// How it is known what it costs.
    pub clock: Clock,
    /// Whether the Vulkan half was told to give rates to what it recognises.
    pub wanted_rates: bool,
    /// How many passes it gave rates to.
    pub passes: u32,
    /// What the eyes do.
    pub phase: GazePhase,
}

/// How it is known what a frame costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// A CPU renders: CPU time that the process has spent so far, nanoseconds, if that is known.
    Cpu(Option<u64>),
    /// A GPU renders, and tells later: the frame's number in [`FrameTimeRecord::frame`].
    Gpu(u64),
}

/// Judges whether rates pay in a session.
#[derive(Clone, Debug)]
pub struct Benefit {
    gate: Gate,
    cpu: CpuCost,
    late: Late<EndedFrame>,
    /// Passes with rates in the last frame that had any.
    passes: u32,
}

impl Default for Benefit {
    fn default() -> Self {
        Self { gate: Gate::new(GateMode::Auto), cpu: CpuCost::default(), late: Late::default(), passes: 0 }
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

    /// Takes a frame that ended, and what `times` say of it and of earlier ones; returns what people should know, where the gate
    /// changed its mind.
    pub fn frame_ended(&mut self, frame: &EndedFrame, times: &[FrameTimeRecord]) -> Option<String> {
        let was_kept = self.gate.is_kept();
        match frame.clock {
            Clock::Cpu(reading) => {
                let cost_ns = self.cpu.frame_ended(reading);
                self.judge(frame, cost_ns, frame);
            }
            Clock::Gpu(number) => {
                if let Some(given_up) = self.late.push(number, *frame) {
                    self.judge(&given_up, None, frame);
                }
                for time in times {
                    while let Some((late, is_this)) = self.late.pop_until(time.frame) {
                        self.judge(&late, is_this.then_some(time.ns), frame);
                    }
                }
            }
        }
        (self.gate.is_kept() != was_kept).then(|| self.news()).flatten()
    }

    /// Gives a frame to the gate, while `now` ends.
    ///
    /// The number of passes with rates tells a scene from another: which images they draw to changes from frame to frame
    /// in many applications, and with dynamic resolution their sizes do.
    fn judge(&mut self, frame: &EndedFrame, cost_ns: Option<u64>, now: &EndedFrame) {
        let was_on = frame.wanted_rates && frame.passes > 0;
        let scene_changed = was_on && frame.passes != self.passes;
        if was_on {
            self.passes = frame.passes;
        }
        self.gate.frame(
            &GateFrame {
                time_ns: now.time_ns,
                cost_ns,
                was_on,
                phase: now.phase,
                scene_changed,
                // Time spent has no waiting in it, whatever the frame waits for.
                waited: false,
            },
            true,
        );
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
            let frame = EndedFrame {
                time_ns: clock.0,
                clock: Clock::Cpu(Some(clock.1)),
                wanted_rates: on,
                passes: if on { passes } else { 0 },
                phase: GazePhase::Fixation,
            };
            benefit.frame_ended(&frame, &[])
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
            for clock in [Clock::Cpu(None), Clock::Gpu(time_ns as u64)] {
                let frame = EndedFrame { time_ns, clock, wanted_rates: true, passes: 2, phase };
                assert_eq!((benefit.frame_ended(&frame, &[]), benefit.is_on()), (None, true));
            }
        }
    }

    /// Times of a GPU come two frames late, and of every seventh frame never.
    #[test]
    fn times_of_a_gpu_are_those_of_their_frames() {
        for (ratio, is_kept) in [(1.3, false), (0.6, true)] {
            let mut benefit = Benefit::default();
            let (mut was_on, mut said) = (Vec::new(), Vec::new());
            for number in 0..400_u64 {
                let on = benefit.is_on();
                was_on.push(on);
                let frame = EndedFrame {
                    time_ns: number as i64 * 11_111_111,
                    clock: Clock::Gpu(number),
                    wanted_rates: on,
                    passes: if on { 2 } else { 0 },
                    phase: GazePhase::Fixation,
                };
                let known = number.checked_sub(2).filter(|frame| frame % 7 != 3);
                let time = known.map(|frame| {
                    let ms = 5.0 + 0.05 * (frame % 5) as f64;
                    let ratio = if was_on[frame as usize] { ratio } else { 1.0 };
                    FrameTimeRecord { frame, ns: (1e6 * ms * ratio) as u64 }
                });
                said.extend(benefit.frame_ended(&frame, time.as_slice()));
            }
            assert_eq!(benefit.gate.is_kept(), is_kept, "{ratio}: {said:?}");
            let (found, _) = benefit.gate.evidence().ratio().unwrap();
            assert!((found / ratio - 1.0).abs() < 0.02, "{found}, not {ratio}");
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
