//! The pictures, and over the stand-in the maps.

use super::{Length, MAPS_VARIABLE, Rates, run_of};
use crate::HarnessError;
use crate::device::Machine;
use crate::run::Outcome;
use parafovea_test_layers::{ShadingRateLine, ShadingRatePass};
use parafovea_zoo::{SKIPPED, Style};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A style with the layer's rates beside the same style with its own.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Comparison {
    /// Maps that had a coarser rate than 1x1, of all passes of all frames.
    pub coarse_maps: usize,
    /// Pixels of the saved pictures that are not the same with the layer's rates and with the application's.
    pub differing_pixels: u64,
    /// Pixels that rates change: with the layer's rates and without any.
    pub changed_pixels: u64,
    /// Pixels of all saved pictures.
    pub pixels: u64,
    /// Over the stand-in: its findings, and passes with different areas, maps or draws, in words.
    pub findings: Vec<String>,
}

impl Comparison {
    /// Differences that must not be; empty if all is right.
    ///
    /// `is_shaded_coarsely`: rates may show in pictures, because the device has them. They show in most: pipelines with alpha to coverage
    /// stay at 1x1, with the layer and without.
    pub fn fault(&self, is_shaded_coarsely: bool) -> Option<String> {
        if let Some(finding) = self.findings.first() {
            return Some(finding.clone());
        }
        if self.differing_pixels > 0 {
            return Some(format!("{} of {} pixels differ", self.differing_pixels, self.pixels));
        }
        if self.coarse_maps == 0 {
            return Some("the layer made nothing coarser".to_owned());
        }
        let is_wrong = self.shows_rates() && !is_shaded_coarsely;
        is_wrong.then(|| format!("rates changed {} pixels", self.changed_pixels))
    }

    /// Whether the picture has coarser rates. On a device with rates, some style's has.
    pub fn shows_rates(&self) -> bool {
        self.changed_pixels > 0
    }
}

/// A line of the layer's output.
#[derive(Deserialize)]
struct Noted {
    map: Option<NotedMap>,
}

#[derive(Deserialize)]
struct NotedMap {
    rates: String,
}

/// Compares a style; returns the reason if the device cannot show it.
///
/// # Errors
/// Errors of the harness, and an application that does not finish.
pub fn compare(
    machine: &Machine,
    style: &Style,
    length: Length,
) -> Result<Result<Comparison, String>, HarnessError> {
    // The first, while nothing is known of passes; one soon after they are; the last.
    let saved = [0, length.frames / 2, length.frames - 1];
    let folder = tempfile::tempdir().map_err(HarnessError::file(&std::env::temp_dir()))?;
    let maps = folder.path().join("maps.jsonl");
    let with_layer =
        run_of(machine, style, length, &saved, Rates::Layer)?.env(MAPS_VARIABLE, &maps).finish()?;
    if let Some(lacking) = with_layer.output.lines().find_map(|line| line.strip_prefix(SKIPPED)) {
        return Ok(Err(lacking.to_owned()));
    }
    let with_layer = with_layer.expect_frames(length.frames)?;
    let finish =
        |rates| run_of(machine, style, length, &saved, rates)?.finish()?.expect_frames(length.frames);
    let (alone, native) = (finish(Rates::None)?, finish(Rates::Native(&maps))?);
    let mut comparison = Comparison {
        coarse_maps: coarse_maps(&maps)?,
        differing_pixels: 0,
        changed_pixels: 0,
        pixels: 0,
        findings: differences(&with_layer, &native)?,
    };
    for (view, frame) in saved.into_iter().flat_map(|frame| [(0, frame), (1, frame)]) {
        let [alone, layer, native] =
            [&alone, &with_layer, &native].map(|outcome| outcome.submitted(view, frame));
        let (alone, layer, native) = (alone?.pixels, layer?.pixels, native?.pixels);
        let unequal = |a: &[[u8; 4]], b: &[[u8; 4]]| {
            a.iter().zip(b).filter(|(a, b)| a != b).count() as u64 + a.len().abs_diff(b.len()) as u64
        };
        comparison.differing_pixels += unequal(&layer, &native);
        comparison.changed_pixels += unequal(&alone, &layer);
        comparison.pixels += layer.len() as u64;
    }
    Ok(Ok(comparison))
}

fn coarse_maps(file: &Path) -> Result<usize, HarnessError> {
    let text = std::fs::read_to_string(file).map_err(HarnessError::file(file))?;
    let mut coarse = 0;
    for line in text.lines() {
        let noted: Noted = serde_json::from_str(line).map_err(|error| HarnessError::format(file, error))?;
        coarse += usize::from(noted.map.is_some_and(|map| map.rates.bytes().any(|digit| digit != b'0')));
    }
    Ok(coarse)
}

/// The stand-in's findings of both, if it is present.
fn differences(with_layer: &Outcome, native: &Outcome) -> Result<Vec<String>, HarnessError> {
    let mut all = Vec::new();
    let mut passes = |outcome: &Outcome| -> Result<Vec<ShadingRatePass>, HarnessError> {
        let mut passes = Vec::new();
        for line in outcome.shading_rates()? {
            match line {
                ShadingRateLine::Pass(pass) => passes.push(pass),
                ShadingRateLine::Finding(finding) => all.push(format!("{finding:?}")),
            }
        }
        Ok(passes)
    };
    let (layers, natives) = (passes(with_layer)?, passes(native)?);
    all.extend(unequal_passes(&layers, &natives));
    Ok(all)
}

/// The passes with the layer's rates must be those with the application's own, in their order. Between them may be others at 1x1: those
/// with which the runtime saves pictures, on the application's device.
fn unequal_passes(layers: &[ShadingRatePass], natives: &[ShadingRatePass]) -> Vec<String> {
    let mut unequal = Vec::new();
    let mut left = natives.iter().peekable();
    for layer in layers {
        if left.next_if(|native| are_equal(layer, native)).is_none() && !is_1x1(layer) {
            let native = left.peek();
            unequal.push(format!("with the layer's rates {layer:?}, and with its own {native:?}"));
        }
    }
    unequal.extend(left.next().map(|native| format!("not with the layer's rates: {native:?}")));
    unequal
}

/// All but handles, and their place among all passes.
fn are_equal(a: &ShadingRatePass, b: &ShadingRatePass) -> bool {
    let what = |pass: &ShadingRatePass| ShadingRatePass {
        index: 0,
        image: String::new(),
        targets: Vec::new(),
        ..pass.clone()
    };
    what(a) == what(b)
}

fn is_1x1(pass: &ShadingRatePass) -> bool {
    pass.map.as_ref().is_some_and(|map| map.histogram.keys().all(|rate| rate == "1x1"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_test_layers::ShadingRateMap;

    fn pass(index: u64, rate: &str, draws: u32) -> ShadingRatePass {
        ShadingRatePass {
            index,
            form: "dynamic".to_owned(),
            area: [0, 0, 16, 16],
            layers: 1,
            view_mask: 0,
            formats: vec!["R8G8B8A8_SRGB".to_owned()],
            targets: vec![format!("{index:#x}")],
            draws,
            draws_obeying: draws,
            texel: [16, 16],
            image: format!("{index:#x}"),
            map: Some(ShadingRateMap {
                extent: [1, 1, 1],
                histogram: [(rate.to_owned(), 1)].into(),
                hash: rate.to_owned(),
                texels: None,
            }),
        }
    }

    #[test]
    fn differences_and_findings_are_faults() {
        let found = |differing_pixels, changed_pixels, coarse_maps| Comparison {
            coarse_maps,
            differing_pixels,
            changed_pixels,
            pixels: 100,
            findings: Vec::new(),
        };
        assert_eq!(found(0, 50, 4).fault(true), None);
        assert_eq!(found(0, 0, 4).fault(false), None, "a stand-in shades every pixel");
        assert_eq!(found(1, 50, 4).fault(true).unwrap(), "1 of 100 pixels differ");
        assert_eq!(found(0, 0, 4).fault(true), None, "all pipelines have alpha to coverage");
        for (changed, coarse, shaded) in [(50, 4, false), (50, 0, true)] {
            assert!(found(0, changed, coarse).fault(shaded).is_some());
        }
        let wrong = Comparison { findings: vec!["a finding".to_owned()], ..found(0, 50, 4) };
        assert_eq!(wrong.fault(true).unwrap(), "a finding");
    }

    #[test]
    fn passes_are_equal_in_their_order_but_for_others_at_1x1() {
        let natives = [pass(0, "1x1", 2), pass(1, "2x2", 2)];
        let others = [pass(7, "1x1", 2), pass(8, "1x1", 1), pass(9, "2x2", 2)];
        assert_eq!(unequal_passes(&others, &natives), [""; 0]);
        for wrong in [pass(9, "4x4", 2), pass(9, "1x1", 2), pass(9, "2x2", 1)] {
            assert!(!unequal_passes(&[pass(7, "1x1", 2), wrong], &natives).is_empty());
        }
        assert_eq!(unequal_passes(&natives, &natives[..1]).len(), 1, "coarser than it was to be");
        assert_eq!(unequal_passes(&natives[..1], &natives).len(), 1);
    }
}
