//! The model: a dispatch takes as long as its memory traffic or its instructions, whichever is longer.

use super::gpu::Gpu;
use super::work::Dispatch;
use super::{Kernels, Task};

/// The estimated time of a task on a GPU, ms a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// At full bandwidth, with nothing else to wait for.
    pub floor_ms: f64,
    /// With instructions; `None` if no compiler for the GPU was asked.
    pub ms: Option<f64>,
}

/// Estimates a task: the sum over its dispatches, which wait for each other, of the longer of
/// bytes / bandwidth and instructions x invocations / (lanes x clock).
///
/// Left out: caches (traffic is counted once for each byte, from memory), latency and the GPU's filling and draining at each barrier,
/// issue limits, half-rate and transcendental instructions, divergence, the texture units, and the application's own work beside it.
/// Instructions are the whole program's, times the turns of its longest loop: branches that are not taken count too.
pub fn estimate(task: &Task, gpu: &Gpu, kernels: Option<&Kernels>) -> Estimate {
    let dispatches = (task.dispatches)(f64::from(gpu.tile));
    let floor_ms = dispatches.iter().map(|dispatch| memory_ms(dispatch, gpu)).sum();
    let ms = kernels.and_then(|kernels| {
        let times = dispatches.iter().map(|dispatch| dispatch_ms(dispatch, gpu, kernels));
        times.sum()
    });
    Estimate { floor_ms, ms }
}

/// Milliseconds that a dispatch's bytes take.
fn memory_ms(dispatch: &Dispatch, gpu: &Gpu) -> f64 {
    // Of GB/s, which are bytes/ns.
    dispatch.bytes / gpu.bandwidth_gb_s * 1e-6
}

/// Milliseconds of a dispatch; `None` if its entry point is not known.
fn dispatch_ms(dispatch: &Dispatch, gpu: &Gpu, kernels: &Kernels) -> Option<f64> {
    let memory_ms = memory_ms(dispatch, gpu);
    let Some(entry) = dispatch.entry else { return Some(memory_ms) };
    let instructions = kernels.of_entry(entry)?.instructions()? * dispatch.turns;
    let instructions_ms = instructions * dispatch.invocations / (gpu.lanes * gpu.clock_ghz) * 1e-6;
    Some(memory_ms.max(instructions_ms))
}

#[cfg(test)]
mod tests {
    use super::super::{Compiled, GPUS, TASKS, kept};
    use super::*;

    const GPU: Gpu = Gpu {
        name: "a GPU",
        compiler: None,
        lanes: 1000.0,
        clock_ghz: 2.0,
        bandwidth_gb_s: 100.0,
        tile: 8,
        source: "a test",
    };

    fn dispatches(_: f64) -> Vec<Dispatch> {
        let dispatch = |entry, invocations, bytes, turns| Dispatch { entry, invocations, bytes, turns };
        vec![
            // 1 ms of instructions against 0.5 of memory, 0.02 against 2, and a copy of 3.
            dispatch(Some("slow"), 1e6, 5e7, 10.0),
            dispatch(Some("slow"), 1e5, 2e8, 2.0),
            dispatch(None, 0.0, 3e8, 1.0),
        ]
    }

    const TASK: Task = Task { name: "a task", what: "a test", dispatches };

    fn kernels(entry: &str) -> Kernels {
        let compiled = Compiled {
            kernel: "a kernel".to_owned(),
            entry: entry.to_owned(),
            stage: "COMPUTE".to_owned(),
            subgroup_size: 32,
            statistics: [("Instructions".to_owned(), 200.0)].into(),
        };
        Kernels { device: "a device".to_owned(), driver: "1".to_owned(), compiled: vec![compiled] }
    }

    #[test]
    fn a_dispatch_takes_the_longer_of_memory_and_instructions() {
        let estimated = estimate(&TASK, &GPU, Some(&kernels("slow")));
        assert!((estimated.floor_ms - 5.5).abs() < 1e-9, "{estimated:?}");
        assert!((estimated.ms.unwrap() - 6.0).abs() < 1e-9, "{estimated:?}");
        assert_eq!(estimate(&TASK, &GPU, Some(&kernels("other"))).ms, None);
        assert_eq!(estimate(&TASK, &GPU, None), Estimate { ms: None, ..estimated });
    }

    #[test]
    fn each_task_has_a_figure_wherever_a_compiler_was_asked() {
        let kept = kept().unwrap();
        for gpu in &GPUS {
            let kernels =
                gpu.compiler.and_then(|device| kept.iter().find(|kernels| kernels.device == device.name()));
            assert_eq!(kernels.is_some(), gpu.compiler.is_some(), "{}", gpu.name);
            for task in &TASKS {
                let Estimate { floor_ms, ms } = estimate(task, gpu, kernels);
                assert!(floor_ms > 0.0 && floor_ms < 2.0, "{} on {}: {floor_ms}", task.name, gpu.name);
                assert_eq!(ms.is_some(), kernels.is_some(), "{} on {}", task.name, gpu.name);
                assert!(ms.is_none_or(|ms| ms >= floor_ms), "{} on {}: {ms:?}", task.name, gpu.name);
            }
        }
    }
}
