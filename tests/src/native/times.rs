//! GPU times of frames.

use super::{Length, MAPS_VARIABLE, Rates, run_of};
use crate::HarnessError;
use crate::device::Machine;
use crate::measure::{Ratio, Samples};
use parafovea_zoo::Style;
use serde::{Deserialize, Serialize};

/// Medians of the time on the GPU, milliseconds a frame, and how they compare with no rates at all.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// Without rates.
    pub off_ms: f64,
    /// With the layer's.
    pub layer_ms: f64,
    /// With the same, set by the application.
    pub native_ms: f64,
    /// With the layer attached, and all at 1x1.
    pub attached_ms: f64,
    /// In times of `off_ms`, each with half of the range of the turns' middle half.
    pub layer: [f64; 2],
    /// As above.
    pub native: [f64; 2],
    /// As above: the cost of being ready.
    pub attached: [f64; 2],
}

/// Times a style, turn by turn, in an order that is reversed from turn to turn.
///
/// # Errors
/// Errors of the harness, an application that does not finish, and a device without timestamps.
pub fn time(machine: &Machine, style: &Style, length: Length, turns: usize) -> Result<Times, HarnessError> {
    let folder = tempfile::tempdir().map_err(HarnessError::file(&std::env::temp_dir()))?;
    let maps = folder.path().join("maps.jsonl");
    let noted = run_of(machine, style, length, &[], Rates::Layer)?.env(MAPS_VARIABLE, &maps);
    noted.finish()?.expect_frames(length.frames)?;
    let cases = [Rates::None, Rates::Layer, Rates::Native(&maps), Rates::Attached];
    let mut samples: [Samples; 4] = Default::default();
    for turn in 0..turns {
        let mut order = [0, 1, 2, 3];
        if turn % 2 == 1 {
            order.reverse();
        }
        for index in order {
            let run = run_of(machine, style, length, &[], cases[index])?.gpu_timed();
            samples[index]
                .push(run.finish()?.expect_frames(length.frames)?.gpu_ms_of_frames(length.frames / 10)?);
        }
    }
    let [off, layer, native, attached] = &samples;
    let ratio = |of: &Samples| {
        let Ratio { value, spread } = of.ratio_to(off);
        [value, spread]
    };
    Ok(Times {
        off_ms: off.median(),
        layer_ms: layer.median(),
        native_ms: native.median(),
        attached_ms: attached.median(),
        layer: ratio(layer),
        native: ratio(native),
        attached: ratio(attached),
    })
}
