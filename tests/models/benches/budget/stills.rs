//! The pictures.

use super::maps::{Map, SIDE, TILES};
use glam::{Quat, Vec3};
use parafovea_core::color::{Matrix, srgb_to_linear};
use parafovea_core::geometry::Fov;
use parafovea_core::image::Plane;
use parafovea_core::kernels::analyze::{Buffers, ContrastSettings, analyze};
use parafovea_core::perception::ContrastMap;
use parafovea_core::perception::luminance::luminance_plane;
use parafovea_core::rate::ShadingRate;
use parafovea_models::errors::{Eye, Picture, Viewing, seen_of_stills};
use parafovea_scene::camera::Camera;
use parafovea_scene::offscreen::Offscreen;
use parafovea_scene::scene::SceneName;
use parafovea_scene::script::WHITE_CD_M2;
use parafovea_scene::script::head::EYE_HEIGHT_M;
use std::f32::consts::FRAC_PI_4;
use wgpu::TextureFormat;

/// Field of view: 90 degrees.
pub const FOV: Fov = Fov { left: -FRAC_PI_4, right: FRAC_PI_4, up: FRAC_PI_4, down: -FRAC_PI_4 };

/// Number of the frame.
const FRAME: u64 = 60;

/// A picture.
pub struct Still {
    pub name: &'static str,
    /// Contrast of its tiles.
    pub contrast: ContrastMap,
    picture: Picture,
}

/// Content of a block of pixels.
#[derive(Clone, Copy)]
pub enum Sampling {
    /// The mean of up to four pixels around its centre.
    Mean,
    /// The pixel to the lower right of its centre.
    One,
}

/// The scenes of the report; none where there is no Vulkan device, with the reason on standard error.
pub fn stills() -> Vec<Still> {
    let scenes = SceneName::ALL.into_iter().filter(|scene| *scene != SceneName::Courtyard);
    let drawn = scenes.map(|scene| (scene, drawn(scene)));
    drawn
        .filter_map(|(scene, still)| {
            still.map_err(|error| eprintln!("{}: {error:#}", scene.as_str())).ok().flatten()
        })
        .collect()
}

fn drawn(scene: SceneName) -> anyhow::Result<Option<Still>> {
    let lights = scene.definition().default_lights;
    let mut offscreen = Offscreen::new([SIDE; 2], TextureFormat::Rgba8UnormSrgb, scene, lights)?;
    let camera =
        Camera::new(Vec3::Y * EYE_HEIGHT_M, Quat::IDENTITY, [-FRAC_PI_4, FRAC_PI_4, -FRAC_PI_4, FRAC_PI_4]);
    offscreen.draw(FRAME, &[camera])?;
    let texels: Vec<[u8; 4]> = offscreen.texels()?.as_chunks().0.to_vec();
    let light = Plane::from_fn(SIDE, SIDE, |x, y| {
        let [red, green, blue, _] = texels[(y * SIDE + x) as usize];
        Vec3::from_array([red, green, blue].map(|code| srgb_to_linear(f32::from(code) / 255.0)))
    });
    let mut luminance = Plane::default();
    luminance_plane(&light, WHITE_CD_M2, Matrix::Bt709, &mut luminance);
    let mut contrast = ContrastMap::default();
    analyze(&luminance, &ContrastSettings::default(), &mut Buffers::default(), &mut contrast);
    let picture = Picture::from_srgb8(SIDE, SIDE, &texels);
    Ok(picture.map(|picture| Still { name: scene.as_str(), contrast, picture }))
}

impl Still {
    /// Mean loss over the view, and detected loss, JND.
    pub fn lost(&self, map: &Map, sampling: Sampling) -> [f64; 2] {
        let shown = match sampling {
            Sampling::Mean => self.picture.shaded_at(|x, y| map.at(x, y)),
            Sampling::One => self.of_one_pixel(map),
        };
        let seen = self.seen(&shown);
        let mean = |of: fn(f64) -> f64| {
            seen.texels().iter().map(|seen| of(f64::from(*seen))).sum::<f64>() / seen.texels().len() as f64
        };
        // Probability summation, as the report has it.
        [mean(|seen| seen), mean(|seen| seen.powf(3.5)).powf(1.0 / 3.5)]
    }

    /// Visible change at each pixel, JND.
    fn seen(&self, shown: &Picture) -> Plane {
        let viewing = Viewing { white_cd_m2: WHITE_CD_M2, ..Viewing::default() };
        let eye = Eye { picture: self.picture.clone(), fov: FOV, gaze: Vec3::NEG_Z, age: None };
        // Pictures of one size.
        seen_of_stills(&eye, shown, &viewing).unwrap_or_else(|_| Plane::filled(SIDE, SIDE, f32::NAN))
    }

    /// Loss of each tile at each of these rates, JND, in the mean of its pixels, as judged where all tiles have that rate: more than any planner can know.
    pub fn judged(&self, rates: &[ShadingRate]) -> Vec<Vec<f32>> {
        let at = |rate: &ShadingRate| {
            let seen = self.seen(&self.picture.shaded_at(|_, _| *rate));
            let mut tiles = vec![0.0; (TILES * TILES) as usize];
            for (index, seen) in (0..).zip(seen.texels()) {
                let [x, y] = [index % SIDE / 16, index / SIDE / 16];
                tiles[(y * TILES + x) as usize] += seen / 256.0;
            }
            tiles
        };
        rates.iter().map(at).collect()
    }

    fn of_one_pixel(&self, map: &Map) -> Picture {
        let codes = self.picture.codes();
        Picture::from_linear(SIDE, SIDE, |x, y| {
            let rate = map.at(x, y);
            let centre = |at: u32, side: u32| at / side * side + side / 2;
            let [x, y] = [centre(x, rate.width()), centre(y, rate.height())];
            codes[(y * SIDE + x) as usize].map(|code| srgb_to_linear(f32::from(code) / 255.0))
        })
    }
}
