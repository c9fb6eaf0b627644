//! Delay of a source of the gaze that does not know when its samples were taken, by another source of the same eyes that does: the lag at which
//! the velocities of both are most alike. Saccades serve as marks; a resting gaze gives no information.

/// Distance of the points at which both are compared, nanoseconds.
const STEP_NS: i64 = 4_000_000;

/// Number of the lags that are tried: 0 to 400 ms.
const LAGS: usize = 101;

/// Half of the time over which a velocity is taken, steps: together as long as a saccade of ten degrees (Bahill, Clark and Stark 1975, "The main
/// sequence"), and as a period of the slowest trackers.
const HALF: i64 = 6;

/// The slowest move that counts, degrees a second: noise of rests is slower with most trackers.
const LEAST_DEG_S: f32 = 30.0;

/// Longest time between samples of one move, nanoseconds: three periods of a tracker of 20 Hz.
const LONGEST_GAP_NS: i64 = 150_000_000;

/// Number of the newest velocities that are kept: 2 s, the lags and as much difference between the sources.
const KEPT: usize = 512;

/// Number of the newest points that are kept, for the next velocity.
const POINTS: usize = 2 * HALF as usize + 1;

/// A sample that is older than the one before by more than this, nanoseconds: the clock began again.
const LONGEST_BACK_NS: i64 = 1_000_000_000;

/// Least number of moves of a measurement.
const LEAST_MOVES: u32 = 20;

/// Least number of compared points of a measurement: 10 s.
const LEAST_POINTS: u32 = 2500;

/// Longest measurement, compared points: two minutes.
const MOST_POINTS: u32 = 30_000;

/// Least correlation of sources of the same eyes: lower, one of them is noise.
const LEAST_CORRELATION: f64 = 0.6;

/// Greatest share of the correlation of another lag, farther away than [`NEAR`]: moves that repeat themselves have no one lag.
const MOST_OF_OTHERS: f64 = 0.7;

/// Steps around the best lag within which the correlation falls off: the time of a velocity and of a saccade.
const NEAR: usize = 25;

/// A sample of a source: degrees to the left and upwards, and its time, nanoseconds on one clock for both sources.
pub type TimedGaze = ([f32; 2], i64);

/// Estimates the delay of one source by another. Holds no clock, and allocates nothing.
#[derive(Clone, Debug, Default)]
pub struct GazeDelay {
    dated: Trace,
    late: Trace,
    /// The next point to be compared.
    next: Option<i64>,
    was_moving: bool,
    sums: Sums,
    known_ms: Option<f32>,
}

impl GazeDelay {
    /// Takes the newest sample of each source: of `dated` at the time when the eyes looked there, of `late` at the time when it came. `None`
    /// while a source does not see the eyes; a sample that is known already changes nothing.
    pub fn push(&mut self, dated: Option<TimedGaze>, late: Option<TimedGaze>) {
        let is_again = |trace: &Trace, sample: Option<TimedGaze>| {
            trace.newest.zip(sample).is_some_and(|((_, before_ns), (_, time_ns))| {
                before_ns.saturating_sub(time_ns) > LONGEST_BACK_NS
            })
        };
        if is_again(&self.dated, dated) || is_again(&self.late, late) {
            *self = Self::default();
        }
        dated.into_iter().for_each(|sample| self.dated.push(sample));
        late.into_iter().for_each(|sample| self.late.push(sample));
        let Some(end) = self.dated.end().zip(self.late.end()).map(|(dated, late)| dated.min(late)) else {
            return;
        };
        // Velocities that are no longer kept are passed over.
        let begin = self.next.map_or(end, |next| next.max(end - (KEPT - LAGS) as i64));
        (begin..end).for_each(|at| self.compare(at));
        self.next = Some(begin.max(end));
    }

    /// The delay by the newest measurement that had a result, milliseconds; `None`: the eyes have moved too little, or the sources do not agree.
    pub fn delay_ms(&self) -> Option<f32> {
        self.known_ms
    }

    /// Whether any sample was taken.
    pub fn has_begun(&self) -> bool {
        self.dated.newest.is_some() || self.late.newest.is_some()
    }

    fn compare(&mut self, at: i64) {
        let Some(late) = self.late.velocity(at) else { return };
        let is_moving = late != [0.0; 2];
        self.sums.points += 1;
        self.sums.moves += u32::from(is_moving && !self.was_moving);
        self.was_moving = is_moving;
        for (lag, sums) in (0..).zip(&mut self.sums.lags) {
            if let Some(dated) = self.dated.velocity(at - lag) {
                sums.add(dated, late);
            }
        }
        let is_over = self.sums.moves >= LEAST_MOVES && self.sums.points >= LEAST_POINTS;
        if is_over || self.sums.points >= MOST_POINTS {
            // A measurement without a result takes none away: the eyes may have rested.
            let steps = self.sums.best_lag().filter(|_| is_over);
            self.known_ms = steps.map(|steps| (steps * STEP_NS as f64 * 1e-6) as f32).or(self.known_ms);
            self.sums = Sums::default();
        }
    }
}

/// A source at points of time, `STEP_NS` apart: between samples it goes the straight way.
#[derive(Clone, Debug)]
struct Trace {
    newest: Option<TimedGaze>,
    /// The point after the newest one.
    next: i64,
    /// The gaze at the newest points, each in the place of its number modulo `POINTS`; `None` in gaps.
    points: [Option<[f32; 2]>; POINTS],
    /// Velocities, degrees a second, in the same manner; 0 below `LEAST_DEG_S`.
    velocities: [Option<[f32; 2]>; KEPT],
}

impl Default for Trace {
    fn default() -> Self {
        Self { newest: None, next: 0, points: [None; POINTS], velocities: [None; KEPT] }
    }
}

/// The place of a point in a ring.
fn place<const COUNT: usize>(at: i64) -> usize {
    at.rem_euclid(COUNT as i64) as usize
}

impl Trace {
    fn push(&mut self, (angles, time_ns): TimedGaze) {
        if !angles.iter().all(|angle| angle.abs() <= 180.0) {
            return;
        }
        let after = time_ns.div_euclid(STEP_NS) + 1;
        let Some((from, from_ns)) = self.newest else {
            (self.newest, self.next) = (Some((angles, time_ns)), after);
            return;
        };
        if time_ns <= from_ns {
            return;
        }
        let passed_ns = time_ns.saturating_sub(from_ns);
        self.next = self.next.max(after - KEPT as i64);
        while self.next < after {
            let at_ns = self.next * STEP_NS;
            self.add((passed_ns <= LONGEST_GAP_NS).then(|| {
                let share = (at_ns - from_ns) as f32 / passed_ns as f32;
                [0, 1].map(|axis| from[axis] + share * (angles[axis] - from[axis]))
            }));
        }
        self.newest = Some((angles, time_ns));
    }

    /// Adds the next point, and the velocity whose last point it is.
    fn add(&mut self, point: Option<[f32; 2]>) {
        self.points[place::<POINTS>(self.next)] = point;
        // The place after the newest point has the oldest.
        let first = self.points[place::<POINTS>(self.next + 1)];
        let velocity = first.zip(point).map(|(first, last)| {
            let seconds = (2 * HALF * STEP_NS) as f32 * 1e-9;
            let velocity = [0, 1].map(|axis| (last[axis] - first[axis]) / seconds);
            if velocity[0].hypot(velocity[1]) < LEAST_DEG_S { [0.0; 2] } else { velocity }
        });
        self.velocities[place::<KEPT>(self.next - HALF)] = velocity;
        self.next += 1;
    }

    /// The point after the newest with a velocity; `None` before the first sample.
    fn end(&self) -> Option<i64> {
        self.newest.map(|_| self.next - HALF)
    }

    /// The velocity at one of the newest [`KEPT`] points before [`Self::end`].
    fn velocity(&self, at: i64) -> Option<[f32; 2]> {
        let is_kept = self.end().is_some_and(|end| (end - KEPT as i64..end).contains(&at));
        self.velocities[place::<KEPT>(at)].filter(|_| is_kept)
    }
}

/// A measurement.
#[derive(Clone, Debug)]
struct Sums {
    points: u32,
    moves: u32,
    lags: [LagSums; LAGS],
}

impl Default for Sums {
    fn default() -> Self {
        Self { points: 0, moves: 0, lags: [LagSums::default(); LAGS] }
    }
}

/// Sums of products of velocities at one lag.
#[derive(Clone, Copy, Debug, Default)]
struct LagSums {
    both: f64,
    dated: f64,
    late: f64,
}

impl LagSums {
    fn add(&mut self, dated: [f32; 2], late: [f32; 2]) {
        let product = |a: [f32; 2], b: [f32; 2]| f64::from(a[0] * b[0] + a[1] * b[1]);
        self.both += product(dated, late);
        self.dated += product(dated, dated);
        self.late += product(late, late);
    }

    fn correlation(&self) -> f64 {
        let most = (self.dated * self.late).sqrt();
        if most > 0.0 { self.both / most } else { 0.0 }
    }
}

impl Sums {
    /// The lag at which the velocities are most alike, steps; `None` if they are not, or at several lags, or at one of the range's ends.
    fn best_lag(&self) -> Option<f64> {
        let alike = self.lags.map(|sums| sums.correlation());
        let (best, peak) = alike.iter().copied().enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b))?;
        let mut others = alike.iter().enumerate().filter(|(lag, _)| lag.abs_diff(best) > NEAR);
        let is_one = others.all(|(_, other)| *other <= MOST_OF_OTHERS * peak);
        if peak < LEAST_CORRELATION || !is_one {
            return None;
        }
        // The vertex of the parabola through the peak and both lags beside it.
        let (before, after) = (*alike.get(best.checked_sub(1)?)?, *alike.get(best + 1)?);
        let bend = before - 2.0 * peak + after;
        let beside = if bend < 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
        Some(best as f64 + beside)
    }
}

#[cfg(test)]
mod tests;
