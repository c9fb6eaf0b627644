//! Eye movement: rest or pursuit (a line through the samples), or jump (a saccade in flight).

use super::line_fit::{EyeSample, LineFit};
use super::saccade::SaccadePath;
use crate::gaze::GazeSettings;
use glam::Vec3;

/// Samples nearer in time than this are one sample: half of the interval of a 1 kHz tracker. A speed over less
/// would be noise divided by next to nothing.
const LEAST_STEP_NS: i64 = 500_000;

/// Fastest that eyes turn, degrees a second, above the 500 to 700 at which saccades peak (Carpenter 1988).
pub(super) const FASTEST_DEG_S: f32 = 1000.0;

/// Longest saccade: 80 degrees take 197 ms. Eyes that stay fast for longer follow the head.
const LONGEST_SACCADE_NS: i64 = 200_000_000;

/// Sudden change of the speed of slow eyes, degrees a second, as at the onset of pursuit.
const PURSUIT_ONSET_DEG_S: f32 = 30.0;

/// Longest time for which that counts, seconds: after a longer one the gaze is as uncertain.
const LONGEST_ALLOWANCE_S: f32 = 0.1;

/// A sample is a jump where it is this many standard deviations from where it was expected, which of a million at rest 40
/// are.
const JUMP_SIGMAS: f32 = 4.5;

/// Standard deviations above noise at which turning begins, and below which it ends.
const TURNING_SIGMAS: [f32; 2] = [3.5, 2.0];

/// Scatter of a tracker's samples, standard deviation along either axis, degrees; before it is measured.
const USUAL_NOISE_DEG: f32 = 0.3;

/// Range of believed measurements.
const NOISE_DEG: std::ops::RangeInclusive<f32> = 0.05..=1.0;

/// Weight of one sample in the measured noise.
const NOISE_GAIN: f32 = 0.03;

/// Least samples in a line before the next one measures noise.
const NOISE_COUNT: u16 = 6;

/// The same where the line remembers fewer, as below 40 Hz: with three samples, a pursuit that bends is noise.
const LEAST_NOISE_COUNT: u16 = 4;

/// Samples that are kept beside the line, in which a saccade may have begun unseen.
const EARLIER: usize = 3;

/// Longest time for which a saccade may be unseen, nanoseconds: in 17 ms it goes 1.3 degrees.
const UNSEEN_NS: i64 = 25_000_000;

/// Least samples in a line before others can count as lying aside of it.
const SHIFT_COUNT: u16 = 4;

/// Least deviation of several samples together, as a part of that of a single one.
const LEAST_SHIFT: f32 = 0.5;

/// The eyes have landed where the newest sample is no farther aside than this many times the mean of it and those before.
const LANDED: f32 = 1.15;

/// Least samples in a line before its slope counts as turning: the first ones may be the tail of a saccade.
const TURNING_COUNT: u16 = 5;

/// Not plausible: faster than eyes turn.
#[derive(Debug)]
pub(super) struct Implausible;

/// Eye movement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    /// The newest sample that was believed.
    sample: EyeSample,
    line: LineFit,
    /// Present in a saccade.
    saccade: Option<SaccadePath>,
    /// Last time at which nothing was known, or a saccade ended.
    settled_ns: i64,
    /// Whether that was the landing of a saccade.
    has_landed: bool,
    turning: bool,
    /// A sample that was too far away, until the next one shows whether the eyes are there.
    suspect: Option<EyeSample>,
    noise_deg: f32,
    interval_s: f32,
    /// The newest samples in the line, newest first, and the line before each.
    earlier: [Option<(LineFit, EyeSample)>; EARLIER],
}

/// Kind of eye movement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EyeMovement {
    Resting,
    Turning,
    Saccade,
}

impl Motion {
    /// Nothing is known of before.
    pub(super) fn new(sample: EyeSample) -> Self {
        Self {
            sample,
            line: LineFit::new(sample),
            saccade: None,
            settled_ns: sample.time_ns,
            has_landed: false,
            turning: false,
            suspect: None,
            noise_deg: USUAL_NOISE_DEG,
            interval_s: 0.0,
            earlier: [None; EARLIER],
        }
    }

    /// Earlier positions of the eyes are unknown, but the tracker's noise and interval are kept. `late`: this is the
    /// sample after the newest, and the tracker may be slow.
    pub(super) fn found_again(&self, sample: EyeSample, late: bool) -> Self {
        let mut found = Self { noise_deg: self.noise_deg, interval_s: self.interval_s, ..Self::new(sample) };
        if late {
            found.note_interval(sample.seconds_since(self.newest().time_ns));
        }
        found
    }

    /// Takes a sample that is not before the newest. `head_deg_s` is the speed of the head, which a gaze may follow that rests on
    /// content fixed to the head.
    pub(super) fn add(
        &mut self,
        settings: &GazeSettings,
        sample: EyeSample,
        head_deg_s: f32,
    ) -> Result<(), Implausible> {
        let newest = *self.newest();
        let repeated = sample.time_ns.saturating_sub(newest.time_ns) < LEAST_STEP_NS;
        if repeated && self.sample.directions == sample.directions && self.suspect.is_none() {
            return Ok(());
        }
        let seconds = if repeated { 0.0 } else { sample.seconds_since(newest.time_ns) };
        let allowance_deg = (PURSUIT_ONSET_DEG_S + head_deg_s) * seconds.min(LONGEST_ALLOWANCE_S);
        let limit_deg = settings.least_saccade_deg.max(JUMP_SIGMAS * self.noise_deg) + allowance_deg;
        let missed_deg = match &self.saccade {
            Some(_) => sample.angle_deg(newest.directions),
            None => sample.angle_deg(self.expected(seconds)),
        };
        // After a sample in doubt, the next one confirms it or the one before.
        if missed_deg > limit_deg && (self.suspect.is_some() || missed_deg > FASTEST_DEG_S * seconds) {
            return self.doubt(sample, limit_deg);
        }
        if repeated {
            return Ok(());
        }
        self.suspect = None;
        self.sample = sample;
        self.note_interval(seconds);
        match self.saccade {
            Some(saccade) => self.add_to_saccade(settings, saccade, sample, head_deg_s),
            None if missed_deg > limit_deg => self.leave(sample),
            None => match self.shifted(settings, sample, head_deg_s) {
                Some(line) => {
                    self.line = line;
                    self.earlier = [None; EARLIER];
                    self.settled_ns = sample.time_ns;
                    self.has_landed = false;
                    self.turning = false;
                }
                None => {
                    self.note_noise(settings, missed_deg);
                    self.earlier.rotate_right(1);
                    self.earlier[0] = Some((self.line, sample));
                    self.line.add(sample, self.memory(settings));
                    self.turning = self.is_turning(settings);
                }
            },
        }
        Ok(())
    }

    /// The newest sample that was believed, or the line at its time.
    pub(super) fn newest(&self) -> &EyeSample {
        self.saccade.as_ref().map_or(self.line.newest(), SaccadePath::newest)
    }

    /// Directions of the newest sample, if they are too far away to be believed.
    pub(super) fn in_doubt(&self) -> Option<[Vec3; 2]> {
        self.suspect.map(|suspect| suspect.directions)
    }

    pub(super) fn movement(&self) -> EyeMovement {
        match (&self.saccade, self.turning) {
            (Some(_), _) => EyeMovement::Saccade,
            (None, true) => EyeMovement::Turning,
            (None, false) => EyeMovement::Resting,
        }
    }

    /// Last time at which nothing was known, or a saccade ended.
    pub(super) fn settled_ns(&self) -> i64 {
        self.settled_ns
    }

    /// Time at which the eyes land or have landed, by the clock of the samples: of a saccade in flight once a second sample has confirmed
    /// it, and of the last thing that they did if that was a saccade.
    pub(super) fn landing_ns(&self) -> Option<i64> {
        match &self.saccade {
            Some(saccade) => (!saccade.is_single()).then_some(saccade.landing.time_ns),
            None => self.has_landed.then_some(self.settled_ns),
        }
    }

    /// Mean time between samples, seconds; 0 before there are two.
    pub(super) fn interval_s(&self) -> f32 {
        self.interval_s
    }

    /// Directions of the eyes `ahead_s` after the newest sample, and the possible error of a prediction, degrees.
    pub(super) fn directions(&self, settings: &GazeSettings, ahead_s: f32) -> ([Vec3; 2], Option<f32>) {
        match &self.saccade {
            Some(saccade) => {
                let (directions, error_deg) = saccade.ahead(ahead_s);
                (directions, Some(error_deg))
            }
            None if self.turning => {
                // The pursued object may have stopped anywhere on this way: the standard deviation of an even distribution.
                let way_deg = self.line.speed_deg_s() * ahead_s.max(settings.latency_ms * 1e-3);
                (self.line.ahead(ahead_s), Some(way_deg / 12f32.sqrt()))
            }
            None => (self.line.estimate(self.noise_deg, false, ahead_s), None),
        }
    }

    /// Angular speed of the eyes, degrees a second.
    pub(super) fn speed_deg_s(&self) -> f32 {
        let speed = match (&self.saccade, self.turning) {
            (Some(saccade), _) => saccade.speed_deg_s,
            (None, true) => self.line.speed_deg_s(),
            (None, false) => 0.0,
        };
        speed.min(FASTEST_DEG_S)
    }

    /// A saccade has shown in a sample; it may have begun in those before.
    fn leave(&mut self, sample: EyeSample) {
        let unseen = self.earlier.iter().map_while(|earlier| {
            earlier.filter(|(_, before)| sample.time_ns.saturating_sub(before.time_ns) < UNSEEN_NS)
        });
        let (mut line, mut before, mut count) = (self.line, [sample; EARLIER], 0);
        for (earlier, unseen) in unseen {
            line = earlier;
            before[count] = unseen;
            count += 1;
        }
        before[..count].reverse();
        let directions = line.estimate(self.noise_deg, self.turning, 0.0);
        let start = EyeSample { directions, ..*line.newest() };
        self.saccade = Some(SaccadePath::new(start, &before[..count], sample, self.noise_deg));
        self.earlier = [None; EARLIER];
        self.turning = false;
    }

    /// The line through the newest samples alone, if their mean lies aside of the prediction although none of them is a jump: the eyes
    /// have landed nearby.
    fn shifted(&self, settings: &GazeSettings, sample: EyeSample, head_deg_s: f32) -> Option<LineFit> {
        let missed = |line: &LineFit, sample: &EyeSample| {
            let expected =
                line.estimate(self.noise_deg, self.turning, sample.seconds_since(line.newest().time_ns));
            0.5 * (sample.directions[0] - expected[0] + sample.directions[1] - expected[1])
        };
        let mut samples = 1.0;
        (0..EARLIER).find_map(|last| {
            let (line, first) = self.earlier[last].filter(|(line, _)| line.count() >= SHIFT_COUNT)?;
            samples += 1.0;
            let (newest, before) = (missed(&line, &sample), self.earlier[..=last].iter().flatten());
            let mean = (newest + before.map(|(_, sample)| missed(&line, sample)).sum::<Vec3>()) / samples;
            let seconds = sample.seconds_since(line.newest().time_ns).min(LONGEST_ALLOWANCE_S);
            let least_deg = LEAST_SHIFT * settings.least_saccade_deg.max(JUMP_SIGMAS * self.noise_deg);
            let limit_deg = least_deg.max(JUMP_SIGMAS * self.noise_deg / f32::sqrt(samples))
                + 0.5 * (PURSUIT_ONSET_DEG_S + head_deg_s) * seconds;
            let has_landed = newest.dot(mean) < LANDED * mean.length_squared();
            (has_landed && mean.length().to_degrees() > limit_deg).then(|| {
                let mut line = LineFit::new(first);
                let after = self.earlier[..last].iter().flatten().rev().map(|(_, sample)| *sample);
                after.chain([sample]).for_each(|sample| line.add(sample, self.memory(settings)));
                line
            })
        })
    }

    /// Expected directions some seconds after the newest sample of the line.
    fn expected(&self, seconds: f32) -> [Vec3; 2] {
        self.line.estimate(self.noise_deg, self.turning, seconds)
    }

    /// A jump that no eye makes: either one sample is wrong, or the next one confirms it.
    fn doubt(&mut self, sample: EyeSample, limit_deg: f32) -> Result<(), Implausible> {
        let confirmed = self.suspect.is_some_and(|suspect| {
            let seconds = sample.seconds_since(suspect.time_ns);
            sample.angle_deg(suspect.directions) < limit_deg.max(FASTEST_DEG_S * seconds)
                && sample.time_ns.saturating_sub(suspect.time_ns) >= LEAST_STEP_NS
        });
        if confirmed {
            *self = self.found_again(sample, false);
            return Ok(());
        }
        self.suspect = Some(sample);
        Err(Implausible)
    }

    fn add_to_saccade(
        &mut self,
        settings: &GazeSettings,
        saccade: SaccadePath,
        sample: EyeSample,
        head_deg_s: f32,
    ) {
        let before = *saccade.newest();
        let back_deg = sample.angle_deg(self.expected(sample.seconds_since(self.line.newest().time_ns)));
        if saccade.is_single() && back_deg < settings.least_saccade_deg.max(JUMP_SIGMAS * self.noise_deg) {
            // One sample was off, and the eyes never left.
            self.saccade = None;
            self.line.add(sample, self.memory(settings));
        } else if sample.time_ns.saturating_sub(saccade.shown_ns()) > LONGEST_SACCADE_NS {
            self.saccade = None;
            self.line = LineFit::through(&before, sample);
            self.settled_ns = sample.time_ns;
            self.has_landed = false;
            self.turning = true;
        } else {
            let mut saccade = saccade;
            saccade.add(sample, self.noise_deg);
            let slow_deg_s = settings.saccade_end_deg_s.max(0.0) + head_deg_s;
            let still_deg = slow_deg_s * sample.seconds_since(before.time_ns) + 3.0 * self.noise_deg;
            if saccade.has_landed() && sample.angle_deg(before.directions) < still_deg {
                self.saccade = None;
                self.line = LineFit::new(sample);
                self.settled_ns = saccade.landed_ns();
                self.has_landed = true;
            } else {
                self.saccade = Some(saccade);
            }
        }
    }

    fn is_turning(&self, settings: &GazeSettings) -> bool {
        // The first samples may be the tail of a saccade.
        if self.line.count() < TURNING_COUNT.min(self.memory(settings)) {
            return false;
        }
        let sigmas = TURNING_SIGMAS[usize::from(self.turning)];
        let least = settings.pursuit_deg_s.max(sigmas * self.line.speed_noise_deg_s(self.noise_deg));
        self.line.speed_deg_s() > least
    }

    fn memory(&self, settings: &GazeSettings) -> u16 {
        (settings.memory_ms.max(0.0) * 1e-3 / self.interval_s.max(1e-4)).clamp(3.0, 64.0) as u16
    }

    fn note_interval(&mut self, seconds: f32) {
        if self.interval_s == 0.0 {
            self.interval_s = seconds;
        }
        self.interval_s += 0.2 * (seconds - self.interval_s);
    }

    fn note_noise(&mut self, settings: &GazeSettings, missed_deg: f32) {
        if self.line.count() < NOISE_COUNT.min(self.memory(settings).max(LEAST_NOISE_COUNT)) {
            return;
        }
        // Along two axes, and where it was expected is off as well: the end of a line by 4 / n, a mean by 1 / n.
        let off = if self.turning { 4.0 } else { 1.0 } / f32::from(self.line.count());
        let square = 0.5 * missed_deg * missed_deg / (1.0 + off);
        let mean = self.noise_deg * self.noise_deg;
        let noise = (mean + NOISE_GAIN * (square.min(9.0 * mean) - mean)).sqrt();
        self.noise_deg = noise.clamp(*NOISE_DEG.start(), *NOISE_DEG.end());
    }
}
