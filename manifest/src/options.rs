//! The options, each stated once: the table below makes the typed [`Config`], its defaults, what is
//! allowed, the error texts and the commented default file.

mod choice;
mod default_file;
mod preset;
mod setting;
mod table;

pub use default_file::default_file;
pub use setting::{Allowed, Setting};
pub use table::OptionSpec;

use choice::choice;
use preset::presets;
use table::options;

choice! {
    /// How much goes to the log.
    LogLevel {
        /// what failed, and what was turned off because of it
        Error = "error",
        /// also what works only in part
        Warn = "warn",
        /// also what was found and decided
        Info = "info",
        /// also every step, for a bug report
        Debug = "debug",
    }
}

choice! {
    /// Where the gaze comes from.
    GazeSource {
        /// the eye tracker; without one nothing is done that depends on gaze
        Eyes = "eyes",
        /// straight ahead, always: for headsets without an eye tracker
        Centre = "centre",
    }
}

choice! {
    /// Whether and how colour is removed.
    ChromaMode {
        /// colour is left alone
        Off = "off",
        /// the published curves, outside a plateau of full colour; large fields stay visible, and nothing fades suddenly
        Default = "default",
        /// the published curves as they are, for comparison
        Paper = "paper",
    }
}

choice! {
    /// How luma and chroma are split (the standard's number is its name).
    ChromaMatrix {
        /// ITU-R BT.709, the primaries of sRGB
        Bt709 = "bt709",
        /// ITU-R BT.601
        Bt601 = "bt601",
        /// ITU-R BT.2020
        Bt2020 = "bt2020",
    }
}

presets! {
    /// Values that belong together, for what is not set itself.
    Preset {
        /// the defaults
        None = "none" {}
        /// for pictures that are sent to the headset as video: less colour to encode
        Streaming = "streaming" { chroma.mode = ChromaMode::Default; }
    }
}

options! {
    /// What the user can set. `Default` is what holds without any file.
    Config {
        /// Whether anything is done at all; false leaves the application as it is.
        enabled: bool = true;
        /// Values that belong together, for what is not set itself.
        preset: Preset = Preset::None;
    }

    /// What is written down.
    log: Log {
        /// How much goes to the log file.
        level: LogLevel = LogLevel::Info;
    }

    /// Where the user looks.
    gaze: Gaze {
        /// Where the gaze comes from.
        source: GazeSource = GazeSource::Eyes;
        /// For how long the last gaze is kept when the tracker loses the eyes, as in a blink.
        hold_ms: u32 = 500, 0..=500 "milliseconds";
    }

    /// Colour, removed where the eye does not resolve it.
    chroma: Chroma {
        /// Whether and how colour is removed.
        mode: ChromaMode = ChromaMode::Off;
        /// How fast blue-yellow (Cb) falls off, the Z of its curve: more removes more.
        cb_bound: f32 = 0.70, 0.70..=0.85 "";
        /// How fast red-green (Cr) falls off, the Z of its curve: more removes less.
        cr_bound: f32 = 0.55, 0.35..=0.55 "";
        /// Colour is left alone up to this angle from the gaze; not less than the tracker's error.
        plateau_deg: f32 = 6.3, 1.1..=30.0 "degrees";
        /// The angle from the gaze at which the curves end; in default mode at least 15 degrees beyond the plateau.
        max_eccentricity_deg: f32 = 55.0, 20.0..=110.0 "degrees";
        /// The least share of the way from plateau to max_eccentricity_deg over which all colour may go: no hard edge.
        rim_fade: f32 = 0.5, 0.25..=1.0 "";
        /// How much of its full colour a place may lose in a second, once the gaze has left it; it comes back at once.
        max_change_per_s: f32 = 0.5, 0.1..=100.0 "per second";
        /// How luma and chroma are split.
        matrix: ChromaMatrix = ChromaMatrix::Bt709;
    }
}
