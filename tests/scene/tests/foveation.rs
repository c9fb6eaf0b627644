//! Fixed foveation as the application does it by itself, without shading rates.

#![expect(clippy::unwrap_used, reason = "a test says where it failed")]

use glam::{Quat, Vec3, vec3};
use parafovea_scene::camera::Camera;
use parafovea_scene::offscreen::Offscreen;
use parafovea_scene::openxr_toolkit::ScreenEllipses;
use parafovea_scene::renderer::{Foveation, Radii};
use parafovea_scene::scene::SceneName;

const SIDE: u32 = 256;
const EDGE: f32 = std::f32::consts::FRAC_PI_4;
const L1_C1: Radii =
    Radii { foveal_deg: 14.34, transitional_deg: 27.08, peripheral: 1.0 / 16.0, stepped: false };

/// Draws the crowd, which has hardly anything black, with a gaze.
struct Visitor(Offscreen);

impl Visitor {
    fn new() -> Self {
        let scene = SceneName::Crowd;
        let format = wgpu::TextureFormat::Rgba8UnormSrgb;
        Self(Offscreen::new([SIDE; 2], format, scene, scene.definition().default_lights).unwrap())
    }

    fn draw(&mut self, foveation: Option<Foveation>, gaze: Vec3) -> Vec<u8> {
        let camera = Camera::new(vec3(0.0, 1.6, 0.0), Quat::IDENTITY, [-EDGE, EDGE, -EDGE, EDGE]);
        self.0.set_foveation(foveation);
        self.0.draw_gazing(30, &[camera], gaze).unwrap();
        self.0.texels().unwrap()
    }
}

/// The angle between a gaze and a texel's centre, degrees.
fn eccentricity_deg(texel: usize, gaze: Vec3) -> f32 {
    let [x, y] =
        [texel as u32 % SIDE, texel as u32 / SIDE].map(|at| (at as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0);
    vec3(x, -y, -1.0).angle_between(gaze).to_degrees()
}

/// Eccentricities of the texels that differ.
fn differences(a: &[u8], b: &[u8], gaze: Vec3) -> Vec<f32> {
    let texels = a.chunks_exact(4).zip(b.chunks_exact(4)).enumerate();
    texels.filter(|(_, (a, b))| a != b).map(|(texel, _)| eccentricity_deg(texel, gaze)).collect()
}

fn squared_error(a: &[u8], b: &[u8]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2)).sum::<f64>() / a.len() as f64
}

/// Whole blocks of 4 x 4 texels go by their centre: inside the radius less half a block's diagonal nothing changes,
/// wherever the gaze is.
#[test]
fn the_fovea_is_unchanged() {
    let mut visitor = Visitor::new();
    for gaze in [Vec3::NEG_Z, vec3(-0.4, 0.2, -1.0).normalize()] {
        let (full, foveated) = (visitor.draw(None, gaze), visitor.draw(Some(Foveation::Radii(L1_C1)), gaze));
        let differences = differences(&full, &foveated, gaze);
        let nearest = differences.iter().copied().fold(f32::INFINITY, f32::min);
        assert!(nearest > L1_C1.foveal_deg - 0.7, "something changed at {nearest} degrees");
        assert!(differences.len() > full.len() / 4 / 5, "only {} texels changed", differences.len());
    }
}

#[test]
fn all_is_shaded_within_a_wide_fovea() {
    let mut visitor = Visitor::new();
    let full = visitor.draw(None, Vec3::NEG_Z);
    let wide = Foveation::Radii(Radii {
        foveal_deg: 180.0,
        transitional_deg: 180.0,
        peripheral: 0.25,
        stepped: false,
    });
    assert!(full == visitor.draw(Some(wide), Vec3::NEG_Z));
}

/// Rates by place: inside of the inner ellipse nothing changes, and much does outside, wherever the eyes look.
#[test]
fn ellipses_stay_on_the_screen() {
    let mut visitor = Visitor::new();
    let map = ScreenEllipses::BALANCED;
    let [ahead, aside] = [Vec3::NEG_Z, vec3(-0.4, 0.2, -1.0).normalize()]
        .map(|gaze| visitor.draw(Some(Foveation::Ellipses(map)), gaze));
    assert!(ahead == aside, "they follow the gaze");
    let full = visitor.draw(None, Vec3::NEG_Z);
    let texels = full.chunks_exact(4).zip(ahead.chunks_exact(4)).enumerate();
    let changed = texels.filter(|(_, (a, b))| a != b).map(|(texel, _)| {
        let [x, y] =
            [texel as u32 % SIDE, texel as u32 / SIDE].map(|at| (at as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0);
        (x / map.horizontal_scale).hypot(y)
    });
    let radii: Vec<f32> = changed.collect();
    let nearest = radii.iter().copied().fold(f32::INFINITY, f32::min);
    // A block goes by its centre.
    let block = 2.0 * 2.0_f32.sqrt() / (SIDE as f32 / 2.0);
    assert!((map.inner - block..map.inner + 0.1).contains(&nearest), "the first change is at {nearest}");
    assert!(radii.len() > full.len() / 4 / 5, "only {} texels changed", radii.len());
}

/// Skipped texels are filled: none keeps the black of the image's clear.
#[test]
fn nothing_stays_black() {
    let mut visitor = Visitor::new();
    let black = |texels: &[u8]| texels.chunks_exact(4).filter(|texel| texel[..3] == [0, 0, 0]).count();
    let full = black(&visitor.draw(None, Vec3::NEG_Z));
    for peripheral in [1.0 / 16.0, 0.25] {
        let foveation =
            Foveation::Radii(Radii { foveal_deg: 0.0, transitional_deg: 0.0, peripheral, stepped: false });
        let found = black(&visitor.draw(Some(foveation), Vec3::NEG_Z));
        assert!(found <= full + 64, "{found} black texels at {peripheral}, {full} in the whole picture");
    }
}

#[test]
fn more_shading_is_nearer_to_the_truth() {
    let mut visitor = Visitor::new();
    let full = visitor.draw(None, Vec3::NEG_Z);
    let mut error = |foveal_deg, transitional_deg, peripheral| {
        let foveation = Foveation::Radii(Radii { foveal_deg, transitional_deg, peripheral, stepped: false });
        squared_error(&full, &visitor.draw(Some(foveation), Vec3::NEG_Z))
    };
    let coarse = error(9.44, 18.39, 1.0 / 16.0);
    let [wider, finer] = [error(14.34, 27.08, 1.0 / 16.0), error(9.44, 18.39, 0.25)];
    assert!(
        wider < 0.95 * coarse,
        "mean squared error {wider} with a wider fovea, {coarse} with a narrow one"
    );
    assert!(finer < 0.8 * coarse, "mean squared error {finer} with 1/4, {coarse} with 1/16");
}

/// The template is drawn again when the gaze has moved, and only copied when it has not.
#[test]
fn the_fovea_follows_the_gaze() {
    let mut visitor = Visitor::new();
    let camera = Camera::new(vec3(0.0, 1.6, 0.0), Quat::IDENTITY, [-EDGE, EDGE, -EDGE, EDGE]);
    visitor.0.set_foveation(Some(Foveation::Radii(L1_C1)));
    let mut draw = |gaze: Vec3| {
        visitor.0.draw_gazing(30, &[camera], gaze.normalize()).unwrap();
        visitor.0.texels().unwrap()
    };
    let ahead = draw(Vec3::NEG_Z);
    let left = draw(vec3(-0.5, 0.0, -1.0));
    assert!(ahead != left);
    assert!(left == draw(vec3(-0.5, 0.0, -1.0)), "the same gaze again gives another picture");
    assert!(ahead == draw(Vec3::NEG_Z), "back where it was, it gives another picture");
    assert!(ahead == draw(vec3(0.001, 0.0, -1.0)), "0.06 degrees are no movement");
}
