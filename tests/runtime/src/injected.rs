//! Faults that the scenario injects, call by call.

use crate::fault::result_named;
use crate::scenario::{Answer, Fault};
use openxr_sys as xr;
use std::time::Duration;

/// Fault of a call.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct InjectedFault {
    /// Its result.
    pub result: Option<xr::Result>,
    /// Its answer.
    pub answer: Answer,
    /// Delay before it returns.
    pub late: Duration,
}

/// Number of calls so far for each fault that could have had it.
#[derive(Debug, Default)]
pub(crate) struct InjectedFaults {
    calls: Vec<u64>,
}

impl InjectedFaults {
    /// The fault, if any of `faults`, of a call in a frame of the process; always the same.
    pub fn next(&mut self, faults: &[Fault], call: &str, frame: u64) -> InjectedFault {
        self.calls.resize(faults.len(), 0);
        let mut happens = InjectedFault::default();
        for (fault, calls) in faults.iter().zip(&mut self.calls) {
            if fault.call != call || frame < fault.from_frame {
                continue;
            }
            let before = *calls;
            *calls += 1;
            let end = if fault.count == 0 { u64::MAX } else { fault.skip.saturating_add(fault.count) };
            if (fault.skip..end).contains(&before) && happens == InjectedFault::default() {
                happens = InjectedFault {
                    result: result_named(&fault.result),
                    answer: fault.answer,
                    late: Duration::from_millis(fault.late_ms),
                };
            }
        }
        happens
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_happens_to_so_many_calls_from_its_frame_on() {
        let text =
            "call = 'xrEndFrame'\nresult = 'XR_ERROR_SESSION_LOST'\nfrom_frame = 2\nskip = 1\ncount = 2";
        let faults = [toml::from_str::<Fault>(text).unwrap()];
        let mut injected = InjectedFaults::default();
        let mut next = |call, frame| injected.next(&faults, call, frame).result;
        assert_eq!(next("xrEndFrame", 1), None);
        assert_eq!(next("xrBeginFrame", 2), None);
        let lost = Some(xr::Result::ERROR_SESSION_LOST);
        assert_eq!([(); 4].map(|()| next("xrEndFrame", 2)), [None, lost, lost, None]);
    }
}
