//! An engine without the layer and with it.

use super::engine::{Engine, Mode, Settings};
use super::pictures::Errors;
use super::rates::shown_at_rates;
use super::seen::Seen;
use super::system::{System, Watch};
use crate::HarnessError;
use crate::demo::{Cost, Decision};
use crate::measure::{Ratio, Samples};
use parafovea_models::errors::{Clip, RING_NAMES};
use serde::Serialize;
use std::fs;

/// Cost of an engine's frames with and without the layer, for one gate.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// The engine with its renderer.
    pub app: String,
    /// `rates.gate`.
    pub gate: &'static str,
    /// Width and height of an eye buffer, pixels.
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
    /// Backend of coarse shading: "mask", "rate attachment" or "none".
    pub backend: String,
    /// Passes that were recognised as the scene.
    pub passes: Vec<String>,
    /// Reasons for which scene passes were left alone.
    pub refusals: Vec<String>,
    /// Frames a second at the end, by the layer's status, Hz; 0 where that is not known.
    pub frame_rate_hz: f32,
    /// The safety limits in the text of `parafovea status`.
    pub limits: Vec<String>,
    /// Processes of the machine that ran or waited, on average from the first timed run to the last (proc(5), loadavg); None where that is not
    /// known.
    pub load: Option<f64>,
    /// Differences of the images of each look from those without the layer.
    pub pictures: Vec<Errors>,
    /// Rules that validation found broken with the preset, or with everything on, in ways in which they are not without the layer; None where
    /// that was not checked.
    pub messages: Option<Vec<String>>,
}

/// Checks of an engine beside its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checks {
    /// Number of shaded samples.
    pub samples: bool,
    /// Differences of images from those without the layer.
    pub pictures: bool,
    /// Messages of validation.
    pub messages: bool,
}

impl Checks {
    /// All of it.
    pub const ALL: Self = Self { samples: true, pictures: true, messages: true };

    /// All checks except the named ones, separated by commas.
    ///
    /// # Errors
    /// A name that is unknown.
    pub fn without(named: &str) -> Result<Self, String> {
        let mut checks = Self::ALL;
        for name in named.split(',') {
            match name {
                "samples" => checks.samples = false,
                "pictures" => checks.pictures = false,
                "messages" => checks.messages = false,
                unknown => return Err(unknown.to_owned()),
            }
        }
        Ok(checks)
    }
}

/// Times an engine in turns with pictures of a size ([`Settings::scale`]), and checks it: a finding for the gate that decides, and one for the
/// open gate.
///
/// # Errors
/// An engine that does not finish.
pub fn judge(
    system: &System,
    engine: Engine,
    (scale, turns): (u32, u32),
    checks: Checks,
) -> Result<Vec<Finding>, HarnessError> {
    const MODES: [Mode; 3] = [Mode::Off, Mode::Auto, Mode::On];
    let mut samples: [Samples; 3] = Default::default();
    let mut last: [Seen; 3] = Default::default();
    let mut loads = Vec::new();
    for turn in 0..turns {
        for (index, mode) in MODES.into_iter().enumerate() {
            eprintln!("{}: turn {} of {turns}, {}", engine.name(), turn + 1, mode.name());
            let seen = system.run(engine, mode, &Settings::timed(scale, engine.scene, mode), Watch::Time)?;
            samples[index].push(seen.cpu_ms.clone());
            last[index] = seen;
            loads.extend(load());
        }
    }
    let small = Settings { scale: SMALL, ..Settings::timed(scale, engine.scene, Mode::Off) };
    eprintln!("{}: small pictures", engine.name());
    let small = system.run(engine, Mode::Off, &small, Watch::Time)?;
    let count = |mode: Mode| {
        eprintln!("{}: counting samples, {}", engine.name(), mode.name());
        system.run(engine, mode, &Settings::counted(scale), Watch::Samples).map(|seen| seen.samples)
    };
    let counted = if checks.samples { [count(Mode::Off)?, count(Mode::On)?] } else { [None; 2] };
    // Errors are judged around a gaze at the centre of the view.
    let pictures =
        if checks.pictures && !engine.is_tracked { pictures(system, engine, scale)? } else { Vec::new() };
    let messages = if checks.messages { Some(messages(system, engine)?) } else { None };
    let mut findings = Vec::new();
    for (index, mode) in [(1, Mode::Auto), (2, Mode::On)] {
        let Ratio { value, spread } = samples[index].ratio_to(&samples[0]);
        let seen = &last[index];
        let Decision { engaged, decided } = Decision::of(seen.status.as_ref());
        let off_ms = samples[0].median();
        findings.push(Finding {
            app: engine.name(),
            gate: mode.name(),
            eye: Settings::timed(scale, engine.scene, mode).eye(),
            frames: samples[index].len() * Settings::timed(scale, engine.scene, mode).frames as usize,
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
            frame_rate_hz: seen.status.as_ref().map_or(0.0, |status| status.frame_rate_hz),
            limits: seen.limits(),
            load: (!loads.is_empty()).then(|| mean(&loads)),
            pictures: pictures.clone(),
            messages: messages.clone(),
        });
    }
    Ok(findings)
}

/// Processes that ran or waited in the last minute.
fn load() -> Option<f64> {
    fs::read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.parse().ok()
}

/// A scale at which hardly any time goes with pixels: 64x48.
const SMALL: u32 = 20;

/// Differences from images without the layer: of another run without it, which shows the variation between runs, of masks, and of a device
/// with shading rates; and of masks from the last.
fn pictures(system: &System, engine: Engine, scale: u32) -> Result<Vec<Errors>, HarnessError> {
    let settings = Settings::pictured(scale);
    let clip = |look: &str, mode: Mode| {
        eprintln!("{}: pictures, {look}", engine.name());
        system.run(engine, mode, &settings, Watch::Pictures)?;
        system.pictures(settings.frames - 1)
    };
    let reference = clip("off", Mode::Off)?;
    let wrong = |look: &str, reason| HarnessError::Application {
        application: format!("{}, {look}", engine.name()),
        reason,
        output: String::new(),
    };
    let errors =
        |look, from: &Clip, shown: &Clip| Errors::of(look, from, shown).map_err(|reason| wrong(look, reason));
    let again = clip("off again", Mode::Off)?;
    let mut looks = vec![errors("off again", &reference, &again)?];
    let mask = clip("mask", Mode::On)?;
    looks.push(errors("mask", &reference, &mask)?);
    if let Some(rates) = shown_at_rates(&reference, engine.preset) {
        looks.push(errors("rates", &reference, &rates)?);
        looks.push(errors("mask from rates", &rates, &mask)?);
    }
    Ok(looks)
}

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

/// Prints a table in Markdown, and the decisions below it.
pub fn print_table(findings: &[Finding]) {
    println!(
        "| engine | gate | eye | pixels' share | CPU ms off | on | ratio | Hz | load | samples off | on | engaged | messages |"
    );
    println!("|---|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---|---:|");
    let count = |samples: Option<u64>| samples.map_or("–".to_owned(), |samples| samples.to_string());
    for finding in findings {
        println!(
            "| {} | {} | {}x{} | {:.2} | {:.0} | {:.0} | {:.2} ± {:.2} | {:.0} | {} | {} | {} | {} | {} |",
            finding.app,
            finding.gate,
            finding.eye[0],
            finding.eye[1],
            finding.pixel_share,
            finding.off.cpu_ms,
            finding.on.cpu_ms,
            finding.ratio,
            finding.spread,
            finding.frame_rate_hz,
            finding.load.map_or("–".to_owned(), |load| format!("{load:.0}")),
            count(finding.off.samples),
            count(finding.on.samples),
            if finding.engaged { "yes" } else { "no" },
            finding.messages.as_ref().map_or("–".to_owned(), |messages| messages.len().to_string()),
        );
    }
    print_pictures(findings);
    for finding in findings {
        println!("\n{}, gate {}: {}", finding.app, finding.gate, finding.reason);
        finding.passes.iter().for_each(|pass| println!("    recognised: {pass}"));
        finding.refusals.iter().for_each(|reason| println!("    unchanged: {reason}"));
        finding.limits.iter().for_each(|limit| println!("    safety limit: {limit}"));
        finding.messages.iter().flatten().for_each(|message| println!("    validation: {message}"));
    }
}

/// Prints the differences of images with and without the layer, if any were compared.
fn print_pictures(findings: &[Finding]) {
    if findings.iter().all(|finding| finding.pictures.is_empty()) {
        return;
    }
    println!("\n| engine | look | by ring | {} | view | detected |", RING_NAMES.join(" | "));
    println!("|---|---|---|{}---:|---:|", "---:|".repeat(RING_NAMES.len()));
    let ring = |(_, value): &(&str, Option<f64>), digits: usize| {
        value.map_or("–".to_owned(), |value| format!("{value:.digits$}"))
    };
    // Both gates have the same.
    for finding in findings.iter().filter(|finding| finding.gate == Mode::On.name()) {
        for errors in &finding.pictures {
            let psnr: Vec<_> = errors.psnr_db.iter().map(|found| ring(found, 1)).collect();
            let jnd: Vec<_> = errors.jnd.iter().map(|found| ring(found, 2)).collect();
            let Errors { look, jnd_view, jnd_detected, .. } = errors;
            println!("| {} | {look} | PSNR, dB | {} | – | – |", finding.app, psnr.join(" | "));
            println!(
                "| {} | {look} | JND | {} | {jnd_view:.2} | {jnd_detected:.2} |",
                finding.app,
                jnd.join(" | ")
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checks_are_left_out_by_their_names() {
        let timed = Checks { samples: false, pictures: true, messages: false };
        assert_eq!(Checks::without("samples,messages"), Ok(timed));
        assert_eq!(Checks::without("samples,picture"), Err("picture".to_owned()));
    }
}
