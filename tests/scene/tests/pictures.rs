//! Images of the renderer, on any Vulkan device.

#![expect(clippy::unwrap_used, reason = "a test says where it failed")]

use glam::{Quat, vec3};
use parafovea_scene::{camera::Camera, offscreen::Offscreen, scene::SceneName, scene::interior};

const SIDE: u32 = 128;
const SRGB: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
const UNORM: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

fn visitor() -> Camera {
    Camera::new(vec3(0.0, 1.6, 0.0), Quat::IDENTITY, [-0.8, 0.8, -0.8, 0.8])
}

fn offscreen(side: u32, format: wgpu::TextureFormat, scene: SceneName) -> Offscreen {
    Offscreen::new([side; 2], format, scene, scene.definition().default_lights).unwrap()
}

fn picture(format: wgpu::TextureFormat, scene: SceneName, lights: u32, frame: u64) -> Vec<u8> {
    let mut offscreen = Offscreen::new([SIDE; 2], format, scene, lights).unwrap();
    offscreen.draw(frame, &[visitor()]).unwrap();
    offscreen.texels().unwrap()
}

/// Linear luminance of an sRGB picture's texels by its Rec. 709 primaries, 1 for white.
fn luminances(texels: &[u8]) -> Vec<f64> {
    let linear = |code: u8| {
        let encoded = f64::from(code) / 255.0;
        if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    };
    texels
        .chunks_exact(4)
        .map(|texel| 0.2126 * linear(texel[0]) + 0.7152 * linear(texel[1]) + 0.0722 * linear(texel[2]))
        .collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Mean of the absolute differences between neighbours in a row, over the mean: the amount of fine detail.
fn detail(luminances: &[f64], side: usize) -> f64 {
    let steps: f64 = luminances
        .chunks_exact(side)
        .flat_map(|row| row.windows(2).map(|pair| (pair[1] - pair[0]).abs()))
        .sum();
    steps / luminances.len() as f64 / mean(luminances)
}

/// Looks at parts of a scene's frames.
struct Visitor(Offscreen);

impl Visitor {
    fn of(scene: SceneName) -> Self {
        Self(offscreen(SIDE, SRGB, scene))
    }

    /// The luminances around a direction, with `half_deg` to each side.
    fn sees(&mut self, frame: u64, [yaw_deg, pitch_deg, half_deg]: [f32; 3]) -> Vec<f64> {
        let turn =
            Quat::from_rotation_y(yaw_deg.to_radians()) * Quat::from_rotation_x(pitch_deg.to_radians());
        let edge = half_deg.to_radians();
        let camera = Camera::new(vec3(0.0, 1.6, 0.0), turn, [-edge, edge, -edge, edge]);
        self.0.draw(frame, &[camera]).unwrap();
        luminances(&self.0.texels().unwrap())
    }

    /// The detail around a direction in frame 0.
    fn detail(&mut self, at: [f32; 3]) -> f64 {
        detail(&self.sees(0, at), SIDE as usize)
    }

    /// Number of texels whose luminance differs between two frames by more than `least`.
    fn changes(&mut self, frames: [u64; 2], at: [f32; 3], least: f64) -> usize {
        let [first, later] = frames.map(|frame| self.sees(frame, at));
        first.iter().zip(&later).filter(|(a, b)| (*a - *b).abs() > least).count()
    }
}

const TEXELS: usize = (SIDE * SIDE) as usize;

#[test]
fn a_frame_number_means_one_picture() {
    for scene in SceneName::ALL {
        let lights = scene.definition().default_lights;
        let first = picture(SRGB, scene, lights, 100);
        // Other frames before it change nothing.
        let mut offscreen = offscreen(SIDE, SRGB, scene);
        for frame in [3, 50, 100] {
            offscreen.draw(frame, &[visitor()]).unwrap();
        }
        assert!(first == offscreen.texels().unwrap(), "frame 100 of {scene:?} differs between two runs");
        offscreen.draw(145, &[visitor()]).unwrap();
        assert!(first != offscreen.texels().unwrap(), "nothing moved in half a second of {scene:?}");
    }
}

#[test]
fn formats_agree() {
    for scene in [SceneName::Courtyard, SceneName::Interior] {
        let srgb = picture(SRGB, scene, 7, 7);
        let unorm = picture(UNORM, scene, 7, 7);
        let worst = srgb.iter().zip(&unorm).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(
            worst <= Some(1),
            "{scene:?}: the shader's sRGB encoding is {worst:?} codes off the format's"
        );
    }
}

#[test]
fn more_lights_are_brighter() {
    for scene in SceneName::ALL {
        let light = |count| picture(UNORM, scene, count, 0).iter().map(|&code| u64::from(code)).sum::<u64>();
        let [none, many] = [0, scene.definition().default_lights].map(light);
        assert!(none < many, "{scene:?}: {none} {many}");
    }
}

/// The picture has both ends: near-black in the corner, near-white in the sky.
#[test]
fn dark_corner_and_bright_sky() {
    let mut offscreen = offscreen(SIDE, UNORM, SceneName::Courtyard);
    let mean = |texels: &[u8]| {
        texels.chunks_exact(4).flat_map(|texel| &texel[..3]).map(|&code| f64::from(code)).sum::<f64>()
            / (texels.len() / 4 * 3) as f64
    };
    let narrow = [-0.1, 0.1, -0.1, 0.1];
    let corner = Camera::new(vec3(0.0, 1.6, 0.0), Quat::from_rotation_y(0.97), narrow);
    offscreen.draw(0, &[corner]).unwrap();
    let dark = mean(&offscreen.texels().unwrap());
    let sky = Camera::new(vec3(0.0, 1.6, 0.0), Quat::from_rotation_x(0.5), narrow);
    offscreen.draw(0, &[sky]).unwrap();
    let bright = mean(&offscreen.texels().unwrap());
    assert!(dark < 24.0 && bright > 190.0, "corner {dark:.1}, sky {bright:.1}");
}

/// Print of all sizes: screens, instruments and labels have more detail than the sky.
#[test]
fn the_cockpit_is_full_of_print() {
    let mut pilot = Visitor::of(SceneName::Cockpit);
    let sky = pilot.detail([-8.0, 14.0, 5.0]);
    for (what, at) in [
        ("messages", [38.0, -34.0, 5.0]),
        ("instruments", [8.0, -26.0, 5.0]),
        ("labels", [28.0, -42.0, 5.0]),
        ("overhead panel", [18.0, 41.0, 5.0]),
    ] {
        let found = pilot.detail(at);
        assert!(found > 5.0 * sky, "{what}: {found:.3}, sky {sky:.3}");
    }
}

/// Leaves are cut out: between them the sky is seen. They move in the wind, trunks do not.
#[test]
fn leaves_have_holes_and_move() {
    let mut visitor = Visitor::of(SceneName::Foliage);
    let crown = [22.0, 32.0, 8.0];
    let luminances = visitor.sees(0, crown);
    let sky = luminances.iter().filter(|&&luminance| luminance > 0.5).count();
    let leaves = luminances.iter().filter(|&&luminance| luminance < 0.2).count();
    assert!(sky > TEXELS / 20 && leaves > TEXELS / 20, "{sky} bright texels, {leaves} dark ones");
    let swinging = visitor.changes([0, 45], crown, 0.02);
    let still = visitor.changes([0, 45], [30.6, -6.0, 1.0], 0.02);
    assert!(swinging > TEXELS / 20, "{swinging} texels changed in the crown");
    assert!(still * 4 < swinging, "{still} texels changed on the trunk, {swinging} in the crown");
}

/// Dark as a whole, with pools of light and legible spines.
#[test]
fn the_library_is_dark_with_pools_of_light() {
    let mut reader = Visitor::of(SceneName::Library);
    let all = mean(&reader.sees(0, [0.0, 0.0, 45.0]));
    let pool = mean(&reader.sees(0, [0.0, -22.0, 6.0]));
    assert!(all < 0.03, "mean {all:.4}");
    assert!(pool > 4.0 * all, "pool {pool:.4}, mean {all:.4}");
    let spines = reader.detail([55.0, 0.0, 8.0]);
    assert!(spines > 0.1, "detail of the spines {spines:.3}");
}

/// The mirror shows moving things before it, the steel sphere the light above it.
#[test]
fn the_interior_reflects() {
    let mut visitor = Visitor::of(SceneName::Interior);
    // The sphere that circles nearest to the far wall at frame 0, in the mirror only.
    let there = interior::mirrored(interior::ball_at(1, 0.0)) - vec3(0.0, 1.6, 0.0);
    let there = [(-there.x).atan2(-there.z).to_degrees(), there.y.atan2(-there.z).to_degrees(), 1.5];
    let moved = visitor.changes([0, 120], there, 0.05);
    assert!(moved > TEXELS / 4, "{moved} texels changed in the mirror");
    let sphere = visitor.sees(0, [28.0, -8.0, 6.0]);
    let brightest = sphere.iter().copied().fold(0.0, f64::max);
    assert!(brightest > 0.6, "no highlight on the steel sphere: {brightest:.2}");
}

/// Bright windows beside dark walls, and wires that are thinner than a texel of a headset.
#[test]
fn the_street_has_thin_bright_lines_on_black() {
    let mut visitor = Visitor::of(SceneName::Street);
    let all = visitor.sees(0, [0.0, 0.0, 45.0]);
    assert!(mean(&all) < 0.08, "mean {:.4}", mean(&all));
    assert!(all.iter().filter(|&&luminance| luminance > 0.5).count() > 50, "too few bright texels");
    // Michelson's contrast between wires and the sky beside them.
    let sky = visitor.sees(0, [0.0, 30.0, 5.0]);
    let (low, high) = sky.iter().fold((1.0f64, 0.0f64), |(low, high), &l| (low.min(l), high.max(l)));
    assert!((high - low) / (high + low) > 0.8, "from {low:.4} to {high:.4}");
    let lines = sky.iter().filter(|&&luminance| luminance > high / 2.0).count();
    assert!(lines > 0 && lines < TEXELS / 10, "{lines} of {TEXELS} texels are lines");
    let (railing, road) = (visitor.detail([60.0, -10.0, 8.0]), visitor.detail([0.0, -35.0, 3.0]));
    assert!(railing > 2.0 * road, "detail of the railing {railing:.3}, of the road {road:.3}");
}

/// Much of the strip where people walk changes within a second.
#[test]
fn the_crowd_moves() {
    let changed = Visitor::of(SceneName::Crowd).changes([0, 90], [0.0, -4.0, 8.0], 0.03);
    assert!(changed > TEXELS / 4, "{changed} of {TEXELS} texels changed");
}
