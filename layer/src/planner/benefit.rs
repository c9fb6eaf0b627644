//! Benefit of rates and re-use: costs of frames go to the gates of the models, and their decisions to the Vulkan half.

use crate::inputs::cost::{CpuCost, GpuCost, Late, OwnWork};
use parafovea_core::gate::{Gate, GateMode, Gates, MeasuredFrame, Techniques, Verdict};
use parafovea_core::gaze::GazePhase;
use parafovea_manifest::status::effect;
use std::fmt;

/// A frame that ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndedFrame {
    /// Its display time, nanoseconds.
    pub time_ns: i64,
    /// The measure of its cost.
    pub clock: Clock,
    /// The techniques in the maps of recognised passes.
    pub wanted: Techniques<bool>,
    /// Number of passes that it gave maps to.
    pub passes: u32,
    /// Hash of the set of passes that it recognised as an eye buffer, with or without maps; 0: none.
    pub eye_passes: u32,
    /// Pixels of the largest picture of these passes; 0: none.
    pub eye_pixels: u32,
    /// The phase of the gaze.
    pub phase: GazePhase,
}

/// A measure of a frame's cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// A CPU renders: CPU time that the process has spent so far, nanoseconds, if that is known.
    Cpu(Option<u64>),
    /// A GPU renders, and the time is known later: the frame's number in [`GpuCost::frame`].
    Gpu(u64),
}

/// Decides whether rates and re-use save time in a session.
#[derive(Clone, Debug)]
pub struct Benefit {
    gates: Gates,
    cpu: CpuCost,
    late: Late<EndedFrame>,
    own: OwnShare,
    /// Whether any frame had maps.
    had_maps: bool,
}

/// Time on the GPU since a trial began, and our own part of it, nanoseconds.
#[derive(Clone, Copy, Debug, Default)]
struct OwnShare {
    ns: u64,
    own: OwnWork,
}

impl Default for Benefit {
    fn default() -> Self {
        let both = Techniques { rates: GateMode::Auto, reuse: GateMode::Auto };
        Self {
            gates: Gates::new(both),
            cpu: CpuCost::default(),
            late: Late::default(),
            own: OwnShare::default(),
            had_maps: false,
        }
    }
}

impl Benefit {
    /// Sets the modes of the gates.
    pub fn set_mode(&mut self, mode: Techniques<GateMode>) {
        self.gates.set_mode(mode);
    }

    /// Forgets the decisions of the gates: the techniques or their costs have changed.
    pub fn forget_decisions(&mut self) {
        self.gates.forget_decisions();
    }

    /// The techniques of the next frame.
    pub fn is_on(&self) -> Techniques<bool> {
        let Techniques { rates, reuse } = self.gates.gates();
        Techniques { rates: rates.is_on(), reuse: reuse.is_on() }
    }

    /// Whether any frame had maps so far.
    pub fn had_maps(&self) -> bool {
        self.had_maps
    }

    /// Whether a gate needs the costs of frames now.
    pub fn wants_costs(&self) -> bool {
        let Techniques { rates, reuse } = self.gates.gates();
        rates.wants_costs() || reuse.wants_costs()
    }

    /// Time from `now_ns` within which no trial can begin, nanoseconds.
    pub fn rests_ns(&self, now_ns: i64) -> i64 {
        self.gates.rests_ns(now_ns)
    }

    /// The gates, for people.
    pub fn gates(&self) -> &Gates {
        &self.gates
    }

    /// Takes a frame that ended, with `costs` of it and of earlier ones; returns a line for the log, where the gate changed its mind.
    pub fn frame_ended(&mut self, frame: &EndedFrame, costs: &[GpuCost]) -> Option<String> {
        let was_kept = self.is_kept();
        if !self.wants_costs() {
            self.own = OwnShare::default();
        }
        match frame.clock {
            Clock::Cpu(reading) => {
                let cost_ns = self.cpu.frame_ended(reading);
                self.judge(frame, cost_ns, frame);
            }
            Clock::Gpu(number) => {
                if let Some(given_up) = self.late.push(number, *frame) {
                    self.judge(&given_up, None, frame);
                }
                for cost in costs {
                    while let Some((late, is_this)) = self.late.pop_until(cost.frame) {
                        if is_this && late.passes > 0 {
                            self.own.add(cost);
                        }
                        self.judge(&late, is_this.then_some(cost.ns), frame);
                    }
                }
            }
        }
        let Techniques { rates, reuse } = self.gates.gates();
        let of_rates =
            (rates.is_kept() != was_kept.rates).then(|| verdict_line("shading rates", rates, &self.own));
        let of_reuse =
            || (reuse.is_kept() != was_kept.reuse).then(|| verdict_line("re-use", reuse, &self.own));
        of_rates.or_else(of_reuse).flatten()
    }

    fn is_kept(&self) -> Techniques<bool> {
        let Techniques { rates, reuse } = self.gates.gates();
        Techniques { rates: rates.is_kept(), reuse: reuse.is_kept() }
    }

    /// Gives a frame to the gates, while `now` ends.
    ///
    /// The set of eye passes distinguishes scenes.
    fn judge(&mut self, frame: &EndedFrame, cost_ns: Option<u64>, now: &EndedFrame) {
        let was = |wanted: bool| wanted && frame.passes > 0;
        let was_on = Techniques { rates: was(frame.wanted.rates), reuse: was(frame.wanted.reuse) };
        self.had_maps |= was_on.rates || was_on.reuse;
        self.gates.frame(&MeasuredFrame {
            time_ns: now.time_ns,
            cost_ns,
            was_on,
            phase: now.phase,
            passes: (frame.eye_passes > 0).then_some(frame.eye_passes),
            pixels: frame.eye_pixels,
        });
    }
}

impl OwnShare {
    fn add(&mut self, cost: &GpuCost) {
        self.ns = self.ns.saturating_add(cost.ns);
        let (own, more) = (&mut self.own, &cost.own);
        own.maps_ns = own.maps_ns.saturating_add(more.maps_ns);
        own.analysis_ns = own.analysis_ns.saturating_add(more.analysis_ns);
        own.pictures_ns = own.pictures_ns.saturating_add(more.pictures_ns);
    }
}

impl fmt::Display for OwnShare {
    /// Empty without GPU time.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.ns == 0 {
            return Ok(());
        }
        let OwnWork { maps_ns, analysis_ns, pictures_ns } = self.own;
        let [maps, analysis, pictures] =
            [maps_ns, analysis_ns, pictures_ns].map(|ns| 100.0 * ns as f64 / self.ns as f64);
        write!(
            f,
            "; the layer's own share of GPU time: {maps:.1} % for rates, {analysis:.1} % for contrast, {pictures:.1} % for images"
        )
    }
}

/// The log line of a gate that changed its verdict.
fn verdict_line(technique: &str, gate: &Gate, own: &OwnShare) -> Option<String> {
    let (ratio, [low, high]) = gate.evidence().ratio()?;
    let change = match (gate.is_kept(), gate.evidence().verdict()) {
        (true, _) => "resumed",
        (false, Verdict::Unclear) => "dropped, no clear saving",
        (false, _) => "dropped",
    };
    let effect = effect([ratio, low, high].map(|ratio| ratio as f32));
    Some(format!("{technique}: {change}: {effect}{own}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mode of rates, where nothing is re-used.
    fn of_rates(mode: GateMode) -> Techniques<GateMode> {
        Techniques { rates: mode, reuse: GateMode::Off }
    }

    fn judging_rates() -> Benefit {
        let mut benefit = Benefit::default();
        benefit.set_mode(of_rates(GateMode::Auto));
        benefit
    }

    /// Runs frames of which those with rates cost `ratio` times 10 ms, and returns the lines.
    fn run(
        benefit: &mut Benefit,
        clock: &mut (i64, u64),
        frames: u32,
        passes: u32,
        ratio: f64,
    ) -> Vec<String> {
        let frame = |number| {
            let on = benefit.is_on().rates;
            let jitter = 1.0 + 0.01 * f64::from(number % 7);
            clock.0 += 11_111_111;
            clock.1 += (1e7 * jitter * if on && passes > 0 { ratio } else { 1.0 }) as u64;
            let frame = EndedFrame {
                time_ns: clock.0,
                clock: Clock::Cpu(Some(clock.1)),
                wanted: benefit.is_on(),
                passes: if on { passes } else { 0 },
                eye_passes: passes,
                eye_pixels: 0,
                phase: GazePhase::Fixation,
            };
            benefit.frame_ended(&frame, &[])
        };
        (0..frames).filter_map(frame).collect()
    }

    #[test]
    fn a_slower_technique_is_dropped_and_a_new_scene_has_a_trial() {
        let (mut benefit, mut clock) = (judging_rates(), (0, 0));
        let said = run(&mut benefit, &mut clock, 200, 2, 1.3);
        assert_eq!((said.len(), benefit.is_on().rates), (1, false));
        assert!(said[0].starts_with("shading rates: dropped: a slowdown of 3"), "{}", said[0]);
        assert!(!benefit.wants_costs(), "until the next trial");
        // Another number of passes for ten seconds is another scene; a trial a minute after the first finds that it pays.
        let said = run(&mut benefit, &mut clock, 70 * 90, 3, 0.6);
        assert_eq!((said.len(), benefit.is_on().rates), (1, true));
        assert!(said[0].starts_with("shading rates: resumed: a saving of 40 %"), "{}", said[0]);
    }

    /// Without passes to judge, or without costs, rates stay wanted.
    #[test]
    fn nothing_known_changes_nothing() {
        let (mut benefit, mut clock) = (judging_rates(), (0, 0));
        assert_eq!(run(&mut benefit, &mut clock, 1000, 0, 2.0), [""; 0]);
        for time_ns in 0..1000 {
            let phase = GazePhase::Saccade;
            for clock in [Clock::Cpu(None), Clock::Gpu(time_ns as u64)] {
                let wanted = benefit.is_on();
                let frame =
                    EndedFrame { time_ns, clock, wanted, passes: 2, eye_passes: 2, eye_pixels: 0, phase };
                assert_eq!((benefit.frame_ended(&frame, &[]), benefit.is_on().rates), (None, true));
            }
        }
    }

    /// Times of a GPU come two frames late, and of every seventh frame never.
    #[test]
    fn times_of_a_gpu_are_those_of_their_frames() {
        for (ratio, is_kept) in [(1.3, false), (0.6, true)] {
            let mut benefit = judging_rates();
            let (mut was_on, mut said) = (Vec::new(), Vec::new());
            for number in 0..400_u64 {
                let on = benefit.is_on().rates;
                was_on.push(on);
                let frame = EndedFrame {
                    time_ns: number as i64 * 11_111_111,
                    clock: Clock::Gpu(number),
                    wanted: benefit.is_on(),
                    passes: if on { 2 } else { 0 },
                    eye_passes: 2,
                    eye_pixels: 0,
                    phase: GazePhase::Fixation,
                };
                let known = number.checked_sub(2).filter(|frame| frame % 7 != 3);
                let time = known.map(|frame| {
                    let ms = 5.0 + 0.05 * (frame % 5) as f64;
                    let ratio = if was_on[frame as usize] { ratio } else { 1.0 };
                    let ns = (1e6 * ms * ratio) as u64;
                    let own = OwnWork { maps_ns: ns / 100, analysis_ns: 0, pictures_ns: ns / 50 };
                    GpuCost { frame, ns, own }
                });
                said.extend(benefit.frame_ended(&frame, time.as_slice()));
            }
            assert_eq!(benefit.is_kept().rates, is_kept, "{ratio}: {said:?}");
            let own =
                "; the layer's own share of GPU time: 1.0 % for rates, 0.0 % for contrast, 2.0 % for images";
            assert!(said.iter().all(|line| line.ends_with(own)), "{said:?}");
            let (found, _) = benefit.gates.gates().rates.evidence().ratio().unwrap();
            assert!((found / ratio - 1.0).abs() < 0.02, "{found}, not {ratio}");
        }
    }

    /// At equal costs, which are known two frames later.
    #[test]
    fn more_pixels_with_a_technique_keep_it() {
        for (pixels, is_kept) in [([1000, 1400], true), ([1000, 700], false)] {
            let mut benefit = judging_rates();
            for number in 0..3000_u64 {
                let on = benefit.is_on().rates;
                let frame = EndedFrame {
                    time_ns: number as i64 * 11_111_111,
                    clock: Clock::Gpu(number),
                    wanted: benefit.is_on(),
                    passes: if on { 2 } else { 0 },
                    eye_passes: 2,
                    eye_pixels: pixels[usize::from(on)],
                    phase: GazePhase::Fixation,
                };
                let time = number.checked_sub(2).map(|frame| {
                    let ns = 5_000_000 + 50_000 * (frame * 3 % 7);
                    GpuCost { frame, ns, own: OwnWork::default() }
                });
                benefit.frame_ended(&frame, time.as_slice());
            }
            assert_eq!(benefit.is_kept().rates, is_kept, "{pixels:?}");
        }
    }

    #[test]
    fn each_technique_is_judged_by_what_it_changes() {
        for (rates, reuse) in [(0.6, 1.3), (1.3, 0.6), (0.7, 0.7)] {
            let mut benefit = Benefit::default();
            let (mut spent, mut said) = (0, Vec::new());
            for number in 0..4000 {
                let on = benefit.is_on();
                let cost = |is_on: bool, ratio: f64| if is_on { ratio } else { 1.0 };
                let jitter = 1.0 + 0.01 * f64::from(number % 7);
                spent += (1e7 * jitter * cost(on.rates, rates) * cost(on.reuse, reuse)) as u64;
                let frame = EndedFrame {
                    time_ns: i64::from(number) * 11_111_111,
                    clock: Clock::Cpu(Some(spent)),
                    wanted: on,
                    passes: if on.rates || on.reuse { 2 } else { 0 },
                    eye_passes: 2,
                    eye_pixels: 0,
                    phase: GazePhase::Fixation,
                };
                said.extend(benefit.frame_ended(&frame, &[]));
            }
            let expected = Techniques { rates: rates < 1.0, reuse: reuse < 1.0 };
            assert_eq!(benefit.is_kept(), expected, "{rates} {reuse}: {said:?}");
        }
    }

    #[test]
    fn modes_on_and_off_override_costs() {
        let (mut benefit, mut clock) = (judging_rates(), (0, 0));
        benefit.set_mode(of_rates(GateMode::On));
        assert_eq!(run(&mut benefit, &mut clock, 500, 2, 3.0), [""; 0]);
        assert!(benefit.is_on().rates);
        benefit.set_mode(of_rates(GateMode::Off));
        assert!(!benefit.is_on().rates);
    }
}
