//! The other layers that games get, and where Parafovea stands among them.
//!
//! Both loaders call layers in the order in which they find them, the first nearest to the application (OpenXR: `loader_instance.cpp`;
//! Vulkan: `LoaderInterfaceArchitecture.md`, "Overall order of layers").

use super::layers::{Layer, Layers};
use super::manifests::called;
use super::{Finding, Surroundings};
use crate::json::Half;

/// Parts of the names of layers that change shading rates or the number of views as well.
const RIVALS: [&str; 5] = ["foveat", "fdm_injection", "quad_views", "quad-views", "quadviews"];

pub(super) fn examine(surroundings: &Surroundings, layers: &Layers) -> Vec<Finding> {
    Half::BOTH.iter().flat_map(|half| of_half(surroundings, layers, *half)).collect()
}

fn of_half(surroundings: &Surroundings, layers: &Layers, half: Half) -> Vec<Finding> {
    let enabled: Vec<&Layer> = layers
        .of(half)
        .iter()
        .flat_map(|manifest| manifest.layers())
        .filter(|layer| layer.is_enabled(surroundings))
        .collect();
    let Some(ours) = enabled.iter().position(|layer| layer.name == half.layer_name()) else {
        return Vec::new();
    };
    let name = called(half);
    let mut findings = Vec::new();
    let others = || enabled.iter().filter(|layer| layer.name != half.layer_name());
    for rival in others().filter(|layer| is_rival(&layer.name)) {
        findings.push(
            Finding::warning(
                "rival-layer",
                format!("the {name} layer {} is enabled too", rival.name),
                "Its name suggests that it also sets shading rates: the two layers may conflict.",
            )
            .advise(turn_off(rival)),
        );
    }
    let nearer: Vec<&str> =
        enabled[..ours].iter().map(|layer| layer.name.as_str()).filter(|other| !is_rival(other)).collect();
    let farther: Vec<&str> = enabled[ours..]
        .iter()
        .skip(1)
        .map(|layer| layer.name.as_str())
        .filter(|other| *other != half.layer_name())
        .collect();
    if half == Half::OpenXr && !nearer.is_empty() {
        findings.push(
            Finding::warning(
                "layer-order",
                format!("OpenXR layers between game and Parafovea: {}", nearer.join(", ")),
                "Parafovea does not know their changes to views and images: its shading rates may be misplaced.",
            )
            .advise("if the coarse area is misplaced, turn these layers off one by one; the loader finds their manifests before Parafovea's, which is in your home"),
        );
    } else if !nearer.is_empty() || !farther.is_empty() {
        let all = [nearer, vec!["Parafovea"], farther].concat().join(", ");
        findings.push(Finding::note(
            "other-layers",
            format!("{name} layers, in order from the game: {all}"),
            "",
        ));
    }
    findings
}

fn is_rival(name: &str) -> bool {
    let name = name.to_lowercase();
    RIVALS.iter().any(|rival| name.contains(rival))
}

fn turn_off(layer: &Layer) -> String {
    match layer.disable.first() {
        Some(variable) => format!("start the game with {variable}=1, or without Parafovea"),
        None => "uninstall one of them".to_owned(),
    }
}
