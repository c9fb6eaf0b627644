//! Applications that change their resolution, with known costs.

use super::simulation::{Eyes, Simulation};
use super::{Gate, GateFrame, GateMode, SECOND, is_hidden};

/// Pixels of an eye at scale 1.
const PIXELS: f64 = 2000.0 * 2000.0;

/// The multiple to which sides are rounded, pixels.
const ROUNDING: f64 = 8.0;

/// Cost of a frame at scale 1 without the technique, nanoseconds: that of [`Simulation`].
const BUDGET_NS: f64 = 5e6;

/// Control of the resolution. Times are seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Control {
    /// Pixels follow the cost with this time constant.
    Smooth(f64),
    /// 10 % more or fewer pixels, after each interval of this length whose mean cost is below 84 % or above 100 % of the budget.
    Steps(f64),
    /// Pixels wander by 10 %, whatever frames cost, and forget within that time.
    Wander(f64),
    /// Up to 35 % more or fewer pixels, at random, after each interval of this length.
    Jumps(f64),
    /// 50 % more pixels from that time on: a changed setting.
    Setting(f64),
}

/// An application.
#[derive(Clone, Copy, Debug)]
pub(super) struct Game {
    pub(super) control: Control,
    /// Share of the cost that follows the pixels, at scale 1 without the technique; without any, all of the cost can be saved.
    pub(super) share: f64,
    /// Saving of the technique at equal resolution, in the whole cost.
    pub(super) gain: f64,
    /// Standard deviation of the noise of each cost.
    pub(super) noise: f64,
    /// Whether the gate knows the pixels.
    pub(super) is_known: bool,
    /// Length of a menu at the start, seconds, with pixels that stay, where the technique costs 10 %.
    pub(super) menu_s: i64,
}

/// Result of a run.
#[derive(Debug, Default)]
pub(super) struct Played {
    /// Whether the technique is kept after 30 s.
    pub(super) is_kept_at_30_s: bool,
    /// Whether it is kept at the end.
    pub(super) is_kept: bool,
    /// Share of frames with the technique.
    pub(super) on: f64,
    /// Times of switches with open eyes.
    pub(super) seen_ns: Vec<i64>,
}

impl Game {
    pub(super) const DEFAULT: Self =
        Self { control: Control::Smooth(0.5), share: 0.9, gain: 0.0, noise: 0.1, is_known: true, menu_s: 0 };

    /// Runs for so many seconds.
    pub(super) fn play(self, eyes: Eyes, seed: u64, seconds: i64) -> Played {
        let mut running = Running {
            game: self,
            simulation: Simulation::new(seed).noise(self.noise).eyes(eyes).latency(1),
            scale: 1.0,
            interval: (0, 0.0, 0),
        };
        let mut gate = Gate::new(GateMode::Auto);
        let mut played = Played::default();
        let (mut was_on, mut frames, mut on_frames) = (true, 0_u32, 0_u32);
        while running.simulation.now() < seconds * SECOND {
            let frame = running.frame(gate.is_on());
            let on = gate.frame(&frame, true);
            frames += 1;
            on_frames += u32::from(on);
            if std::mem::replace(&mut was_on, on) != on && !is_hidden(frame.phase) {
                played.seen_ns.push(frame.time_ns);
            }
            if frame.time_ns <= 30 * SECOND {
                played.is_kept_at_30_s = gate.is_kept();
            }
        }
        played.is_kept = gate.is_kept();
        played.on = f64::from(on_frames) / f64::from(frames);
        played
    }
}

/// A running application.
struct Running {
    game: Game,
    simulation: Simulation,
    /// Pixels, relative to scale 1.
    scale: f64,
    /// Begin of the interval of [`Control`], nanoseconds, and its costs: their sum, in budgets, and their number.
    interval: (i64, f64, u32),
}

impl Running {
    fn frame(&mut self, on: bool) -> GateFrame {
        let Game { share, gain, is_known, menu_s, .. } = self.game;
        let is_menu = self.simulation.now() < menu_s * SECOND;
        let gain = if is_menu { -0.1 } else { gain };
        let side = ((self.scale * PIXELS).sqrt() / ROUNDING).round() * ROUNDING;
        let scale = side * side / PIXELS;
        let saved = match (on, share > 0.0) {
            (false, _) => 0.0,
            (true, true) => gain * scale,
            (true, false) => gain,
        };
        self.simulation.set_pixels(if is_known { (side * side) as u32 } else { 0 });
        let frame = self.simulation.frame_with_factor(on, 1.0 - share + share * scale - saved);
        if !is_menu {
            self.control(self.simulation.newest_cost_ns() as f64 / BUDGET_NS);
        }
        frame
    }

    /// Chooses the pixels of the next frame, after one of this cost, in budgets.
    fn control(&mut self, cost: f64) {
        let now = self.simulation.now();
        let (began_ns, sum, count) = self.interval;
        self.interval = (began_ns, sum + cost, count + 1);
        let is_over = |seconds: f64| now - began_ns >= (seconds * 1e9) as i64;
        match self.game.control {
            Control::Smooth(seconds) => self.scale *= ((1.0 - cost) / (90.0 * seconds)).exp(),
            Control::Steps(seconds) if is_over(seconds) => {
                let mean = self.interval.1 / f64::from(self.interval.2);
                self.scale *= match mean {
                    ..0.84 => 1.1,
                    0.84..=1.0 => 1.0,
                    _ => 1.0 / 1.1,
                };
                self.interval = (now, 0.0, 0);
            }
            Control::Wander(seconds) => {
                let keep = 1.0 - 1.0 / (90.0 * seconds);
                let step = (self.simulation.uniform() - 0.5) * 12_f64.sqrt();
                self.scale = (self.scale.ln() * keep + 0.1 * (1.0 - keep * keep).sqrt() * step).exp();
            }
            Control::Jumps(seconds) if is_over(seconds) => {
                self.scale = (0.6 * (self.simulation.uniform() - 0.5)).exp();
                self.interval = (now, 0.0, 0);
            }
            Control::Setting(seconds) => self.scale = if is_over(seconds) { 1.5 } else { 1.0 },
            Control::Steps(_) | Control::Jumps(_) => {}
        }
        self.scale = self.scale.clamp(0.4, 2.5);
    }
}
