//! Release builds for users.

use crate::packages::can_build_audio;
use crate::steps::{Steps, cargo};
use crate::tasks::in_root;

/// Arguments of cargo for the layer's release build: the shared library alone. Cargo ignores the profile's `lto` for a library that it also
/// builds for Rust programs (`rlib`), as `cargo build` does.
const LAYER: [&str; 6] = ["rustc", "--release", "-p", "parafovea-layer", "--crate-type", "cdylib"];

/// Builds the layer's shared library.
pub fn build_layer(steps: &mut Steps) -> Result<(), String> {
    steps.run("release build of the layer", in_root(cargo().args(LAYER).arg("--locked")))
}

/// Builds every part of a package: the layer, the command line and, if ALSA's headers are there, the sound library.
pub fn build_package(steps: &mut Steps) -> Result<(), String> {
    build_layer(steps)?;
    let mut others = cargo();
    others.args(["build", "--locked", "--release", "-p", "parafovea"]);
    if can_build_audio() {
        others.args(["-p", "parafovea-audio"]);
    }
    steps.run("cargo build --release", in_root(&mut others))
}

#[cfg(test)]
mod tests {
    use super::LAYER;

    #[test]
    fn the_readme_builds_the_layer_alike() {
        let readme = include_str!("../../../README.md");
        let command = format!("cargo {}", LAYER.join(" "));
        assert!(readme.contains(&command), "README.md lacks `{command}`");
    }
}
