//! The frame graphs: an engine, the textures of a scene, the size of the eyes.

use crate::frame_graphs::engines::{Engine, compatibility, native, open, unity, unreal};
use crate::frame_graphs::frame::{Arrangement, Frame};
use crate::frame_graphs::textures::Texture;
use Arrangement::{Array, DoubleWide, Separate};
use Texture::*;

/// One frame graph, or several in turn.
pub struct Graph {
    /// Its name in tables.
    pub name: &'static str,
    /// Size of an eye buffer, pixels.
    pub eye: [u32; 2],
    /// Arrangement of the eyes in the swapchain.
    pub arrangement: Arrangement,
    /// Whether the resolution changes.
    pub is_dynamic: bool,
    /// Side of the scene's targets where it does not, in sides of the eye buffer.
    side: f32,
    /// Whether no descriptors are known.
    pub is_bindless: bool,
    /// Engines with their textures, each for [`Graph::FRAMES`] frames.
    scenes: &'static [(Engine, &'static [Texture])],
}

impl Graph {
    /// Frames of each scene.
    pub const FRAMES: u64 = 1000;

    /// Frames of all of it.
    pub fn frames(&self) -> u64 {
        Self::FRAMES * self.scenes.len() as u64
    }

    /// Side of the scene's targets in a frame, in sides of the eye buffer. Dynamic resolution takes a step each third frame.
    pub fn scale(&self, frame: u64) -> f32 {
        let steps = [1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.55, 0.65, 0.75, 0.85, 0.95];
        if self.is_dynamic { steps[(frame / 3) as usize % steps.len()] } else { self.side }
    }

    /// Draws a frame.
    pub(crate) fn draw(&self, frame: &mut Frame<'_>) {
        let scene = (frame.number / Self::FRAMES) as usize;
        if let Some((engine, textures)) = self.scenes.get(scene) {
            engine(frame, textures);
        }
    }

    const fn new(
        name: &'static str,
        eye: [u32; 2],
        arrangement: Arrangement,
        scenes: &'static [(Engine, &'static [Texture])],
    ) -> Self {
        Self { name, eye, arrangement, is_dynamic: false, side: 1.0, is_bindless: false, scenes }
    }

    const fn dynamic(self) -> Self {
        Self { is_dynamic: true, ..self }
    }

    /// A third of the sides, as upscalers render in their fastest mode.
    const fn third(self) -> Self {
        Self { side: 1.0 / 3.0, ..self }
    }

    const fn bindless(self) -> Self {
        Self { is_bindless: true, ..self }
    }
}

/// Square eyes: Bigscreen Beyond.
const SQUARE: [u32; 2] = [2560, 2560];
/// Eyes that are higher than wide: Valve Index at full resolution.
const TALL: [u32; 2] = [2016, 2240];

/// Distractors of a square eye: everything of the measurement.
const ALL_SQUARE: &[Texture] =
    &[Evsm(2048), Evsm(4096), Page(2048), Scope(1280), Screen(1280), Planar(2560), Mirror(1.0)];
/// Mirrors of the same aspect at three sizes.
const MIRRORS: &[Texture] = &[Mirror(0.5), Mirror(0.75), Mirror(1.0)];

/// All frame graphs.
pub const GRAPHS: &[Graph] = &[
    Graph::new("native-straight", TALL, Separate, &[(native::straight, MIRRORS)]),
    Graph::new("native-straight-square", SQUARE, Separate, &[(native::straight, ALL_SQUARE)]),
    Graph::new("native-spectator", TALL, Separate, &[(native::spectator, &[Shadow(2048)])]),
    Graph::new("native-spectator-square", SQUARE, Separate, &[(native::spectator, &[Evsm(2048)])]),
    Graph::new("native-pooled-mirror", TALL, Separate, &[(native::pooled_mirror, &[Shadow(2048)])]),
    Graph::new(
        "native-pooled-clears",
        TALL,
        Separate,
        &[(native::pooled_mirror_with_clears, &[Shadow(2048)])],
    ),
    Graph::new("native-light-volumes", TALL, Separate, &[(native::light_volumes, MIRRORS)]),
    Graph::new("native-light-volumes-square", SQUARE, Separate, &[(native::light_volumes, ALL_SQUARE)]),
    Graph::new("native-visibility", SQUARE, Separate, &[(native::visibility, &[Evsm(2048), Planar(1024)])]),
    Graph::new("native-visor", TALL, Separate, &[(native::visor, &[Minimap(512), Shadow(4096)])]),
    Graph::new(
        "native-hands",
        TALL,
        Separate,
        &[(native::hands_over_picture, &[Shadow(4096), Mirror(0.75)])],
    ),
    Graph::new("native-hands-bindless", TALL, Separate, &[(native::hands_over_picture, &[Shadow(4096)])])
        .bindless(),
    Graph::new("native-cockpit", TALL, Separate, &[(native::cockpit, MIRRORS)]),
    Graph::new("native-cockpit-bindless", TALL, Separate, &[(native::cockpit, &[Shadow(4096)])]).bindless(),
    Graph::new("native-interface", TALL, Separate, &[(native::interface_over_picture, MIRRORS)]),
    Graph::new(
        "native-interface-bindless",
        TALL,
        Separate,
        &[(native::interface_over_picture, &[Shadow(4096)])],
    )
    .bindless(),
    Graph::new("native-interface-pool", TALL, Separate, &[(native::interface_in_pool, MIRRORS)]),
    Graph::new("native-dome", TALL, Separate, &[(native::dome, &[Shadow(4096)])]),
    Graph::new("native-dome-bindless", TALL, Separate, &[(native::dome, &[Mirror(1.0)])]).bindless(),
    Graph::new("native-outlines", TALL, Separate, &[(native::outlines, &[Shadow(4096)])]),
    Graph::new("native-film", TALL, Separate, &[(native::film, &[])]),
    Graph::new(
        "native-visibility-compute",
        SQUARE,
        Separate,
        &[(native::visibility_compute, &[Evsm(2048), Planar(1024)])],
    ),
    Graph::new("urp-copied", TALL, Separate, &[(unity::urp_copied, &[Shadow(4096), Mirror(0.75)])]),
    Graph::new("urp-multi-pass", TALL, Separate, &[(unity::urp_multi_pass, MIRRORS)]),
    Graph::new("urp-multi-pass-square", SQUARE, Separate, &[(unity::urp_multi_pass, ALL_SQUARE)]),
    Graph::new("urp-multi-pass-dynamic", TALL, Array, &[(unity::urp_multi_pass, MIRRORS)]).dynamic(),
    Graph::new("urp-instanced", TALL, Array, &[(unity::urp_instanced, MIRRORS)]),
    Graph::new("urp-instanced-square", SQUARE, Array, &[(unity::urp_instanced, ALL_SQUARE)]),
    Graph::new("urp-instanced-cascades", SQUARE, Array, &[(unity::urp_instanced, &[EvsmCascades(2048)])]),
    Graph::new("urp-direct", SQUARE, Array, &[(unity::urp_direct, ALL_SQUARE)]),
    Graph::new(
        "hdrp",
        TALL,
        Array,
        &[(unity::hdrp, &[ToneMappedMirror(1.0), Shadow(4096), Octahedral(2048), Probe(256)])],
    ),
    Graph::new("hdrp-square-dynamic", SQUARE, Array, &[(unity::hdrp, ALL_SQUARE)]).dynamic(),
    Graph::new("unity-built-in", TALL, Separate, &[(unity::built_in, &[Portal, Scope(1024), Shadow(4096)])]),
    Graph::new(
        "unity-built-in-square",
        SQUARE,
        Separate,
        &[(unity::built_in, &[Mirror(0.5), LateScope(1280)])],
    ),
    Graph::new("unity-effects", TALL, Separate, &[(unity::effects_between, &[Mirror(0.75), Shadow(4096)])]),
    Graph::new("unity-effects-heaps", TALL, Separate, &[(unity::effects_between, &[Shadow(4096)])])
        .bindless(),
    Graph::new("unreal-forward", TALL, DoubleWide, &[(unreal::forward, &[Planar(1120), Probe(128)])]),
    Graph::new("unreal-forward-square", SQUARE, DoubleWide, &[(unreal::forward, ALL_SQUARE)]).dynamic(),
    Graph::new("unreal-mobile", TALL, Array, &[(unreal::mobile, MIRRORS)]),
    Graph::new(
        "unreal-deferred",
        TALL,
        DoubleWide,
        &[(unreal::deferred, &[Shadow(4096), Planar(2016), Screen(1024)])],
    ),
    Graph::new("unreal-deferred-dynamic", SQUARE, DoubleWide, &[(unreal::deferred, ALL_SQUARE)]).dynamic(),
    Graph::new(
        "unreal-deferred-compute",
        TALL,
        Separate,
        &[(unreal::deferred_compute, &[Shadow(4096), Scope(1024)])],
    ),
    Graph::new(
        "unreal-translucency",
        TALL,
        DoubleWide,
        &[(unreal::separate_translucency, &[Shadow(4096), Planar(1024)])],
    ),
    Graph::new(
        "unreal-temporal-compute",
        TALL,
        DoubleWide,
        &[(unreal::temporal_compute, &[Shadow(4096), Planar(1024), Screen(1024)])],
    ),
    Graph::new(
        "unreal-temporal-plain",
        TALL,
        DoubleWide,
        &[(unreal::temporal_plain, &[Shadow(4096), Screen(1024)])],
    ),
    Graph::new(
        "unreal-temporal-copied",
        TALL,
        DoubleWide,
        &[(unreal::temporal_copied, &[Shadow(4096), Planar(1024), Screen(1024)])],
    ),
    Graph::new(
        "unreal-5-vkd3d",
        TALL,
        DoubleWide,
        &[(unreal::deferred, &[Shadow(4096), Planar(1024), Screen(1024)])],
    )
    .bindless(),
    Graph::new("unreal-5-vkd3d-compute", SQUARE, Separate, &[(unreal::deferred_compute, &[Shadow(4096)])])
        .bindless(),
    Graph::new("source-2", SQUARE, Separate, &[(open::source2, &[Shadow(6144), Scope(1280), Page(2048)])])
        .dynamic(),
    Graph::new("source-2-tall", TALL, Separate, &[(open::source2, &[Mirror(0.75), Screen(1024)])]),
    Graph::new("godot-mobile", TALL, Array, &[(open::godot_mobile, MIRRORS)]),
    Graph::new(
        "godot-forward",
        SQUARE,
        Array,
        &[(open::godot_forward, &[Mirror(1.0), Page(1024), Evsm(2048)])],
    ),
    Graph::new("bevy", TALL, Array, &[(open::bevy, &[Shadow(2048), Mirror(1.0)])]),
    Graph::new("bevy-square", SQUARE, Separate, &[(open::bevy, ALL_SQUARE)]).dynamic(),
    Graph::new("id-tech-7", TALL, Array, &[(open::id_tech, &[Shadow(8192), Planar(1008)])]),
    Graph::new("id-tech-blits", SQUARE, Separate, &[(open::id_tech_blits, ALL_SQUARE)]).dynamic(),
    Graph::new("dxvk-forward", TALL, Separate, &[(compatibility::dxvk_forward, MIRRORS)]),
    Graph::new("dxvk-forward-square", SQUARE, DoubleWide, &[(compatibility::dxvk_forward, ALL_SQUARE)]),
    Graph::new("dxvk-deferred", SQUARE, Separate, &[(compatibility::dxvk_deferred, ALL_SQUARE)]),
    Graph::new(
        "dxvk-deferred-tall",
        TALL,
        Separate,
        &[(compatibility::dxvk_deferred, &[ToneMappedMirror(0.75)])],
    )
    .dynamic(),
    Graph::new("dxvk-deferred-thin", TALL, Separate, &[(compatibility::dxvk_deferred_thin, &[Shadow(4096)])]),
    Graph::new(
        "vkd3d-deferred-thin",
        TALL,
        Separate,
        &[(compatibility::dxvk_deferred_thin, &[Shadow(4096)])],
    )
    .bindless(),
    Graph::new("dxvk-pooled", TALL, Separate, &[(compatibility::dxvk_pooled, &[Mirror(0.75), Shadow(2048)])]),
    Graph::new("native-visor-third", TALL, Separate, &[(native::visor, &[Minimap(512), Shadow(4096)])])
        .third(),
    Graph::new("urp-multi-pass-third", TALL, Separate, &[(unity::urp_multi_pass, MIRRORS)]).third(),
    Graph::new(
        "unreal-deferred-third",
        TALL,
        DoubleWide,
        &[(unreal::deferred, &[Shadow(4096), Screen(1024)])],
    )
    .third(),
    Graph::new(
        "unreal-temporal-compute-third",
        TALL,
        DoubleWide,
        &[(unreal::temporal_compute, &[Shadow(4096), Planar(1024), Screen(1024)])],
    )
    .third(),
    Graph::new("dxvk-deferred-third", SQUARE, Separate, &[(compatibility::dxvk_deferred, ALL_SQUARE)])
        .third(),
    // The same where DXVK's descriptors are in heaps or buffers, which is the default since 2026.
    Graph::new("dxvk-forward-heaps", TALL, Separate, &[(compatibility::dxvk_forward, MIRRORS)]).bindless(),
    Graph::new("dxvk-deferred-heaps", SQUARE, Separate, &[(compatibility::dxvk_deferred, ALL_SQUARE)])
        .bindless(),
    Graph::new(
        "dxvk-pooled-heaps",
        TALL,
        Separate,
        &[(compatibility::dxvk_pooled, &[Mirror(0.75), Shadow(2048)])],
    )
    .bindless(),
    Graph::new("open-vr", SQUARE, DoubleWide, &[(compatibility::open_vr, ALL_SQUARE)]),
    Graph::new("overlay", TALL, Separate, &[(compatibility::overlay, MIRRORS)]),
    Graph::new(
        "vkd3d-forward",
        TALL,
        Separate,
        &[(compatibility::dxvk_forward, &[Shadow(4096), Scope(1024)])],
    )
    .bindless(),
    Graph::new("vkd3d-forward-mirror", TALL, Separate, &[(compatibility::dxvk_forward, &[Mirror(1.0)])])
        .bindless(),
    Graph::new("vkd3d-deferred", SQUARE, Separate, &[(compatibility::dxvk_deferred, &[Shadow(4096)])])
        .bindless(),
    Graph::new(
        "switch-menu-and-game",
        TALL,
        Separate,
        &[
            (native::straight, &[Page(1024)]),
            (compatibility::dxvk_forward, MIRRORS),
            (native::straight, &[Page(1024)]),
        ],
    ),
    Graph::new(
        "switch-forward-and-deferred",
        SQUARE,
        Separate,
        &[
            (compatibility::dxvk_forward, ALL_SQUARE),
            (compatibility::dxvk_deferred, ALL_SQUARE),
            (native::light_volumes, &[Evsm(2048)]),
        ],
    ),
    Graph::new(
        "switch-textures",
        SQUARE,
        Array,
        &[
            (unity::urp_instanced, &[Mirror(1.0), Scope(1280)]),
            (unity::urp_instanced, &[Scope(1280), Evsm(2048), Mirror(0.5)]),
            (unity::urp_instanced, &[]),
        ],
    ),
];
