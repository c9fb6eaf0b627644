//! Engines, and how they are run.

/// An engine with one of its renderers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Engine {
    /// Godot's name for the renderer.
    pub renderer: &'static str,
    /// Samples of a pixel.
    pub samples: u32,
    /// Whether the head turns from frame to frame.
    pub moves: bool,
}

impl Engine {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::still("mobile", 1),
        Self::still("mobile", 2),
        Self::still("mobile", 4),
        Self::still("forward_plus", 1),
        Self::still("forward_plus", 2),
        Self::still("forward_plus", 4),
        Self { moves: true, ..Self::still("mobile", 1) },
        Self { moves: true, ..Self::still("forward_plus", 4) },
    ];

    const fn still(renderer: &'static str, samples: u32) -> Self {
        Self { renderer, samples, moves: false }
    }

    /// Its name in tables.
    pub fn name(self) -> String {
        let renderer = self.renderer.replace("_plus", "+");
        let moves = if self.moves { "-moving" } else { "" };
        format!("godot-{renderer}-msaa{}{moves}", self.msaa())
    }

    /// Godot's number for the samples of a pixel: 0 for one.
    fn msaa(self) -> u32 {
        if self.samples == 1 { 0 } else { self.samples }
    }

    /// Its command line in the system.
    pub fn command(self, settings: &Settings) -> Vec<String> {
        let Settings { warm, settle_s, frames, rounds, .. } = settings;
        let fixed = ["godot", "--path", "/opt/engines/godot", "--fixed-fps", "60", "--rendering-method"];
        let own = [
            self.renderer.to_owned(),
            "--".to_owned(),
            format!("msaa={}", self.msaa()),
            format!("head={}", if self.moves { "moving" } else { "still" }),
            format!("warm={warm}"),
            format!("settle={settle_s}"),
            format!("frames={frames}"),
            format!("rounds={rounds}"),
        ];
        fixed.map(str::to_owned).into_iter().chain(own).collect()
    }
}

/// The layer in a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Mode {
    /// Not there.
    Off,
    /// The preset `balanced`, gaze straight ahead, and the gate decides.
    Auto,
    /// The same with the gate open.
    On,
    /// Rates by contrast and sound, re-use and chroma: every kernel.
    Everything,
}

impl Mode {
    /// Its configuration; None without the layer.
    pub fn config(self) -> Option<&'static str> {
        match self {
            Self::Off => None,
            Self::Auto => Some("preset = \"balanced\"\n[gaze]\nsource = \"centre\"\n"),
            Self::On => Some("preset = \"balanced\"\n[gaze]\nsource = \"centre\"\n[rates]\ngate = \"on\"\n"),
            Self::Everything => Some(
                "[gaze]\nsource = \"centre\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n\
                 [reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n",
            ),
        }
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
    /// A timed run.
    pub fn timed(scale: u32, mode: Mode) -> Self {
        let settle_s = if mode == Mode::Auto { 30 } else { 0 };
        Self { scale, warm: 30, settle_s, frames: 10, rounds: 2 }
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

    #[test]
    fn engines_have_names_and_arguments_of_their_own() {
        let settings = Settings::timed(200, Mode::Auto);
        let names: std::collections::BTreeSet<_> = Engine::ALL.map(Engine::name).into();
        assert_eq!(names.len(), Engine::ALL.len());
        assert!(names.contains("godot-mobile-msaa0") && names.contains("godot-forward+-msaa4"), "{names:?}");
        let command = Engine::still("mobile", 1).command(&settings).join(" ");
        assert!(
            command.ends_with("mobile -- msaa=0 head=still warm=30 settle=30 frames=10 rounds=2"),
            "{command}"
        );
    }
}
