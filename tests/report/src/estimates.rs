//! Estimated times of the layer's own kernels on GPUs without measurements, by technique ([`parafovea_tests::drivers::kernels`]).

use crate::points::Sweep;
use parafovea_tests::drivers::kernels::{GPUS, Kernels, TASKS, estimate, kept};
use std::sync::LazyLock;

/// The tasks that a technique adds to a frame, by their names; `None` for the application's own work.
fn tasks(sweep: Sweep) -> Option<&'static [&'static str]> {
    Some(match sweep {
        Sweep::Off | Sweep::RenderScale | Sweep::FixedFoveation | Sweep::OpenXrToolkit | Sweep::Uniform => {
            return None;
        }
        // Rings are planned on the CPU.
        Sweep::Rings | Sweep::FilledFoveation => &[],
        // Presets measure contrast on GPUs.
        Sweep::Rates | Sweep::Contrast | Sweep::Sound => &["analyze", "decide", "resolve"],
        Sweep::Reuse | Sweep::RatesAndReuse => &["compose, re-use", "change"],
        Sweep::Everything => &["analyze", "decide", "resolve", "compose, re-use", "change"],
        Sweep::Chroma => &["compose, chroma"],
    })
}

/// The least and the greatest estimate for a technique over all GPUs that there is one for, ms a frame of 2 x 2160 x 2160 pixels.
fn estimated_ms(sweep: Sweep, all: &[Kernels]) -> Option<[f64; 2]> {
    let wanted = tasks(sweep)?;
    let on_gpu = GPUS.iter().filter_map(|gpu| {
        let kernels =
            all.iter().find(|kernels| gpu.compiler.is_some_and(|device| device.name() == kernels.device))?;
        let tasks = TASKS.iter().filter(|task| wanted.contains(&task.name));
        tasks.map(|task| estimate(task, gpu, Some(kernels)).ms).sum::<Option<f64>>()
    });
    on_gpu.map(|ms| [ms; 2]).reduce(|[least, most], [ms, _]| [least.min(ms), most.max(ms)])
}

/// The GPUs with estimates, for people.
pub fn gpus() -> String {
    let names = GPUS.iter().filter(|gpu| gpu.compiler.is_some()).map(|gpu| gpu.name);
    names.collect::<Vec<_>>().join(", ")
}

/// The cell of a technique.
pub fn cell(sweep: Sweep) -> String {
    static KEPT: LazyLock<Vec<Kernels>> = LazyLock::new(|| kept().unwrap_or_default());
    estimated_ms(sweep, &KEPT).map_or("-".to_owned(), |[least, most]| format!("~{least:.2} to {most:.2}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_technique_of_the_layer_has_an_estimate_of_known_tasks() {
        let known: Vec<&str> = TASKS.iter().map(|task| task.name).collect();
        let all = kept().unwrap();
        for sweep in Sweep::ALL {
            let tasks = tasks(sweep);
            assert!(tasks.unwrap_or_default().iter().all(|task| known.contains(task)), "{sweep:?}");
            let ms = estimated_ms(sweep, &all);
            assert_eq!(ms.is_some(), tasks.is_some(), "{sweep:?}");
            let has_work = tasks.is_some_and(|tasks| !tasks.is_empty());
            assert!(
                ms.is_none_or(|[least, most]| least <= most && (least > 0.0) == has_work),
                "{sweep:?}: {ms:?}"
            );
        }
        assert_eq!(estimated_ms(Sweep::Chroma, &[]), None);
    }
}
