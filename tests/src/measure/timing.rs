//! Timed runs.

use super::{Samples, Subject, Technique, side_by_side};
use crate::HarnessError;
use crate::run::Outcome;

/// Amount of measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Number of turns of each technique.
    pub turns: usize,
    /// Frames before those, in which caches fill and adaptive parts settle.
    pub run_up: u64,
    /// Frames of a turn that count.
    pub frames: u64,
    /// Side of an eye's image, pixels.
    pub size: u32,
}

/// Run-up with the layer: a pass is recognised after some frames, and from full rate to 4x4 rates take a second, 90 frames.
pub const LAYER_RUN_UP: u64 = 108;

impl Effort {
    /// The same frames, with no more of a run-up than a technique needs.
    pub fn of(self, technique: &Technique) -> Self {
        let run_up = if technique.has_layer() { self.run_up } else { self.run_up.min(RUN_UP_ALONE) };
        Self { run_up, ..self }
    }

    /// All frames of a turn.
    pub fn length(self) -> u64 {
        self.run_up + self.frames
    }
}

/// Run-up without the layer: shaders are compiled and caches filled, and nothing adapts.
pub const RUN_UP_ALONE: u64 = 4;

/// Cost of one technique.
#[derive(Clone, Debug)]
pub struct Timing {
    /// [`Technique::name`].
    pub technique: String,
    /// Whether the layer was on.
    pub with_layer: bool,
    /// CPU time of the application's process, milliseconds a frame. On a CPU device this is rendering too.
    pub cpu_ms: Samples,
    /// Time on the GPU of the command buffers of the application and the layer, milliseconds a frame; empty where they
    /// were not asked for, as on a CPU, whose time is [`Self::cpu_ms`].
    pub gpu_ms: Samples,
    /// Fragment shader invocations of a frame that the application caused, by pipeline statistics; the layer's own are
    /// not among them. lavapipe 22.3.6 counts those too that an early depth test rejects.
    pub fragments: u64,
    /// Samples of a frame that passed the depth test in the application's render passes: the shaded samples if the driver tests early. None
    /// where the application has occlusion queries itself.
    pub samples: Option<u64>,
}

impl Timing {
    /// Counts alone, without times.
    pub fn new(technique: &Technique, counts: Counts) -> Self {
        Self {
            technique: technique.name.clone(),
            with_layer: technique.has_layer(),
            cpu_ms: Samples::default(),
            gpu_ms: Samples::default(),
            fragments: counts.fragments,
            samples: counts.samples,
        }
    }
}

/// Shaded fragments or samples of a run in the mean of the frames after its run-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// As [`Timing::fragments`].
    pub fragments: u64,
    /// As [`Timing::samples`].
    pub samples: Option<u64>,
}

impl Counts {
    /// Of a run that was [`counted`](crate::run::Run::counted).
    ///
    /// # Errors
    /// Where fragments could not be counted.
    pub fn of(outcome: &Outcome, effort: Effort) -> Result<Self, HarnessError> {
        let of_a_frame = |all: u64| all / effort.frames.max(1);
        Ok(Self {
            fragments: of_a_frame(outcome.fragments_after(effort.run_up)?),
            samples: outcome.samples_after(effort.run_up).ok().map(of_a_frame),
        })
    }
}

/// Times all `techniques` on `subject`, the first of which is the baseline: in each turn all run side by side, a frame each
/// ([`side_by_side`]), so that other work of the machine affects all alike. The runtime composites nothing. With `with_gpu` the GPU's
/// timestamps are taken too.
///
/// `progress` is called before every run.
///
/// # Errors
/// Errors of the harness, and an application that does not finish.
pub fn time(
    subject: &Subject,
    techniques: &[Technique],
    effort: Effort,
    with_gpu: bool,
    mut progress: impl FnMut(&str),
) -> Result<Vec<Timing>, HarnessError> {
    let mut timings = Vec::new();
    for technique in techniques {
        progress(&format!("{}: {}, counting fragments", subject.name(), technique.name));
        let outcome = subject.run(technique, effort)?.counted().finish()?.expect_frames(effort.length())?;
        timings.push(Timing::new(technique, Counts::of(&outcome, effort)?));
    }
    take_turns(subject, techniques, effort, with_gpu, &mut timings, progress)?;
    Ok(timings)
}

/// The turns of [`time`], added to `timings`, which has one for each of `techniques`.
///
/// # Errors
/// As for [`time`].
pub fn take_turns(
    subject: &Subject,
    techniques: &[Technique],
    effort: Effort,
    with_gpu: bool,
    timings: &mut [Timing],
    mut progress: impl FnMut(&str),
) -> Result<(), HarnessError> {
    for turn in 0..effort.turns {
        let outcomes = side_by_side(subject, techniques, effort, with_gpu, |technique| {
            progress(&format!("{}: {}, turn {}", subject.name(), technique.name, turn + 1));
        })?;
        for ((outcome, technique), timing) in outcomes.iter().zip(techniques).zip(timings.iter_mut()) {
            let run_up = effort.of(technique).run_up;
            timing.cpu_ms.push(outcome.record.cpu_ms_of_frames(run_up));
            if with_gpu {
                timing.gpu_ms.push(outcome.gpu_ms_of_frames(run_up)?);
            }
        }
    }
    Ok(())
}
