//! The GPU time of whole frames, as it becomes known.

use super::queries::Interval;

/// Frames that are kept; timestamps of older ones are not waited for any longer.
const MOST: usize = 8;

/// Owner and purpose of the commands in a command buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Work {
    /// The application's.
    Application,
    /// Ours: rate images and masks, and the decision on rates.
    Maps,
    /// Ours: contrast of finished pictures, and copies of rates.
    Analysis,
}

/// GPU time of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameTime {
    /// Number of the frame.
    pub frame: u64,
    /// Time from the first to the last command of the frame on all queues in which at least one of its command buffers ran, ours included,
    /// nanoseconds.
    pub ns: u64,
    /// Of that, time in command buffers of [`Work::Maps`], nanoseconds.
    pub maps_ns: u64,
    /// Of that, time in command buffers of [`Work::Analysis`], nanoseconds.
    pub analysis_ns: u64,
}

/// Frames whose command buffers were submitted, in their order. Steady frames allocate nothing.
#[derive(Debug, Default)]
pub struct FrameTimes {
    frames: Vec<Frame>,
    /// Memory of earlier frames.
    spare: Vec<Vec<(Work, Interval)>>,
}

#[derive(Debug)]
struct Frame {
    frame: u64,
    intervals: Vec<(Work, Interval)>,
    /// Submits whose timestamps were not read yet.
    pending: u32,
    /// Whether some will never be.
    is_incomplete: bool,
    /// Whether a command buffer of the application was among them: our own work alone is not a frame.
    has_application: bool,
}

impl FrameTimes {
    /// A command buffer of a frame was submitted; it has timestamps.
    pub fn submitted(&mut self, frame: u64, work: Work) {
        let known = self.frame(frame);
        known.pending += 1;
        known.has_application |= work == Work::Application;
    }

    /// The same of one without timestamps: of the frame nothing is known.
    pub fn submitted_untimed(&mut self, frame: u64) {
        self.frame(frame).is_incomplete = true;
    }

    /// The timestamps of one command buffer were read; none where they cannot be.
    pub fn read(&mut self, frame: u64, work: Work, interval: Option<Interval>) {
        if let Some(known) = self.frames.iter_mut().find(|known| known.frame == frame) {
            known.pending = known.pending.saturating_sub(1);
            known.is_incomplete |= interval.is_none();
            known.intervals.extend(interval.map(|interval| (work, interval)));
        }
    }

    /// Whether the timestamps of a frame are awaited.
    pub fn waits_for(&self, frame: u64) -> bool {
        self.frames.iter().any(|known| known.frame == frame)
    }

    /// The next complete frame before `under_way`; `None` if there is none. A step of the clock takes `step_ns` nanoseconds.
    pub fn take(&mut self, under_way: u64, step_ns: f64) -> Option<FrameTime> {
        loop {
            let is_done = |known: &Frame| known.frame < under_way && known.pending == 0;
            let done = self.frames.iter().position(is_done)?;
            // Timestamps of earlier frames that are still missing would arrive too late.
            (0..done).for_each(|_| self.forget_first());
            let first = self.frames.first_mut()?;
            let time = (!first.is_incomplete && first.has_application).then(|| first.time(step_ns));
            self.forget_first();
            if time.is_some() {
                return time;
            }
        }
    }

    fn frame(&mut self, frame: u64) -> &mut Frame {
        let index = self.frames.iter().position(|known| known.frame == frame).unwrap_or_else(|| {
            if self.frames.len() == MOST {
                self.forget_first();
            }
            let intervals = self.spare.pop().unwrap_or_default();
            self.frames.push(Frame {
                frame,
                intervals,
                pending: 0,
                is_incomplete: false,
                has_application: false,
            });
            self.frames.len() - 1
        });
        &mut self.frames[index]
    }

    fn forget_first(&mut self) {
        let mut intervals = self.frames.remove(0).intervals;
        intervals.clear();
        self.spare.push(intervals);
    }
}

impl Frame {
    fn time(&mut self, step_ns: f64) -> FrameTime {
        let ns = |steps: u64| (steps as f64 * step_ns) as u64;
        let of = |work| {
            let own = self.intervals.iter().filter(|(whose, _)| *whose == work);
            ns(own.map(|(_, interval)| interval.steps()).sum())
        };
        let [maps_ns, analysis_ns] = [of(Work::Maps), of(Work::Analysis)];
        FrameTime { frame: self.frame, ns: ns(steps_of_any(&mut self.intervals)), maps_ns, analysis_ns }
    }
}

/// Steps in which at least one of the intervals lasts. Pauses between them are not time spent: the application's threads are late there.
///
/// Timestamps of all queues of a device are of one clock (`VK_TIME_DOMAIN_DEVICE_KHR`, Vulkan specification, Time Domains).
fn steps_of_any(intervals: &mut [(Work, Interval)]) -> u64 {
    let Some(&(_, reference)) = intervals.first() else { return 0 };
    intervals.sort_unstable_by_key(|(_, interval)| interval.begin_since(&reference));
    let mut steps = 0;
    let mut until = i64::MIN;
    for (_, interval) in intervals {
        let begin = interval.begin_since(&reference);
        let end = begin.saturating_add_unsigned(interval.steps());
        steps += end.saturating_sub(begin.max(until)).max(0).cast_unsigned();
        until = until.max(end);
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use Work::{Analysis, Application, Maps};

    fn interval(begin: u64, end: u64) -> Option<Interval> {
        Some(Interval { begin, end, valid_bits: u64::MAX })
    }

    fn time(frame: u64, ns: u64) -> Option<FrameTime> {
        Some(FrameTime { frame, ns, maps_ns: 0, analysis_ns: 0 })
    }

    #[test]
    fn a_frame_is_known_when_all_of_it_is_read_and_it_has_ended() {
        let mut times = FrameTimes::default();
        times.submitted(3, Maps);
        times.submitted(3, Application);
        times.read(3, Maps, interval(0, 10));
        assert_eq!(times.take(4, 1.0), None);
        times.submitted(4, Application);
        times.read(4, Application, interval(50, 57));
        times.read(3, Application, interval(10, 30));
        assert_eq!(times.take(4, 2.0), Some(FrameTime { frame: 3, ns: 60, maps_ns: 20, analysis_ns: 0 }));
        assert_eq!(times.take(4, 1.0), None, "frame 4 may submit more");
        assert_eq!(times.take(5, 1.0), time(4, 7));
    }

    /// Two queues: work at the same time counts once, a pause does not, and our own work is counted separately.
    #[test]
    fn a_frame_takes_as_long_as_any_queue_works() {
        let mut times = FrameTimes::default();
        let submits = [
            (Application, interval(120, 180)),
            (Application, interval(100, 150)),
            (Application, interval(110, 120)),
            (Analysis, interval(200, 204)),
            (Maps, interval(95, 100)),
            (Maps, interval(300, 302)),
        ];
        submits.iter().for_each(|&(work, _)| times.submitted(0, work));
        submits.iter().for_each(|&(work, interval)| times.read(0, work, interval));
        assert_eq!(times.take(1, 1.0), Some(FrameTime { frame: 0, ns: 91, maps_ns: 7, analysis_ns: 4 }));
    }

    #[test]
    fn a_clock_that_starts_over_goes_on() {
        let mut times = FrameTimes::default();
        let narrow = |begin, end| Some(Interval { begin, end, valid_bits: 0xff });
        (0..3).for_each(|_| times.submitted(0, Application));
        times.read(0, Application, narrow(2, 6));
        times.read(0, Application, narrow(250, 254));
        times.read(0, Application, narrow(252, 3));
        assert_eq!(times.take(1, 1.0), time(0, 12));
    }

    #[test]
    fn unreadable_timestamps_drop_the_frame() {
        let mut times = FrameTimes::default();
        (0..4).for_each(|frame| times.submitted(frame, Application));
        times.read(0, Application, None);
        times.read(1, Application, interval(0, 3));
        times.submitted_untimed(1);
        times.read(3, Application, interval(0, 5));
        assert_eq!(times.take(4, 1.0), time(3, 5), "2 is not waited for");
        times.read(2, Application, interval(0, 9));
        assert!(times.take(4, 1.0).is_none() && !times.waits_for(2));
    }

    #[test]
    fn our_own_work_alone_is_no_frame() {
        let mut times = FrameTimes::default();
        times.submitted(0, Maps);
        times.read(0, Maps, interval(0, 3));
        assert_eq!(times.take(1, 1.0), None);
    }

    #[test]
    fn missing_timestamps_are_forgotten() {
        let mut times = FrameTimes::default();
        for frame in 0..100 {
            times.submitted(frame, Application);
            assert_eq!(times.take(frame, 1.0), None);
        }
        assert_eq!((times.frames.len(), times.spare.len()), (MOST, 0));
    }
}
