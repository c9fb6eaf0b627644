//! The share of the pixels that FR of the paper shades for the loss of the layer's presets.

use crate::points::Sweep;
use crate::results::{PointResults, SceneResults, mean};
use crate::statistics::{CostAndLoss, cost_at};
use crate::verdict::Measure;

/// The compared losses.
const MEASURES: [Measure; 2] = [Measure::Detected, Measure::Mean];

/// Shares of one technique of the layer, over the scenes.
#[derive(Clone, Debug, PartialEq)]
pub struct EqualLoss {
    /// The technique.
    pub technique: String,
    /// The measure of the equal loss.
    pub measure: Measure,
    /// FR's share of shaded pixels over the technique's: the geometric mean of the scenes.
    pub ratio: f64,
    /// The least of the scenes.
    pub least: f64,
}

/// FR of the paper at the loss of each preset, and of each point with sound, in all scenes in which both were measured.
pub fn at_equal_loss(scenes: &[SceneResults]) -> Vec<EqualLoss> {
    let first = scenes.first().into_iter().flat_map(|scene| &scene.points);
    let ours = first.filter(|point| matches!(point.sweep, Sweep::Rates | Sweep::Sound));
    let of_technique = |point: &PointResults| MEASURES.map(|measure| (point.technique.clone(), measure));
    ours.flat_map(of_technique)
        .filter_map(|(technique, measure)| {
            let ratios: Vec<f64> =
                scenes.iter().filter_map(|scene| ratio(scene, &technique, measure)).collect();
            Some(EqualLoss {
                ratio: mean(ratios.iter().map(|ratio| ratio.ln()))?.exp(),
                least: ratios.iter().copied().fold(f64::INFINITY, f64::min),
                technique,
                measure,
            })
        })
        .collect()
}

fn ratio(scene: &SceneResults, technique: &str, measure: Measure) -> Option<f64> {
    let of_point = |point: &PointResults| {
        let cost = point.cost.as_ref()?.ratio;
        Some(CostAndLoss { cost, loss: measure.of_point(point)? })
    };
    let ours = of_point(scene.point(technique)?)?;
    let fixed: Vec<_> = scene.sweep(Sweep::FixedFoveation).into_iter().filter_map(of_point).collect();
    // The application alone is a part of every sweep.
    (fixed.len() > 1).then(|| cost_at(&fixed, ours.loss))?.map(|cost| cost / ours.cost)
}
