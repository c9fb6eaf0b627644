//! Advice on techniques for an application, in words, from measurements.

use crate::results::{Results, mean};
use crate::summary::{Row, mean_rows};
use crate::verdict::EVERYTHING;

/// Ratio of time, or of bits, below which a technique counts as a gain: a smaller one is within the difference of two runs, and no reason
/// to accept a loss.
const GAIN: f64 = 0.95;

/// One kind of application.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Advice {
    /// Description of the application.
    pub application: &'static str,
    /// The setting.
    pub setting: String,
    /// The measurement behind it.
    pub measured: String,
}

/// Advice from `results`, and from committed results of GPUs.
pub fn advice(results: &Results, gpus: &[Results]) -> Vec<Advice> {
    let rows = mean_rows(results);
    let row = |name: &str| rows.iter().find(|row| row.technique == name);
    vec![
        on_a_gpu(row("preset balanced"), gpus),
        by_the_mask(results, row("preset balanced")),
        streamed(results, row("chroma")),
        reused(row("re-use 11223").or(row(EVERYTHING)), row("preset balanced")),
        Advice {
            application: "Limited by its own work on the CPU, or by few and cheap pixels",
            setting: "nothing: run it without the layer".to_owned(),
            measured: "the layer saves shaded pixels; `cargo dev bench break-even` measures the pixel cost above which that saves time"
                .to_owned(),
        },
    ]
}

fn on_a_gpu(rates: Option<&Row>, gpus: &[Results]) -> Advice {
    let measured = gpus.iter().filter(|results| !results.conditions.device_is_cpu).find_map(|results| {
        let rows = mean_rows(results);
        let ratio = rows.iter().find(|row| row.technique == "preset balanced")?.ratio?;
        Some((ratio, format!("{ratio:.2} times the GPU time on {}", results.conditions.device)))
    });
    let shades = rates.and_then(|row| row.samples.map(|samples| (samples, row.loss)));
    let (setting, measured) = match (measured, shades) {
        (Some((ratio, text)), _) if ratio < GAIN => (BALANCED, text),
        (Some((_, text)), _) => ("nothing: the layer saves no time there", text),
        (None, Some((samples, loss))) => (
            BALANCED,
            format!(
                "no GPU yet; the same map shades {samples:.2} of the samples here, with a loss of {loss:.2} JND"
            ),
        ),
        (None, None) => (BALANCED, "no GPU yet".to_owned()),
    };
    Advice {
        application: "Limited by its pixels, on a GPU with VK_KHR_fragment_shading_rate",
        setting: setting.to_owned(),
        measured,
    }
}

const BALANCED: &str = "preset = \"balanced\", which is the default";

fn by_the_mask(results: &Results, rates: Option<&Row>) -> Advice {
    let ratio = rates.and_then(|row| row.ratio).filter(|_| results.conditions.backend == "mask");
    let (setting, measured) = match ratio {
        Some(ratio) if ratio < GAIN => (BALANCED, format!("{ratio:.2} times the time here, with the mask")),
        Some(ratio) => ("rates.mode = \"off\"", format!("{ratio:.2} times the time here, with the mask")),
        None => (BALANCED, "not measured here; rates.gate drops it if it causes a slowdown".to_owned()),
    };
    Advice {
        application: "Limited by its pixels, on a device without that extension, or on a CPU",
        setting: setting.to_owned(),
        measured,
    }
}

fn streamed(results: &Results, chroma: Option<&Row>) -> Advice {
    let bits = || results.scenes.iter().flat_map(|scene| &scene.bits);
    let codec =
        ["H.264 4:2:0", "JPEG 4:2:0"].into_iter().find(|codec| bits().any(|bits| bits.codec == *codec));
    let saved = codec.and_then(|codec| {
        let of_codec = || bits().filter(|bits| bits.codec == codec);
        Some((codec, mean(of_codec().map(|bits| bits.total))?, mean(of_codec().map(|bits| bits.chroma))?))
    });
    let (setting, measured) = match (saved, chroma) {
        (Some((codec, total, of_chroma)), Some(row)) => (
            if 1.0 + total < GAIN { "preset = \"streaming\"" } else { "chroma.mode = \"off\"" },
            format!(
                "attenuation changes all bits by {:+.1} %, those of chroma by {:+.1} %, at equal PSNR of luma ({codec}), for {:.2} JND of colour",
                100.0 * total,
                100.0 * of_chroma,
                row.chroma.unwrap_or(f64::NAN)
            ),
        ),
        _ => ("chroma.mode = \"off\"", "bits were not measured".to_owned()),
    };
    Advice {
        application: "Streamed to the headset as video (WiVRn, ALVR, Steam Link)",
        setting: setting.to_owned(),
        measured,
    }
}

/// Re-use alone, or everything, where that was not measured alone.
fn reused(reuse: Option<&Row>, rates: Option<&Row>) -> Advice {
    let ratio = |row: Option<&Row>| row.and_then(|row| row.ratio);
    let (setting, measured) = match (reuse, ratio(reuse), ratio(rates)) {
        (Some(row), Some(own), _) if own >= GAIN => (
            "reuse.mode = \"off\", which is the default",
            format!("{} takes {own:.2} times as long", row.technique),
        ),
        (Some(row), Some(own), Some(rates)) if own >= rates => (
            "reuse.mode = \"off\", which is the default: rates save more",
            format!("{} takes {own:.2} times as long, rates alone {rates:.2}", row.technique),
        ),
        (Some(row), Some(own), _) => (
            "reuse.mode = \"on\"",
            format!("{} takes {own:.2} times as long, with a loss of {:.2} JND", row.technique, row.loss),
        ),
        _ => ("reuse.mode = \"off\", which is the default", "not measured".to_owned()),
    };
    Advice {
        application: "Seated, with a mostly still head and an expensive periphery (a cockpit, a cinema)",
        setting: setting.to_owned(),
        measured,
    }
}
