//! The scene's definition is frozen: measurements of one revision are compared with those of another, which
//! only works if both drew the same.

use std::fmt::Write;

use parafovea_scene::renderer::SHADER;
use parafovea_scene::scene::texture::Texture;
use parafovea_scene::scene::{Material, Scene, lights, materials, time_of};

/// What the scene is made of. If a test below fails and the change is wanted, it is a new scene: measure its
/// cost as the README of this crate says, write it there, take new baselines for everything that was
/// measured with the old one, and only then put the new values here.
const SHADER_HASH: u64 = 0x5a76_3eed_05e4_25bb;
const SHAPES_HASH: u64 = 0x15a0_cc12_d56d_986a;
const TEXTURES_HASH: u64 = 0x4cbe_cacc_b86a_c83b;
const MOTION_HASH: u64 = 0x0ee2_988e_9872_f7c8;
const LIGHTS: u32 = 7;

/// FNV-1a (64 bit).
fn hash(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes
        .into_iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// Hash of numbers in steps of 1/4096, so that the last digit of a sine does not count.
fn hash_of_numbers(numbers: impl IntoIterator<Item = f32>) -> u64 {
    hash(numbers.into_iter().flat_map(|number| ((number * 4096.0).round() as i32).to_le_bytes()))
}

fn assert_frozen(name: &str, found: u64, frozen: u64) {
    assert_eq!(
        found, frozen,
        "{name} changed: found {found:#018x}, frozen is {frozen:#018x}; see the comment in frozen.rs"
    );
}

#[test]
fn shader() {
    let mut code = String::new();
    for line in SHADER.lines() {
        let line = line.split("//").next().unwrap().trim();
        if !line.is_empty() {
            writeln!(code, "{line}").unwrap();
        }
    }
    assert_frozen("scene.wgsl", hash(code.bytes()), SHADER_HASH);
}

#[test]
fn shapes() {
    let scene = Scene::new();
    let numbers = scene.parts.iter().flat_map(|part| {
        let vertices = part.mesh.vertices.iter().flat_map(|vertex| {
            [&vertex.position[..], &vertex.normal, &vertex.tangent, &vertex.uv, &[vertex.sky]].concat()
        });
        let indices = part.mesh.indices.iter().map(|&index| index as f32);
        [part.material as usize as f32].into_iter().chain(vertices).chain(indices)
    });
    assert_frozen("a shape", hash_of_numbers(numbers), SHAPES_HASH);
}

#[test]
fn textures() {
    let surfaces = Material::ALL.iter().flat_map(|&material| {
        let surface = materials::surface_of(material);
        [surface.albedo, surface.relief]
    });
    let texels = |texture: Texture| texture.levels.into_iter().flatten().collect::<Vec<_>>();
    let all = surfaces.chain([materials::detail()]).flat_map(texels);
    assert_frozen("a texture", hash(all), TEXTURES_HASH);
}

#[test]
fn motion_and_lights() {
    assert_eq!(lights::DEFAULT, LIGHTS, "see the comment in frozen.rs");
    let scene = Scene::new();
    let numbers = [0, 1, 90, 1234].map(|frame| {
        let time = time_of(frame);
        let lights = lights::at(time, 16);
        let placements = scene.placements(time, &lights);
        let places = placements.iter().flat_map(|placement| {
            let mut numbers = placement.transform.to_cols_array().to_vec();
            numbers.extend(placement.emission.to_array());
            numbers.push(placement.part as f32);
            numbers
        });
        let lamps = lights.iter().flat_map(|light| {
            [light.position.to_array(), light.colour.to_array(), [light.range, 0.0, 0.0]].concat()
        });
        places.chain(lamps).collect::<Vec<_>>()
    });
    assert_frozen("a motion or a light", hash_of_numbers(numbers.concat()), MOTION_HASH);
}
