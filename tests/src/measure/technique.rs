//! What is done to an application, and what a user could do instead.

use crate::run::LayerMode;

/// One way to run an application.
#[derive(Clone, Debug, PartialEq)]
pub struct Technique {
    /// What it is called in tables and results.
    pub name: String,
    /// The layer.
    pub layer: LayerMode,
    /// Side of the application's images, as a part of what the runtime recommends.
    pub render_scale: f32,
    /// What the application is told besides.
    pub arguments: Vec<String>,
}

impl Technique {
    /// The application alone.
    pub fn off() -> Self {
        Self { name: "off".to_owned(), layer: LayerMode::Absent, render_scale: 1.0, arguments: Vec::new() }
    }

    /// The layer with this configuration.
    pub fn layer(name: &str, config: &str) -> Self {
        Self { name: name.to_owned(), layer: LayerMode::On(config.to_owned()), ..Self::off() }
    }

    /// The application alone, with smaller images: what every user can do.
    pub fn render_scale(scale: f32) -> Self {
        Self { name: format!("render scale {scale}"), render_scale: scale, ..Self::off() }
    }

    /// Whether the layer is on.
    pub fn has_layer(&self) -> bool {
        !matches!(self.layer, LayerMode::Absent | LayerMode::Off)
    }
}
