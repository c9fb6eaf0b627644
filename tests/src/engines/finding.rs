//! An engine without the layer and with it.

use super::engine::{Engine, Mode, Settings};
use super::seen::Seen;
use super::system::{System, Watch};
use crate::HarnessError;
use crate::demo::{Cost, Decision};
use crate::measure::{Ratio, Samples};
use serde::Serialize;

/// What an engine's frames cost without the layer and with it, for one gate.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// The engine with its renderer.
    pub app: String,
    /// `rates.gate`.
    pub gate: &'static str,
    /// Width and height of an eye's picture, pixels.
    pub eye: [u32; 2],
    /// Timed frames in each mode, all turns together.
    pub frames: usize,
    /// Without the layer.
    pub off: Cost,
    /// With it.
    pub on: Cost,
    /// CPU time with the layer, in units of that without it.
    pub ratio: f64,
    /// Half of the interquartile range of the turns' ratios.
    pub spread: f64,
    /// Share of the CPU time without the layer that goes with the picture's size: fragment shading, and all else that is done for pixels.
    pub pixel_share: f64,
    /// Whether any pass is shaded coarsely.
    pub engaged: bool,
    /// The layer's decision, for people.
    pub reason: String,
    /// How shading becomes coarser: "mask", "rate attachment" or "none".
    pub backend: String,
    /// Passes that were recognised as the scene.
    pub passes: Vec<String>,
    /// Reasons for which scene passes were left alone.
    pub refusals: Vec<String>,
    /// Rules that validation found broken with the preset, or with everything on, in ways in which they are not without the layer.
    pub messages: Vec<String>,
}

/// Times, counts and validates an engine: a finding for the gate that decides, and one for the open gate.
///
/// # Errors
/// An engine that does not come to its end.
pub fn judge(system: &System, engine: Engine, scale: u32, turns: u32) -> Result<Vec<Finding>, HarnessError> {
    const MODES: [Mode; 3] = [Mode::Off, Mode::Auto, Mode::On];
    let mut samples: [Samples; 3] = Default::default();
    let mut last: [Seen; 3] = Default::default();
    for turn in 0..turns {
        for (index, mode) in MODES.into_iter().enumerate() {
            eprintln!("{}: turn {} of {turns}, {}", engine.name(), turn + 1, mode.name());
            let seen = system.run(engine, mode, &Settings::timed(scale, mode), Watch::Time)?;
            samples[index].push(seen.cpu_ms.clone());
            last[index] = seen;
        }
    }
    let small = Settings { scale: SMALL, ..Settings::timed(scale, Mode::Off) };
    eprintln!("{}: small pictures", engine.name());
    let small = system.run(engine, Mode::Off, &small, Watch::Time)?;
    let [off, on] = [Mode::Off, Mode::On].map(|mode| {
        eprintln!("{}: counting samples, {}", engine.name(), mode.name());
        system.run(engine, mode, &Settings::counted(scale), Watch::Samples)
    });
    let counted = [off?.samples, on?.samples];
    let messages = messages(system, engine)?;
    let mut findings = Vec::new();
    for (index, mode) in [(1, Mode::Auto), (2, Mode::On)] {
        let Ratio { value, spread } = samples[index].ratio_to(&samples[0]);
        let seen = &last[index];
        let Decision { engaged, decided } = Decision::of(seen.status.as_ref());
        let off_ms = samples[0].median();
        findings.push(Finding {
            app: engine.name(),
            gate: mode.name(),
            eye: seen.eye,
            frames: samples[index].len() * Settings::timed(scale, mode).frames as usize,
            off: Cost { cpu_ms: off_ms, samples: counted[0] },
            on: Cost {
                cpu_ms: samples[index].median(),
                samples: if engaged { counted[1] } else { counted[0] },
            },
            ratio: value,
            spread,
            pixel_share: 1.0 - mean(&small.cpu_ms) / off_ms,
            engaged,
            reason: decided,
            backend: seen.status.as_ref().map_or_else(String::new, |status| status.backend.clone()),
            passes: seen.scene_passes(),
            refusals: seen.refusals(),
            messages: messages.clone(),
        });
    }
    Ok(findings)
}

/// A scale at which hardly any time goes with pixels: 64x48.
const SMALL: u32 = 20;

/// Rules that are broken with the layer and not without it.
fn messages(system: &System, engine: Engine) -> Result<Vec<String>, HarnessError> {
    let validated = |mode: Mode| {
        eprintln!("{}: validation, {}", engine.name(), mode.name());
        system.run(engine, mode, &Settings::validated(), Watch::Validation)
    };
    let without = validated(Mode::Off)?;
    let mut found = Vec::new();
    for mode in [Mode::On, Mode::Everything] {
        let new = validated(mode)?.broken_beyond(&without);
        found.extend(new.into_iter().map(|rule| format!("{}: {rule}", mode.name())));
    }
    Ok(found)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Prints a table in Markdown, and what was decided below it.
pub fn print_table(findings: &[Finding]) {
    println!(
        "| engine | gate | eye | pixels' share | CPU ms off | on | ratio | samples off | on | engaged | messages |"
    );
    println!("|---|---|---|---:|---:|---:|---:|---:|---:|---|---:|");
    let count = |samples: Option<u64>| samples.map_or("–".to_owned(), |samples| samples.to_string());
    for finding in findings {
        println!(
            "| {} | {} | {}x{} | {:.2} | {:.0} | {:.0} | {:.2} ± {:.2} | {} | {} | {} | {} |",
            finding.app,
            finding.gate,
            finding.eye[0],
            finding.eye[1],
            finding.pixel_share,
            finding.off.cpu_ms,
            finding.on.cpu_ms,
            finding.ratio,
            finding.spread,
            count(finding.off.samples),
            count(finding.on.samples),
            if finding.engaged { "yes" } else { "no" },
            finding.messages.len(),
        );
    }
    for finding in findings {
        println!("\n{}, gate {}: {}", finding.app, finding.gate, finding.reason);
        finding.passes.iter().for_each(|pass| println!("    recognised: {pass}"));
        finding.refusals.iter().for_each(|reason| println!("    left alone: {reason}"));
        finding.messages.iter().for_each(|message| println!("    validation: {message}"));
    }
}
