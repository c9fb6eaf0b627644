//! Engines, and how they are run.

use parafovea::config::Preset;

/// An engine with one of its ways of drawing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Engine {
    /// The program.
    pub program: Program,
    /// Samples of a pixel.
    pub samples: u32,
    /// Whether the head turns from frame to frame.
    pub moves: bool,
    /// The rendered scene.
    pub scene: Scene,
    /// Whether there is an eye tracker: the gaze of a file ([`Engine::gaze`]). Otherwise the layer uses the centre of the view.
    pub is_tracked: bool,
    /// Whether MangoHud and vkBasalt are in the application, too.
    pub has_overlays: bool,
    /// The layer's preset.
    pub preset: Preset,
}

/// A program with a renderer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Program {
    /// Godot, with its name for the renderer.
    Godot(&'static str),
    /// Qt Quick 3D XR.
    Qt {
        /// Whether a pass draws both eyes, by multiview.
        is_multiview: bool,
        /// Whether depth is drawn to swapchains, too, and submitted.
        submits_depth: bool,
        /// Whether the scene goes through post-processing: the default of Qt's extended environment; else its passes draw to the swapchain.
        has_effects: bool,
    },
}

/// A scene of our Godot project (`tests/engines/godot/room.gd`); that of Qt is the full one.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Scene {
    /// Ten lights, two with shadows, a mirror and a screen: heavy in fragment shading.
    Full,
    /// The same with one light and no shadow, mirror or screen: more frames a second.
    Light,
    /// The latter with surfaces of one colour: shading costs next to nothing, so that there is nothing to gain.
    Flat,
}

impl Scene {
    /// Its name in the engine's arguments.
    fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Light => "light",
            Self::Flat => "flat",
        }
    }
}

impl Engine {
    /// All of them.
    pub const ALL: [Self; 24] = [
        Self::still(MOBILE, 1),
        Self::still(MOBILE, 2),
        Self::still(MOBILE, 4),
        Self::still(FORWARD_PLUS, 1),
        Self::still(FORWARD_PLUS, 2),
        Self::still(FORWARD_PLUS, 4),
        Self { moves: true, ..Self::still(MOBILE, 1) },
        Self { moves: true, ..Self::still(FORWARD_PLUS, 4) },
        Self { preset: Preset::Quality, ..Self::still(MOBILE, 1) },
        Self { preset: Preset::Quality, moves: true, ..Self::still(MOBILE, 1) },
        Self { scene: Scene::Light, ..Self::still(MOBILE, 1) },
        Self { scene: Scene::Light, is_tracked: true, ..Self::still(MOBILE, 1) },
        Self { scene: Scene::Light, is_tracked: true, ..Self::still(FORWARD_PLUS, 1) },
        Self { scene: Scene::Flat, ..Self::still(MOBILE, 1) },
        Self { scene: Scene::Flat, ..Self::still(FORWARD_PLUS, 1) },
        Self { scene: Scene::Light, has_overlays: true, ..Self::still(MOBILE, 1) },
        Self { scene: Scene::Light, has_overlays: true, ..Self::still(FORWARD_PLUS, 1) },
        Self::still(QT, 1),
        Self::still(QT, 4),
        Self { moves: true, ..Self::still(QT, 4) },
        Self::still(Program::Qt { is_multiview: true, submits_depth: false, has_effects: true }, 4),
        Self::still(Program::Qt { is_multiview: false, submits_depth: false, has_effects: false }, 1),
        Self::still(Program::Qt { is_multiview: false, submits_depth: false, has_effects: false }, 4),
        Self::still(Program::Qt { is_multiview: false, submits_depth: true, has_effects: false }, 1),
    ];

    const fn still(program: Program, samples: u32) -> Self {
        Self {
            program,
            samples,
            moves: false,
            scene: Scene::Full,
            is_tracked: false,
            has_overlays: false,
            preset: Preset::Balanced,
        }
    }

    /// Its name in tables.
    pub fn name(self) -> String {
        let mut name = match self.program {
            Program::Godot(renderer) => format!("godot-{}", renderer.replace("_plus", "+")),
            Program::Qt { is_multiview: true, .. } => "qt-multiview".to_owned(),
            Program::Qt { is_multiview: false, .. } => "qt-by-eye".to_owned(),
        };
        name += &format!("-msaa{}", self.msaa());
        let parts = [
            (matches!(self.program, Program::Qt { has_effects: true, .. }), "effects"),
            (matches!(self.program, Program::Qt { submits_depth: true, .. }), "depth"),
            (self.moves, "moving"),
            (self.scene != Scene::Full, self.scene.name()),
            (self.is_tracked, "tracked"),
            (self.has_overlays, "overlays"),
            (self.preset != Preset::Balanced, self.preset.name()),
        ];
        for (_, part) in parts.into_iter().filter(|(is_there, _)| *is_there) {
            name.extend(["-", part]);
        }
        name
    }

    /// The gaze of its tracker, as `gaze.file` has it: a second at each of five points up to six degrees from the centre of the view, over
    /// and over, for ten minutes; None without a tracker.
    pub fn gaze(self) -> Option<String> {
        const POINTS: [[i32; 2]; 5] = [[0, 0], [6, 0], [0, 4], [-6, 0], [0, -4]];
        const SACCADE_S: f32 = 0.04;
        let seconds = (0..600).zip(POINTS.into_iter().cycle());
        let lines = seconds.map(|(second, [left, up])| {
            let end = (second + 1) as f32 - SACCADE_S;
            format!("{second},{left},{up}\n{end},{left},{up}\n")
        });
        self.is_tracked.then(|| lines.collect())
    }

    /// Number of samples in scripts: 0 for one.
    fn msaa(self) -> u32 {
        if self.samples == 1 { 0 } else { self.samples }
    }

    /// Environment variables and the command line in the system, for `env`; scripts wait for a folder of pictures, where one is given.
    pub fn command(self, settings: &Settings, pictures: Option<&str>) -> Vec<String> {
        let (msaa, head) = (self.msaa(), if self.moves { "moving" } else { "still" });
        let Settings { warm, settle_s, frames, rounds, .. } = settings;
        let mut words = if self.has_overlays { vec!["MANGOHUD=1", "ENABLE_VKBASALT=1"] } else { Vec::new() };
        match self.program {
            Program::Godot(renderer) => {
                words.extend(["godot", "--path", "/opt/engines/godot", "--fixed-fps", "60"]);
                words.extend(["--rendering-method", renderer]);
            }
            Program::Qt { is_multiview, submits_depth, .. } => {
                words.extend(["LC_ALL=C.UTF-8", "QSG_RHI_BACKEND=vulkan"]);
                // Scripts read and write files by requests: CPU time, and the number of a saved frame.
                words.extend(["QML_XHR_ALLOW_FILE_READ=1", "QML_XHR_ALLOW_FILE_WRITE=1"]);
                if !is_multiview {
                    words.push("QT_QUICK3D_XR_DISABLE_MULTIVIEW=1");
                }
                if submits_depth {
                    words.push("QT_QUICK3D_XR_SUBMIT_DEPTH=1");
                }
                words.extend(["/usr/lib/qt6/bin/qml", "/opt/engines/qt/main.qml"]);
            }
        }
        let mut words: Vec<String> = words.into_iter().map(str::to_owned).collect();
        words.extend(["--".to_owned(), format!("msaa={msaa}"), format!("head={head}")]);
        match self.program {
            Program::Godot(_) => words.push(format!("scene={}", self.scene.name())),
            Program::Qt { has_effects, .. } => {
                words.push(format!("effects={}", if has_effects { "on" } else { "off" }));
                words.extend(pictures.map(|folder| format!("pictures={folder}")));
            }
        }
        words.extend([
            format!("warm={warm}"),
            format!("settle={settle_s}"),
            format!("frames={frames}"),
            format!("rounds={rounds}"),
        ]);
        words
    }
}

/// Godot's renderers.
const MOBILE: Program = Program::Godot("mobile");
const FORWARD_PLUS: Program = Program::Godot("forward_plus");

/// Qt with its default settings.
const QT: Program = Program::Qt { is_multiview: true, submits_depth: false, has_effects: false };

/// The layer in a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Mode {
    /// Not there.
    Off,
    /// A preset, and the gate decides.
    Auto,
    /// The same with the gate open.
    On,
    /// Rates by contrast and sound, re-use and chroma: every kernel.
    Everything,
}

impl Mode {
    /// Its configuration with a preset, and with the gaze of a file, or at the centre of the view without one; None without the layer.
    pub fn config(self, preset: Preset, gaze: Option<&str>) -> Option<String> {
        let techniques = match self {
            Self::Off => return None,
            Self::Auto => "",
            Self::On => "[rates]\ngate = \"on\"\n",
            Self::Everything => {
                "[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n\
                 [reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n"
            }
        };
        let gaze = match gaze {
            Some(file) => format!("[gaze]\nsource = \"file\"\nfile = \"{file}\"\n"),
            None => "[gaze]\nsource = \"centre\"\n".to_owned(),
        };
        Some(format!("preset = \"{}\"\n{gaze}{techniques}", preset.name()))
    }

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Auto => "auto",
            Self::On => "on",
            Self::Everything => "everything",
        }
    }
}

/// The length and size of a run.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Width and height of an eye buffer, per cent of Monado's 320x240; it takes up to 200.
    pub scale: u32,
    /// Frames before the measurement: passes are known, pipelines compiled.
    pub warm: u32,
    /// Seconds from the start to the measurement at least: the gate has decided.
    pub settle_s: u32,
    /// Frames of a round.
    pub frames: u32,
    /// Rounds.
    pub rounds: u32,
}

impl Settings {
    /// Width and height of an eye buffer in pixels, as Monado recommends them to engines.
    pub fn eye(&self) -> [u32; 2] {
        [320, 240].map(|full: u32| full * self.scale / 100)
    }

    /// A timed run. CPU time is counted in hundredths of a second, so that a round of short frames takes more of them.
    pub fn timed(scale: u32, scene: Scene, mode: Mode) -> Self {
        let settle_s = if mode == Mode::Auto { 30 } else { 0 };
        let frames = if scene == Scene::Full { 10 } else { 100 };
        Self { scale, warm: 30, settle_s, frames, rounds: 2 }
    }

    /// A run whose samples are counted.
    pub fn counted(scale: u32) -> Self {
        Self { scale, warm: 30, settle_s: 0, frames: 4, rounds: 1 }
    }

    /// A run whose pictures are saved: a quarter of a second, over which changes are seen together. The last frame may end after the engine
    /// has quit.
    pub fn pictured(scale: u32) -> Self {
        Self { scale, warm: 30, settle_s: 0, frames: 16, rounds: 1 }
    }

    /// A run under validation, which is slow: a small picture.
    pub fn validated() -> Self {
        Self { scale: 50, warm: 30, settle_s: 0, frames: 10, rounds: 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea::config::GazeSource;
    use parafovea::inputs::gaze::script::GazeScript;
    use parafovea_manifest::config::parse;
    use std::path::Path;

    #[test]
    fn engines_have_names_and_arguments_of_their_own() {
        let settings = Settings::timed(200, Scene::Full, Mode::Auto);
        let names: std::collections::BTreeSet<_> = Engine::ALL.map(Engine::name).into();
        assert_eq!(names.len(), Engine::ALL.len());
        assert!(names.contains("godot-mobile-msaa0") && names.contains("godot-forward+-msaa4"), "{names:?}");
        let command = Engine::still(MOBILE, 1).command(&settings, None).join(" ");
        assert!(
            command.ends_with("mobile -- msaa=0 head=still scene=full warm=30 settle=30 frames=10 rounds=2"),
            "{command}"
        );
        let qt =
            Engine::still(Program::Qt { is_multiview: false, submits_depth: true, has_effects: true }, 4);
        assert_eq!(qt.name(), "qt-by-eye-msaa4-effects-depth");
        let command = qt.command(&settings, Some("/tmp/pictures")).join(" ");
        assert!(
            command.contains(" QT_QUICK3D_XR_DISABLE_MULTIVIEW=1 QT_QUICK3D_XR_SUBMIT_DEPTH=1 "),
            "{command}"
        );
        assert!(
            command.contains(" msaa=4 head=still effects=on pictures=/tmp/pictures warm=30 "),
            "{command}"
        );
        assert_eq!(settings.eye(), [640, 480]);
    }

    #[test]
    fn configurations_and_gazes_are_as_the_layer_reads_them() {
        for engine in Engine::ALL {
            let gaze = engine.gaze().map(|gaze| gaze.parse::<GazeScript>());
            assert!(
                gaze.is_none_or(|gaze| gaze.is_ok_and(|gaze| gaze.at(300.5).is_some())),
                "{}",
                engine.name()
            );
        }
        for mode in [Mode::Auto, Mode::On, Mode::Everything] {
            for gaze in [None, Some("/opt/gaze.csv")] {
                let text = mode.config(Preset::Balanced, gaze).unwrap();
                let config = parse(Path::new("config.toml"), &text).unwrap();
                assert_eq!(config.gaze.source == GazeSource::File, gaze.is_some());
            }
        }
        assert_eq!(Mode::Off.config(Preset::Balanced, None), None);
    }
}
