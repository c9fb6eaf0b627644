//! The options, each stated once: the table below makes the typed [`Config`], its defaults, what is
//! allowed, the error texts and the commented default file.

mod choice;
mod default_file;
mod file_path;
mod pass_rules;
mod periods;
mod preset;
mod setting;
mod table;

pub use default_file::default_file;
pub use file_path::FilePath;
pub use pass_rules::{
    COLOR_FORMATS, ColorFormat, MOST_RULES, PassKind, PassRule, PassRules, PassRulesError, WayUp,
};
pub use periods::Periods;
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
        /// the eye tracker; without one, colour stays, and rates fall off from straight ahead, widely
        Eyes = "eyes",
        /// straight ahead, always, as if the eyes never moved: for headsets without an eye tracker
        Centre = "centre",
        /// what gaze.file says, whatever the eyes do: for tests and demonstrations
        File = "file",
    }
}

choice! {
    /// Whether and how shading becomes coarser.
    RatesMode {
        /// every pixel is shaded
        Off = "off",
        /// by the angle from the gaze alone, in rings
        Fixed = "fixed",
        /// by the contrast of the pictures and by what is heard, for which audio.source must be set; in silence as "fixed"
        AudioVisual = "audio-visual",
        /// the same as it was published, without any limit on what sound hides: to compare with
        Paper = "paper",
    }
}

choice! {
    /// What holds while nothing is heard.
    SilenceRule {
        /// the rings of mode = "fixed"
        Fixed = "fixed",
        /// nothing may be lost that is seen
        Strict = "strict",
    }
}

choice! {
    /// How the application's passes are made to shade more coarsely.
    RatesBackend {
        /// by a rate attachment where the device has such, else by a mask
        Auto = "auto",
        /// by a rate attachment (VK_KHR_fragment_shading_rate) or not at all
        Attachment = "attachment",
        /// by a mask: pixels are skipped, and filled in from those around them
        Mask = "mask",
        /// not at all
        Off = "off",
    }
}

choice! {
    /// Whether rates and re-use stay where they do not pay.
    RatesGate {
        /// they are dropped where frames cost more with them, by time spent; tried anew from time to time
        Auto = "auto",
        /// they stay, whatever they cost
        On = "on",
        /// none, but everything else is ready for them: to compare with
        Off = "off",
    }
}

choice! {
    /// How many pixels are shaded at once.
    PeripheralRate {
        /// two
        R2x1 = "2x1",
        /// four
        R2x2 = "2x2",
        /// eight
        R4x2 = "4x2",
        /// sixteen
        R4x4 = "4x4",
    }
}

choice! {
    /// Whether and how the periphery is re-used.
    ReuseMode {
        /// every frame renders everything
        Off = "off",
        /// from where it is in earlier frames, as the head turns
        On = "on",
        /// as it was published, for comparison: it stays where it is in the picture, and all of a region is rendered at once
        Paper = "paper",
    }
}

choice! {
    /// Which frames render which directions.
    ReusePhase {
        /// patches of 15 degrees take turns, so that frames cost the same
        Staggered = "staggered",
        /// all of a region in one frame
        Aligned = "aligned",
        /// all of a region in one frame, the right eye half a period later: its delay can be taken for depth
        AlternateEye = "alternate-eye",
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

choice! {
    /// What is listened to.
    AudioSource {
        /// nothing
        Off = "off",
        /// what the system plays (PulseAudio, PipeWire with pipewire-pulse, ALSA's loop-back card); never a microphone
        System = "system",
        /// the WAV file that audio.file names, over and over
        File = "file",
    }
}

choice! {
    /// How the last seconds of sound are summed up.
    AudioMode {
        /// what allows less: of the last 400 ms and of all of audio.window_s
        Default = "default",
        /// as it was published, over all of audio.window_s, with the gates of BS.1770: to compare with
        Paper = "paper",
    }
}

choice! {
    /// What is drawn over the pictures in the headset, for people to see what is done; see the guide.
    DebugView {
        /// nothing
        None = "none",
        /// how coarsely each tile is shaded: green for a half of the pixels, to violet for a sixteenth
        Rates = "rates",
        /// the angle from the gaze: a line every 10 degrees
        Eccentricity = "eccentricity",
        /// how many frames ago each tile was rendered: nothing where it is new, then yellow to red
        Age = "age",
        /// a dot where the eyes are taken to look: who sees the picture sees that
        Gaze = "gaze",
    }
}

presets! {
    /// Values that belong together, for what is not set itself.
    Preset {
        /// every technique is off
        None = "none" { rates.mode = RatesMode::Off; }
        /// what few notice: a periphery of a quarter of the shading
        Quality = "quality" { rates.peripheral = PeripheralRate::R2x2; }
        /// the state of the art: a sixteenth from 27 degrees on
        Balanced = "balanced" {}
        /// noticed at times: a sixteenth from 18 degrees on
        Performance = "performance" {
            rates.transitional_deg = 18.39;
            reuse.periods = Periods::of([1, 1, 2, 3, 3]);
        }
        /// balanced, and less colour to encode, for pictures that are sent to the headset as video
        Streaming = "streaming" { chroma.mode = ChromaMode::Default; }
        /// balanced as it was published, without what makes it safe: to compare with
        Paper = "paper" {}
    }
}

options! {
    /// What the user can set. `Default` is what holds without any file.
    Config {
        /// Whether anything is done at all; false leaves the application as it is.
        enabled: bool = true;
        /// Values that belong together, for what is not set itself.
        preset: Preset = Preset::Balanced;
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
        /// After how long an application without input of its own is taken to have none, and the eye tracker asked: input that it sets up later would not work; 0: never.
        attach_alone_after_s: u32 = 30, 0..=600 "seconds";
        /// For source = "file": lines of seconds, degrees to the left and degrees upwards, apart by commas; seconds alone where the eyes are not seen.
        file: FilePath = FilePath::NONE;
        /// A new file that the gaze is written to, as gaze.file reads it; without, it is written nowhere.
        record: FilePath = FilePath::NONE;
    }

    /// What the user hears, which stays in the game's process, in memory.
    audio: Audio {
        /// What is listened to.
        source: AudioSource = AudioSource::Off;
        /// The file for audio.source = "file".
        file: FilePath = FilePath::NONE;
        /// How the last seconds of sound are summed up.
        mode: AudioMode = AudioMode::Default;
        /// How many seconds those are.
        window_s: f32 = 3.0, 0.4..=120.0 "seconds";
        /// How often loudness and pitch are looked at anew, in steps of 0.1.
        interval_s: f32 = 0.1, 0.1..=1.0 "seconds";
        /// What is less loud counts as this.
        least_lufs: f32 = -35.0, -70.0..=0.0 "LUFS";
        /// What is louder counts as this.
        greatest_lufs: f32 = -10.0, -70.0..=0.0 "LUFS";
    }

    /// Shading, coarser where the eye does not resolve it.
    rates: Rates {
        /// Whether and how shading becomes coarser.
        mode: RatesMode = RatesMode::Fixed;
        /// How the application's passes are made to shade more coarsely.
        backend: RatesBackend = RatesBackend::Auto;
        /// Whether rates and re-use stay in an application that becomes slower with them, each by itself.
        gate: RatesGate = RatesGate::Auto;
        /// Which passes are the scene, where that is not recognised; empty: recognised.
        passes: PassRules = PassRules::default();
        /// Every pixel is shaded up to this angle from the gaze; the tracker's error and the eyes' motion are added.
        foveal_deg: f32 = 14.34, 5.0..=110.0 "degrees";
        /// The angle from the gaze from which on the peripheral rate holds; rates in between fall to it step by step.
        transitional_deg: f32 = 27.08, 5.0..=110.0 "degrees";
        /// The coarsest rate, in pixels that are shaded at once; a device without it uses the next finer one.
        peripheral: PeripheralRate = PeripheralRate::R4x4;
        /// For mode = "audio-visual": how much contrast sound may hide, in multiples of what is just seen; more is noticed by some.
        greatest_loss: f32 = 1.0, 0.0..=4.0 "";
        /// For mode = "audio-visual": what holds while nothing is heard.
        silence: SilenceRule = SilenceRule::Fixed;
        /// For modes that look at pictures: how bright the headset shows white.
        white_cd_m2: f32 = 100.0, 10.0..=10_000.0 "cd/m^2";
    }

    /// The periphery, rendered less often than each frame, and shown from earlier frames in between.
    reuse: Reuse {
        /// Whether and how the periphery is re-used.
        mode: ReuseMode = ReuseMode::Off;
        /// Of how many frames one renders each of five regions around the gaze, the innermost first; they end at 6.3, 9.1, 18.1 and 31.1 degrees.
        periods: Periods = Periods::of([1, 1, 2, 2, 3]);
        /// Which frames render which directions, for mode = "on".
        phase: ReusePhase = ReusePhase::Staggered;
        /// Whether a region may be rendered less than 30 times a second, where flicker is worst; in mode = "paper" it always may.
        below_30_hz: bool = false;
        /// Whether what is seen to change in the periphery is rendered in each frame, as far as there is room for it; in mode = "paper" it never is.
        refresh: bool = true;
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

    /// Seeing what is done, in the headset.
    debug: Debugging {
        /// What is drawn over the pictures, for people to see what is done; parafovea status --view changes it while a game runs.
        view: DebugView = DebugView::None;
    }
}
