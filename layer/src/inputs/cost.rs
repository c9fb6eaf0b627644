//! Cost of frames. Time spent, all of it: waiting for the runtime, for a display or for a limiter is not in it.
//!
//! Where a CPU renders, that is CPU time of the whole process from the end of one frame to the end of the next ([`CpuCost`]). Frames
//! overlap, so what a change of one frame does may show in the next; the gate leaves frames out after each change.
//!
//! On other devices it is the time on the GPU of the passes that show an eye, by timestamps that the Vulkan half writes around them and around its own work ahead of
//! them: masks, fills, maps and their decision. It is known some frames later, and so frames wait for it ([`Late`]). Work of the OpenXR half at
//! the end of a frame (re-use, chroma), passes in secondary command buffers and other passes of the application are not in it.

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
