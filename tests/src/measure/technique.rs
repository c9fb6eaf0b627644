//! Techniques on an application, and alternatives of a user.

use crate::run::LayerMode;
use parafovea_core::fixed_foveation::FixedFoveation;
use std::path::{Path, PathBuf};

/// One way to run an application.
#[derive(Clone, Debug, PartialEq)]
pub struct Technique {
    /// Its name in tables and results.
    pub name: String,
    /// The layer.
    pub layer: LayerMode,
    /// Its library, where that is of another build.
    pub library: Option<PathBuf>,
    /// Side of the application's images, as a part of the runtime's recommendation.
    pub render_scale: f32,
    /// Further arguments of the application.
    pub arguments: Vec<String>,
    /// Whether the layer captures the sound of the scene. It is played in real time, regardless of the runtime's clock.
    pub hears: bool,
}

impl Technique {
    /// The application alone.
    pub fn off() -> Self {
        Self {
            name: "off".to_owned(),
            layer: LayerMode::Absent,
            library: None,
            render_scale: 1.0,
            arguments: Vec::new(),
            hears: false,
        }
    }

    /// The layer with this configuration.
    pub fn layer(name: &str, config: &str) -> Self {
        Self { name: name.to_owned(), layer: LayerMode::On(config.to_owned()), ..Self::off() }
    }

    /// The same, with the sound of the scene as the layer's: by its last second, so that it counts early on.
    pub fn with_sound(self) -> Self {
        Self { hears: true, ..self }
    }

    /// The same with another build's library, which `name` stands for.
    pub fn of_library(&self, name: &str, library: &Path) -> Self {
        Self { name: format!("{} @ {name}", self.name), library: Some(library.to_owned()), ..self.clone() }
    }

    /// The application alone, with smaller images, the option of every user.
    pub fn render_scale(scale: f32) -> Self {
        Self { name: format!("render scale {scale}"), render_scale: scale, ..Self::off() }
    }

    /// The application alone, shading by eccentricity itself.
    pub fn fixed_foveation(name: &str, map: FixedFoveation) -> Self {
        let share = 1.0 / map.peripheral.fraction();
        let foveation = format!("{},{},1/{share}", map.foveal_deg, map.transitional_deg);
        let arguments = vec!["--foveation".to_owned(), foveation];
        Self { name: name.to_owned(), arguments, ..Self::off() }
    }

    /// As [`Self::fixed_foveation`], in the steps of paper A's four rates, each rounded to the finer one: 1x1 reaches farther.
    pub fn stepped_foveation(name: &str, map: FixedFoveation) -> Self {
        let own = Self::fixed_foveation(name, map);
        let arguments = own.arguments.iter().cloned().chain(["--stepped".to_owned()]);
        Self { arguments: arguments.collect(), ..own }
    }

    /// The application alone, shading by the place on the screen as one of OpenXR Toolkit's presets does: `wide`, `balanced` or `narrow`.
    pub fn openxr_toolkit(preset: &str) -> Self {
        let arguments = vec!["--foveation".to_owned(), format!("toolkit-{preset}")];
        Self { name: format!("OpenXR Toolkit {preset}"), arguments, ..Self::off() }
    }

    /// Alternatives of users without us, the unchanged application first: three render scales, and the nine pairs of radii of paper A's
    /// pilot study (FR, with a periphery of 1/16).
    pub fn baselines() -> Vec<Self> {
        let scales = [0.9, 0.7, 0.5].map(Self::render_scale);
        let pairs = (0..9).map(|pair| {
            let name = format!("FR L{}-C{}", pair / 3 + 1, pair % 3 + 1);
            Self::fixed_foveation(&name, FixedFoveation::PILOT[pair])
        });
        [Self::off()].into_iter().chain(scales).chain(pairs).collect()
    }

    /// Whether the layer is on.
    pub fn has_layer(&self) -> bool {
        !matches!(self.layer, LayerMode::Absent | LayerMode::Off)
    }
}
