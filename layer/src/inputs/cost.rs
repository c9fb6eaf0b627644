//! Cost of frames. Time spent, all of it: waiting for the runtime, for a display or for a limiter is not in it.
//!
//! Where a CPU renders, that is CPU time of the whole process from the end of one frame to the end of the next ([`CpuCost`]). Frames
//! overlap, so the effect of a change of one frame may show in the next; the gate leaves frames out after each change.
//!
//! On other devices it is the time in which the GPU works on the frame, from the first command to the last on all queues ([`GpuCosts`]), by
//! timestamps that the Vulkan half writes around the application's command buffers and its own, and the OpenXR half around its work at the
//! end of the frame. It is known some frames later, and so frames wait for it ([`Late`]).

use crate::link::FrameTimeRecord;
use smallvec::SmallVec;

/// CPU time of a frame, from readings of the process's clock.
#[derive(Clone, Copy, Debug, Default)]
pub struct CpuCost {
    last_ns: Option<u64>,
}

impl CpuCost {
    /// A frame ended, with this reading; returns its cost, nanoseconds, if the frame before has a reading too.
    pub fn frame_ended(&mut self, process_cpu_ns: Option<u64>) -> Option<u64> {
        let last = std::mem::replace(&mut self.last_ns, process_cpu_ns);
        process_cpu_ns?.checked_sub(last?)
    }
}

/// Cost of a frame on a GPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GpuCost {
    /// Number of the frame.
    pub frame: u64,
    /// Time in which the GPU worked on it, nanoseconds.
    pub ns: u64,
    /// Our part of that.
    pub own: OwnWork,
}

/// Time of our own work in a frame, nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct OwnWork {
    /// Rate images, masks, and the decision on rates.
    pub maps_ns: u64,
    /// Contrast of pictures.
    pub analysis_ns: u64,
    /// Eye buffers: copies, fills, re-use, chroma attenuation, debug views.
    pub pictures_ns: u64,
}

/// Puts the costs of frames together from the times of both halves. Allocates nothing.
#[derive(Clone, Debug, Default)]
pub struct GpuCosts {
    /// Times of the Vulkan half, in the order of the frames.
    times: SmallVec<[FrameTimeRecord; PATIENCE + 1]>,
    /// Frames, and times of the OpenXR half.
    pictures: SmallVec<[(u64, u64); PATIENCE + 1]>,
}

impl GpuCosts {
    /// Takes the Vulkan half's time of a frame; they come in the order of the frames.
    pub fn add(&mut self, time: FrameTimeRecord) {
        if self.times.len() > PATIENCE {
            self.times.remove(0);
        }
        self.times.push(time);
    }

    /// Takes the time of one submit of the OpenXR half.
    pub fn add_pictures(&mut self, frame: u64, ns: u64) {
        if let Some(known) = self.pictures.iter_mut().find(|known| known.0 == frame) {
            known.1 = known.1.saturating_add(ns);
            return;
        }
        if self.pictures.len() > PATIENCE {
            self.pictures.remove(0);
        }
        self.pictures.push((frame, ns));
    }

    /// The cost of the next frame, if both halves' times are known; from frame `under_way` on, submits of the OpenXR half are unfinished.
    pub fn next(&mut self, under_way: Option<u64>) -> Option<GpuCost> {
        let FrameTimeRecord { frame, ns, maps_ns, analysis_ns } = *self.times.first()?;
        if under_way.is_some_and(|under_way| frame >= under_way) {
            return None;
        }
        self.times.remove(0);
        let pictures = self.pictures.iter().find(|known| known.0 == frame);
        let pictures_ns = pictures.map_or(0, |known| known.1);
        self.pictures.retain(|known| known.0 > frame);
        let own = OwnWork { maps_ns, analysis_ns, pictures_ns };
        Some(GpuCost { frame, ns: ns.saturating_add(pictures_ns), own })
    }
}

/// Frames whose cost is not known yet, by their number, in their order. Allocates nothing.
#[derive(Clone, Debug)]
pub struct Late<F> {
    frames: SmallVec<[(u64, F); PATIENCE + 1]>,
}

/// Number of frames that are waited for; the cost of older ones stays unknown.
const PATIENCE: usize = 6;

impl<F> Default for Late<F> {
    fn default() -> Self {
        Self { frames: SmallVec::new() }
    }
}

impl<F> Late<F> {
    /// A frame ended; returns one that is not waited for any longer.
    pub fn push(&mut self, number: u64, frame: F) -> Option<F> {
        self.frames.push((number, frame));
        (self.frames.len() > PATIENCE).then(|| self.frames.remove(0).1)
    }

    /// The cost of frame `number` is known: takes the first frame that waits, of those up to that one, and whether it is that one.
    pub fn pop_until(&mut self, number: u64) -> Option<(F, bool)> {
        let (first, _) = self.frames.first()?;
        (*first <= number).then(|| {
            let (first, frame) = self.frames.remove(0);
            (frame, first == number)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cost_needs_two_readings() {
        let mut cost = CpuCost::default();
        let readings = [None, Some(5), Some(12), None, Some(20), Some(19), Some(30)];
        let costs = [None, None, Some(7), None, None, None, Some(11)];
        assert_eq!(readings.map(|reading| cost.frame_ended(reading)), costs);
    }

    fn time(frame: u64, ns: u64) -> FrameTimeRecord {
        FrameTimeRecord { frame, ns, maps_ns: 2, analysis_ns: 1 }
    }

    #[test]
    fn a_cost_has_the_times_of_both_halves() {
        let mut costs = GpuCosts::default();
        costs.add(time(4, 100));
        costs.add(time(6, 200));
        for (frame, ns) in [(3, 50), (4, 10), (6, 20), (4, 5), (7, 30)] {
            costs.add_pictures(frame, ns);
        }
        assert_eq!(costs.next(Some(4)), None, "the pictures of frame 4 are under way");
        let own = |pictures_ns| OwnWork { maps_ns: 2, analysis_ns: 1, pictures_ns };
        assert_eq!(costs.next(Some(6)), Some(GpuCost { frame: 4, ns: 115, own: own(15) }));
        assert_eq!(costs.next(Some(6)), None);
        assert_eq!(costs.next(None), Some(GpuCost { frame: 6, ns: 220, own: own(20) }));
        assert_eq!(costs.pictures.as_slice(), [(7, 30)]);
        costs.add(time(8, 7));
        assert_eq!(costs.next(None), Some(GpuCost { frame: 8, ns: 7, own: own(0) }), "nothing was drawn");
    }

    #[test]
    fn unrequested_costs_are_dropped() {
        let mut costs = GpuCosts::default();
        for frame in 0..100 {
            costs.add(time(frame, 1));
            costs.add_pictures(frame, 1);
        }
        assert_eq!(costs.next(None).map(|cost| cost.frame), Some(93));
        assert!(!costs.times.spilled() && !costs.pictures.spilled());
    }

    #[test]
    fn frames_wait_in_their_order_and_not_for_ever() {
        let mut late = Late::default();
        for number in 1..=3 {
            assert_eq!(late.push(number, number * 10), None);
        }
        assert_eq!(late.pop_until(2), Some((10, false)), "of the first nothing will be known any more");
        assert_eq!(late.pop_until(2), Some((20, true)));
        assert_eq!(late.pop_until(2), None);
        let given_up: Vec<u64> = (4..=12).filter_map(|number| late.push(number, number * 10)).collect();
        assert_eq!(given_up, [30, 40, 50, 60]);
        assert!(!late.frames.spilled());
    }
}
