//! Textures of scenes: drawn as eyes are, and never one.

use crate::frame_graphs::frame::{BYTES, DEPTH, Frame, HDR, Image, LDR, plain, scaled};
use crate::frame_graphs::step::{Step, Truth::Texture as IsTexture};
use parafovea::pass_detection::ImageDescription;

/// A texture that is drawn in each frame, before the scene samples it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Texture {
    /// A mirror of the eye's aspect, scaled by this factor from the scene's targets.
    Mirror(f32),
    /// A mirror in high dynamic range with tone mapping of its own, drawn for each eye.
    ToneMappedMirror(f32),
    /// A portal: as [`Texture::Mirror`] at full size, in the format of the scene, and twice recursive.
    Portal,
    /// A square planar reflection of this side, blurred down its levels.
    Planar(u32),
    /// A rifle scope.
    Scope(u32),
    /// A scope that is drawn after the scene and sampled in the next frame.
    LateScope(u32),
    /// A screen in the world that shows another camera.
    Screen(u32),
    /// Exponential variance shadows in RGBA16F, blurred by full-screen passes.
    Evsm(u32),
    /// The same with two cascades in layers.
    EvsmCascades(u32),
    /// A shadow map of depth alone.
    Shadow(u32),
    /// A page of the user interface in the world.
    Page(u32),
    /// One face of a reflection probe.
    Probe(u32),
    /// A probe in octahedral form, an atlas.
    Octahedral(u32),
    /// A map of the surroundings from above.
    Minimap(u32),
}

impl Texture {
    /// Draws it, and returns the image that the scene samples.
    pub(crate) fn draw(self, frame: &mut Frame<'_>, number: usize) -> Image {
        let size = frame.size();
        match self {
            Texture::Mirror(scale) => {
                let extent = scaled(size, scale);
                camera(frame, "mirror", number, extent, LDR, 90)
            }
            Texture::ToneMappedMirror(scale) => {
                let extent = scaled(size, scale);
                let bright = camera(frame, "bright mirror", number, extent, HDR, 140);
                let image = frame.image("tone-mapped mirror", number, extent, LDR);
                frame.add(Step::new("tone-map mirror", IsTexture, &[image]).full_screen(&[bright]));
                image
            }
            Texture::Portal => {
                let inner = camera(frame, "inner portal", number, size, HDR, 60);
                let image = frame.image("portal", number, size, HDR);
                let depth = frame.image("portal depth", number, size, DEPTH);
                frame.add(Step::new("portal", IsTexture, &[image]).clears(depth).meshes(80, &[inner]));
                image
            }
            Texture::Planar(side) => {
                let image = camera(frame, "planar reflection", number, [side; 2], HDR, 110);
                for level in 1..4 {
                    let mip = Step::new("planar level", IsTexture, &[image]);
                    frame.add(mip.level(level, [side >> level; 2]).full_screen(&[image]));
                }
                image
            }
            Texture::Scope(side) => camera(frame, "scope", number, [side; 2], LDR, 130),
            Texture::LateScope(side) => frame.image("late scope", number, [side; 2], LDR),
            Texture::Screen(side) => camera(frame, "screen", number, [side; 2], BYTES, 70),
            Texture::Evsm(side) => {
                let image = camera(frame, "EVSM", number, [side; 2], HDR, 200);
                let other = frame.image("EVSM blur", number, [side; 2], HDR);
                frame.add(Step::new("blur EVSM across", IsTexture, &[other]).full_screen(&[image]));
                frame.add(Step::new("blur EVSM down", IsTexture, &[image]).full_screen(&[other]));
                image
            }
            Texture::EvsmCascades(side) => {
                let cascades = |key| ImageDescription { layers: 2, ..plain(key, [side; 2], HDR) };
                let image = frame.described("EVSM cascades", number, cascades);
                let depth = frame.image("EVSM cascades depth", number, [side; 2], DEPTH);
                for layer in 0..2 {
                    let cascade = Step::new("EVSM cascade", IsTexture, &[image]).layer(layer);
                    frame.add(cascade.clears(depth).meshes(90, &[]));
                }
                image
            }
            Texture::Shadow(side) => {
                let depth = frame.image("shadow map", number, [side; 2], DEPTH);
                frame.add(Step::depth_only("shadow map", IsTexture, depth).meshes(150, &[]));
                depth
            }
            Texture::Page(side) => {
                let image = frame.image("page", number, [side; 2], LDR);
                frame.add(Step::new("page", IsTexture, &[image]).quads(40, &[]).small_meshes(12, 240, &[]));
                image
            }
            Texture::Probe(side) => {
                let cube = |key| ImageDescription { layers: 6, is_cube: true, ..plain(key, [side; 2], HDR) };
                let image = frame.described("probe", number, cube);
                let depth = frame.image("probe depth", number, [side; 2], DEPTH);
                let face = (frame.number % 6) as u32;
                let step = Step::new("probe", IsTexture, &[image]).layer(face);
                frame.add(step.clears(depth).meshes(60, &[]));
                image
            }
            Texture::Octahedral(side) => {
                let image = frame.image("octahedral probe", number, [side; 2], HDR);
                let depth = frame.image("octahedral depth", number, [side; 2], DEPTH);
                let cell = side / 4;
                let at = (frame.number % 16) as u32;
                let area = [at % 4 * cell, at / 4 * cell, cell, cell];
                let step = Step::new("octahedral probe", IsTexture, &[image]).area(area);
                frame.add(step.clears(depth).meshes(40, &[]));
                image
            }
            Texture::Minimap(side) => camera(frame, "minimap", number, [side; 2], LDR, 25),
        }
    }

    /// Draws the part that comes after the scene.
    pub(crate) fn draw_late(self, frame: &mut Frame<'_>, number: usize) {
        if let Texture::LateScope(side) = self {
            camera(frame, "late scope", number, [side; 2], LDR, 130);
        }
    }
}

/// The view of another camera, with depth of its own.
fn camera(
    frame: &mut Frame<'_>,
    name: &'static str,
    number: usize,
    extent: [u32; 2],
    format: ash::vk::Format,
    meshes: u32,
) -> Image {
    let image = frame.image(name, number, extent, format);
    let depth = frame.image("camera depth", number, extent, DEPTH);
    frame.add(Step::new(name, IsTexture, &[image]).clears(depth).meshes(meshes, &[]));
    image
}

/// Draws all of `textures`, and returns the images that the scene samples.
pub(crate) fn draw_all(frame: &mut Frame<'_>, textures: &[Texture]) -> Vec<Image> {
    textures.iter().enumerate().map(|(number, texture)| texture.draw(frame, number)).collect()
}

/// Draws the parts of `textures` that come after the scene.
pub(crate) fn draw_all_late(frame: &mut Frame<'_>, textures: &[Texture]) {
    textures.iter().enumerate().for_each(|(number, texture)| texture.draw_late(frame, number));
}
