//! What frames cost where a CPU renders them: CPU time of the whole process from the end of one frame to the end of the next.
//!
//! That is time spent: waiting for the runtime, for a display or for a limiter is not in it. Frames overlap, so what a
//! change of one frame does may show in the next; the gate leaves frames out after each change.
//!
//! Devices that are no CPU have no costs yet. Theirs will be timestamps around the passes with rates and our own work for
//! them, read when their submit has completed, two or three frames later: the gate takes costs late.

/// CPU time of a frame, from readings of the process's clock.
#[derive(Clone, Copy, Debug, Default)]
pub struct CpuCost {
    last_ns: Option<u64>,
}

impl CpuCost {
    /// A frame ended, with this reading; returns what it cost, nanoseconds, if the frame before has a reading too.
    pub fn frame_ended(&mut self, process_cpu_ns: Option<u64>) -> Option<u64> {
        let last = std::mem::replace(&mut self.last_ns, process_cpu_ns);
        process_cpu_ns?.checked_sub(last?)
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
}
