//! The scenes as pictures for [`parafovea_models::audio_visual`].

use glam::{Quat, Vec3};
use parafovea_core::color::{Matrix, srgb_to_linear};
use parafovea_core::image::Plane;
use parafovea_core::perception::luminance::luminance_plane;
use parafovea_models::audio_visual::{EDGE_DEG, SIDE, Scene};
use parafovea_scene::camera::Camera;
use parafovea_scene::offscreen::Offscreen;
use parafovea_scene::scene::SceneName;
use parafovea_scene::script::WHITE_CD_M2;
use parafovea_scene::script::head::EYE_HEIGHT_M;
use wgpu::TextureFormat;

/// Number of the shown frame.
const FRAME: u64 = 60;

/// All scenes with the gaze at the centre of the view; fewer without a Vulkan device, with the reason on standard error.
pub fn scenes() -> Vec<Scene> {
    let drawn = SceneName::ALL.into_iter().map(|name| (name, drawn(name)));
    drawn
        .filter_map(|(name, scene)| scene.map_err(|error| eprintln!("{}: {error:#}", name.as_str())).ok())
        .collect()
}

fn drawn(name: SceneName) -> anyhow::Result<Scene> {
    let lights = name.definition().default_lights;
    let mut offscreen = Offscreen::new([SIDE; 2], TextureFormat::Rgba8UnormSrgb, name, lights)?;
    let edge = EDGE_DEG.to_radians();
    let camera = Camera::new(Vec3::Y * EYE_HEIGHT_M, Quat::IDENTITY, [-edge, edge, -edge, edge]);
    offscreen.draw(FRAME, &[camera])?;
    let texels = offscreen.texels()?;
    let colors = Plane::from_fn(SIDE, SIDE, |x, y| {
        let at = (y as usize * SIDE as usize + x as usize) * 4;
        Vec3::from_array(
            [0, 1, 2].map(|channel: usize| srgb_to_linear(f32::from(texels[at + channel]) / 255.0)),
        )
    });
    let mut luminance = Plane::default();
    luminance_plane(&colors, WHITE_CD_M2, Matrix::Bt709, &mut luminance);
    Ok(Scene::new(name.as_str(), &luminance))
}
