//! Direct3D 11 by DXVK's Linux build, which Debian sid has.

use crate::HarnessError;
use crate::run::{Application, Run};
use crate::scenario::Scenario;

/// Ways of drawing of `parafovea-d3d11`.
pub const LOOKS: [&str; 7] =
    ["forward", "tone-mapped", "multisampled", "instanced", "double-wide", "deferred-context", "copied"];

/// A run of one, of this scenario's frames, with eye buffers of this side in pixels, without the layer.
///
/// # Errors
/// [`HarnessError::NotBuilt`].
pub fn run(look: &str, size: u32, scenario: &Scenario) -> Result<Run, HarnessError> {
    let (size, frames) = (size.to_string(), scenario.session.frames.to_string());
    let arguments = ["--look", look, "--size", &size, "--frames", &frames];
    let application = Application::ours("parafovea-d3d11", &arguments)?;
    // DXVK asks SDL for the screen: a video driver without one. Its log would be a file in the working folder.
    Ok(Run::new(&application, scenario)
        .env("DXVK_WSI_DRIVER", "SDL3")
        .env("SDL_VIDEO_DRIVER", "offscreen")
        .env("DXVK_LOG_LEVEL", "warn")
        .env("DXVK_LOG_PATH", "none"))
}
