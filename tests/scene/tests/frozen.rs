//! The scene's definition is frozen: measurements of two revisions are only comparable if both drew the same.

#![expect(clippy::unwrap_used, reason = "a test says where it failed")]

use std::fmt::Write;

use glam::Vec3;
use parafovea_scene::renderer::{FOVEATION_SHADER, SCENES_SHADER, SHADER};
use parafovea_scene::scene::texture::Texture;
use parafovea_scene::scene::{Scene, SceneName, materials, time_of};
use parafovea_scene::script::Script;

/// Parts of a scene. If a test below fails and the change is wanted, it is a new scene: measure its cost by the README of this crate,
/// write it there, take new baselines for everything that was measured with the old one, and only then put the new values here.
struct Frozen {
    scene: SceneName,
    shapes: u64,
    textures: u64,
    motion: u64,
    /// Sun, sky and reflections; the courtyard's are in its shader.
    environment: u64,
    /// Head, gaze and loudness.
    script: u64,
    lights: u32,
}

const SHADER_HASH: u64 = 0x5a76_3eed_05e4_25bb;
const SCENES_SHADER_HASH: u64 = 0x577e_91d8_684a_f154;
const FOVEATION_SHADER_HASH: u64 = 0x71cd_6cb0_2ffe_e3ca;
const FROZEN: [Frozen; 7] = [
    Frozen {
        scene: SceneName::Courtyard,
        shapes: 0x15a0_cc12_d56d_986a,
        textures: 0x4cbe_cacc_b86a_c83b,
        motion: 0x0ee2_988e_9872_f7c8,
        environment: 0,
        script: 0xa69c_a961_8cb4_ee17,
        lights: 7,
    },
    Frozen {
        scene: SceneName::Cockpit,
        shapes: 0x8a04_1cee_bddf_da3d,
        textures: 0x6b97_8251_3b68_d911,
        motion: 0x231b_ab88_082f_adbb,
        environment: 0xaee6_eba1_c4a8_5c8e,
        script: 0xec2e_32d9_89e8_2b30,
        lights: 5,
    },
    Frozen {
        scene: SceneName::Foliage,
        shapes: 0x01a6_4245_d005_e1eb,
        textures: 0x915d_3182_459f_828e,
        motion: 0x7ddc_fa1a_36f1_3211,
        environment: 0x703d_fbf8_7843_7bc7,
        script: 0x05b2_ae39_82e3_5e40,
        lights: 1,
    },
    Frozen {
        scene: SceneName::Library,
        shapes: 0x2453_7fa6_e9d3_4e2d,
        textures: 0x6c5e_9bea_6254_9859,
        motion: 0xf700_ba5b_94b6_2f60,
        environment: 0x1c51_c71b_439e_de29,
        script: 0xa9cd_495b_57f3_21f3,
        lights: 7,
    },
    Frozen {
        scene: SceneName::Interior,
        shapes: 0x3b0d_17af_a60c_529b,
        textures: 0xa07b_78b4_aa4e_c100,
        motion: 0xceef_661c_b27f_26e5,
        environment: 0x037b_9fff_b05d_ea17,
        script: 0xaf44_6e15_f5e1_6563,
        lights: 6,
    },
    Frozen {
        scene: SceneName::Street,
        shapes: 0xbed6_3119_7526_b08f,
        textures: 0xf2e1_3bf0_ded3_d3aa,
        motion: 0x9e7b_4ee2_6dc9_bfc2,
        environment: 0x7783_aa72_8ed7_f966,
        script: 0x7f22_5437_f496_fbbc,
        lights: 8,
    },
    Frozen {
        scene: SceneName::Crowd,
        shapes: 0xb373_8035_7d8b_a27f,
        textures: 0x7a4a_b2d6_ae7f_428b,
        motion: 0x035d_0e0d_b967_7480,
        environment: 0x15b0_354d_76f4_3dfe,
        script: 0x8f68_b2fe_60ff_20a6,
        lights: 6,
    },
];

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

fn hash_of_code(code: &str) -> u64 {
    let mut stripped = String::new();
    for line in code.lines() {
        let line = line.split("//").next().unwrap().trim();
        if !line.is_empty() {
            writeln!(stripped, "{line}").unwrap();
        }
    }
    hash(stripped.bytes())
}

#[test]
fn shaders() {
    assert_frozen("scene.wgsl", hash_of_code(SHADER), SHADER_HASH);
    assert_frozen("scenes.wgsl", hash_of_code(SCENES_SHADER), SCENES_SHADER_HASH);
    assert_frozen("foveation.wgsl", hash_of_code(FOVEATION_SHADER), FOVEATION_SHADER_HASH);
}

#[test]
fn every_scene_is_frozen() {
    assert_eq!(FROZEN.map(|frozen| frozen.scene), SceneName::ALL);
}

#[test]
fn shapes() {
    for frozen in FROZEN {
        let scene = Scene::new(frozen.scene);
        let numbers = scene.parts.iter().flat_map(|part| {
            let vertices = part.mesh.vertices.iter().flat_map(|vertex| {
                [&vertex.position[..], &vertex.normal, &vertex.tangent, &vertex.uv, &[vertex.sky]].concat()
            });
            let indices = part.mesh.indices.iter().map(|&index| index as f32);
            [part.material as usize as f32].into_iter().chain(vertices).chain(indices)
        });
        assert_frozen(&format!("a shape of {:?}", frozen.scene), hash_of_numbers(numbers), frozen.shapes);
    }
}

#[test]
fn textures() {
    for frozen in FROZEN {
        let surfaces = Scene::new(frozen.scene).materials().into_iter().flat_map(|material| {
            let surface = materials::surface_of(material);
            [surface.albedo, surface.relief]
        });
        let texels = |texture: Texture| texture.levels.into_iter().flatten().collect::<Vec<_>>();
        let all = surfaces.chain([materials::detail()]).flat_map(texels);
        assert_frozen(&format!("a texture of {:?}", frozen.scene), hash(all), frozen.textures);
    }
}

#[test]
fn motion_and_lights() {
    for frozen in FROZEN {
        let definition = frozen.scene.definition();
        assert_eq!(definition.default_lights, frozen.lights, "see the comment in frozen.rs");
        let scene = Scene::new(frozen.scene);
        let numbers = [0, 1, 90, 1234].map(|frame| {
            let time = time_of(frame);
            let lights = scene.lights(time, 16);
            let placements = scene.placements(time, &lights);
            let places = placements.iter().flat_map(|placement| {
                let mut numbers = placement.transform.to_cols_array().to_vec();
                numbers.extend(placement.emission.to_array());
                numbers.push(placement.part as f32);
                if placement.tint != Vec3::ONE {
                    numbers.extend(placement.tint.to_array());
                }
                numbers
            });
            let lamps = lights.iter().flat_map(|light| {
                [light.position.to_array(), light.colour.to_array(), [light.range, 0.0, 0.0]].concat()
            });
            places.chain(lamps).collect::<Vec<_>>()
        });
        let motion = hash_of_numbers(numbers.concat());
        assert_frozen(&format!("a motion or a light of {:?}", frozen.scene), motion, frozen.motion);
        let environment = definition.environment.map_or(0, |environment| {
            hash_of_numbers(bytemuck::cast_slice::<u8, f32>(bytemuck::bytes_of(&environment)).iter().copied())
        });
        assert_frozen(&format!("the environment of {:?}", frozen.scene), environment, frozen.environment);
    }
}

#[test]
fn scripts() {
    for frozen in FROZEN {
        let script = Script::new(frozen.scene);
        let head = script.head.keyframes(90.0);
        let head = head
            .iter()
            .flat_map(|key| [&key.position[..], &[key.yaw_deg, key.pitch_deg, key.roll_deg]].concat());
        let gaze = script.gaze.keyframes(90.0);
        let gaze = gaze.iter().flat_map(|key| [key.yaw_deg, key.pitch_deg]);
        let blinks = script.gaze.blinks().iter().flat_map(|blink| [blink.start as f32, blink.end as f32]);
        let numbers = head.chain(gaze).chain(blinks).chain([script.sound.loudness_lufs as f32]);
        // In steps of 1/64 of a degree or metre: a difference in an angle's last digit does not make another script.
        let found = hash_of_numbers(numbers.map(|number| number / 64.0));
        assert_frozen(&format!("the script of {:?}", frozen.scene), found, frozen.script);
    }
}

#[test]
fn as_much_is_drawn_at_all_times() {
    for name in SceneName::ALL {
        let scene = Scene::new(name);
        let count = |time| scene.placements(time, &scene.lights(time, 16)).len();
        for time in [0.01, 3.3, 77.7] {
            assert_eq!(
                count(time),
                count(0.0),
                "{name:?} at {time}: the buffer of instances is made for time 0"
            );
        }
    }
}
