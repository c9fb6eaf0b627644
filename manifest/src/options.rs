//! The options, each stated once: the table below makes the typed [`Config`], its defaults, what is
//! allowed, the error texts and the commented default file.

mod choice;
mod default_file;
mod file_path;
mod pass_rules;
mod periods;
mod preset;
mod reference;
mod setting;
mod table;

pub use default_file::default_file;
pub use file_path::FilePath;
pub use pass_rules::{
    COLOR_FORMATS, ColorFormat, MOST_RULES, PassKind, PassRule, PassRules, PassRulesError, WayUp,
};
pub use periods::Periods;
pub use reference::reference;
pub use setting::{Allowed, Setting};
pub use table::OptionSpec;

use choice::choice;
use preset::presets;
use table::options;

choice! {
    /// Amount of detail in the log.
    LogLevel {
        /// failures, and the features that they turned off
        Error = "error",
        /// also features that work only in part
        Warn = "warn",
        /// also findings and decisions
        Info = "info",
        /// also every step, for a bug report
        Debug = "debug",
    }
}

choice! {
    /// Source of the gaze.
    GazeSource {
        /// the eye tracker; without one, wide fixed foveation and no chroma attenuation
        Eyes = "eyes",
        /// the centre of the view, always: for headsets without an eye tracker
        Centre = "centre",
        /// the recording in gaze.file: for tests and demonstrations
        File = "file",
    }
}

choice! {
    /// Model for shading rates.
    RatesMode {
        /// full rate everywhere
        Off = "off",
        /// foveation in rings, by the angle from the gaze alone
        Fixed = "fixed",
        /// foveation by the contrast of the picture and by sound; needs audio.source, and is like "fixed" in silence
        AudioVisual = "audio-visual",
        /// the published audio-visual model without a limit on the effect of sound: for comparison
        Paper = "paper",
    }
}

choice! {
    /// Shading rates in silence.
    SilenceRule {
        /// the rings of mode = "fixed"
        Fixed = "fixed",
        /// no visible loss of contrast
        Strict = "strict",
    }
}

choice! {
    /// Backend for shading rates.
    RatesBackend {
        /// a rate attachment if the device supports it, else a mask
        Auto = "auto",
        /// a rate attachment (VK_KHR_fragment_shading_rate) or nothing
        Attachment = "attachment",
        /// a mask: skips blocks of pixels and fills them from their neighbours
        Mask = "mask",
        /// no backend: full rate everywhere
        Off = "off",
    }
}

choice! {
    /// Reaction of rates and re-use to a slowdown.
    RatesGate {
        /// drop the technique that slows frames down, by measured GPU or CPU time; retry from time to time
        Auto = "auto",
        /// keep both, at any cost
        On = "on",
        /// drop both, with everything else in place: for comparison
        Off = "off",
    }
}

choice! {
    /// Pixels for each shader invocation.
    PeripheralRate {
        /// two pixels per shader invocation
        R2x1 = "2x1",
        /// four pixels per shader invocation
        R2x2 = "2x2",
        /// eight pixels per shader invocation
        R4x2 = "4x2",
        /// sixteen pixels per shader invocation
        R4x4 = "4x4",
    }
}

choice! {
    /// Temporal re-use of the periphery.
    ReuseMode {
        /// no re-use
        Off = "off",
        /// re-use, with reprojection as the head turns
        On = "on",
        /// the published method without reprojection, a whole region at a time: for comparison
        Paper = "paper",
    }
}

choice! {
    /// Order of re-use over frames.
    ReusePhase {
        /// patches of 15 degrees take turns, for even frame times
        Staggered = "staggered",
        /// a whole region in one frame
        Aligned = "aligned",
        /// a whole region in one frame, the right eye half a period later; motion may then look like depth
        AlternateEye = "alternate-eye",
    }
}

choice! {
    /// Chroma attenuation.
    ChromaMode {
        /// no chroma attenuation
        Off = "off",
        /// the published curves, with a plateau of full colour, visible large fields and slow fades
        Default = "default",
        /// the published curves unchanged: for comparison
        Paper = "paper",
    }
}

choice! {
    /// Standard for luma and chroma.
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
    /// Source of the sound.
    AudioSource {
        /// none
        Off = "off",
        /// the system's output (PulseAudio, PipeWire with pipewire-pulse, ALSA's loop-back card); never a microphone
        System = "system",
        /// the WAV file in audio.file, in a loop
        File = "file",
    }
}

choice! {
    /// Summary of the last seconds of sound.
    AudioMode {
        /// the more cautious of the last 400 ms and the whole of audio.window_s
        Default = "default",
        /// the published summary: all of audio.window_s, with the gates of BS.1770: for comparison
        Paper = "paper",
    }
}

choice! {
    /// Overlay on the pictures in the headset; see the guide.
    DebugView {
        /// no overlay
        None = "none",
        /// shading rate of each tile: from green for half of the pixels to violet for a sixteenth
        Rates = "rates",
        /// angle from the gaze: a line every 10 degrees
        Eccentricity = "eccentricity",
        /// age of each tile in frames: clear for new tiles, then yellow to red
        Age = "age",
        /// a dot at the gaze, visible to every viewer of the picture
        Gaze = "gaze",
    }
}

presets! {
    /// Set of values for all options that the file does not set.
    Preset {
        /// every technique off
        None = "none" { rates.mode = RatesMode::Off; }
        /// a quarter of the shading in the periphery; few users notice it
        Quality = "quality" { rates.peripheral = PeripheralRate::R2x2; }
        /// a sixteenth of the shading from 27 degrees on
        Balanced = "balanced" {}
        /// a sixteenth of the shading from 18 degrees on; users notice it at times
        Performance = "performance" {
            rates.transitional_deg = 18.39;
            reuse.periods = Periods::of([1, 1, 2, 3, 3]);
        }
        /// balanced with chroma attenuation, for pictures sent to the headset as video
        Streaming = "streaming" { chroma.mode = ChromaMode::Default; }
        /// no eye tracker: a quarter of the shading beyond 40 degrees from the centre, where eyes turn only with the head
        Fixed = "fixed" {
            gaze.source = GazeSource::Centre;
            rates.foveal_deg = 30.0;
            rates.transitional_deg = 40.0;
            rates.peripheral = PeripheralRate::R2x2;
        }
        /// the three published methods together, without safeguards and at any cost: for comparison; needs audio.source
        Paper = "paper" {
            audio.mode = AudioMode::Paper;
            rates.mode = RatesMode::Paper;
            rates.gate = RatesGate::On;
            reuse.mode = ReuseMode::Paper;
            chroma.mode = ChromaMode::Paper;
        }
    }
}

options! {
    /// The user's settings. `Default` holds without any file.
    Config {
        /// Master switch; false leaves the application unchanged.
        enabled: bool = true;
        /// Set of values for all options that the file does not set.
        preset: Preset = Preset::Balanced;
    }

    /// The log file.
    log: Log {
        /// Amount of detail in the log file.
        level: LogLevel = LogLevel::Info;
    }

    /// The gaze of the user.
    gaze: Gaze {
        /// Source of the gaze.
        source: GazeSource = GazeSource::Eyes;
        /// Time for which the last gaze stays in use after the tracker loses the eyes, as in a blink.
        hold_ms: u32 = 500, 0..=500 "milliseconds";
        /// Delay before the layer attaches the eye tracker in an application without OpenXR input; input that the application sets up later does not work; 0: never attach.
        attach_alone_after_s: u32 = 30, 0..=600 "seconds";
        /// Recording for source = "file": lines of seconds, degrees left and degrees up, separated by commas; seconds alone for lost eyes.
        file: FilePath = FilePath::NONE;
        /// New file for a recording of the gaze, in the format of gaze.file; without it, no file holds the gaze.
        record: FilePath = FilePath::NONE;
    }

    /// The sound, which stays in memory, in the application's process.
    audio: Audio {
        /// Source of the sound.
        source: AudioSource = AudioSource::Off;
        /// WAV file for audio.source = "file".
        file: FilePath = FilePath::NONE;
        /// Summary of the last seconds of sound.
        mode: AudioMode = AudioMode::Default;
        /// Length of sound that the summary covers.
        window_s: f32 = 3.0, 0.4..=120.0 "seconds";
        /// Interval between updates of loudness and pitch, in steps of 0.1.
        interval_s: f32 = 0.1, 0.1..=1.0 "seconds";
        /// Lower bound of loudness; quieter sound counts as this loud.
        least_lufs: f32 = -35.0, -70.0..=0.0 "LUFS";
        /// Upper bound of loudness; louder sound counts as this loud.
        greatest_lufs: f32 = -10.0, -70.0..=0.0 "LUFS";
    }

    /// Shading rates, coarser away from the gaze.
    rates: Rates {
        /// Model for shading rates.
        mode: RatesMode = RatesMode::Fixed;
        /// Backend for shading rates.
        backend: RatesBackend = RatesBackend::Auto;
        /// Reaction of rates and re-use, each by itself, to a slowdown of the application.
        gate: RatesGate = RatesGate::Auto;
        /// Rules that name the render passes of the scene; empty: automatic recognition.
        passes: PassRules = PassRules::default();
        /// Radius of full shading rate around the gaze; the layer adds the tracker's error and the motion of the eyes.
        foveal_deg: f32 = 14.34, 5.0..=110.0 "degrees";
        /// Angle from the gaze at which the peripheral rate begins; rates in between fall step by step.
        transitional_deg: f32 = 27.08, 5.0..=110.0 "degrees";
        /// Coarsest shading rate, in pixels; a device without it uses the next finer one.
        peripheral: PeripheralRate = PeripheralRate::R4x4;
        /// Greatest contrast loss for mode = "audio-visual", in just noticeable differences; above 1, some users notice it.
        greatest_loss: f32 = 1.0, 0.0..=1.75 "";
        /// Shading rates in silence for mode = "audio-visual".
        silence: SilenceRule = SilenceRule::Fixed;
        /// Luminance of white in the headset, for modes that measure contrast.
        white_cd_m2: f32 = 100.0, 10.0..=10_000.0 "cd/m^2";
    }

    /// Temporal re-use: a periphery that is rendered less often, and reprojected in between.
    reuse: Reuse {
        /// Temporal re-use of the periphery.
        mode: ReuseMode = ReuseMode::Off;
        /// Frames from one rendering to the next for each of five regions around the gaze, innermost first; they end at 6.3, 9.1, 18.1 and 31.1 degrees.
        periods: Periods = Periods::of([1, 1, 2, 2, 3]);
        /// Order of re-use over frames, for mode = "on".
        phase: ReusePhase = ReusePhase::Staggered;
        /// Permission to render a region less than 30 times per second, where flicker is worst; always given in mode = "paper".
        below_30_hz: bool = false;
        /// Rendering of visible changes in the periphery in every frame, within the saved time; never in mode = "paper".
        refresh: bool = true;
    }

    /// Chroma attenuation: less colour away from the gaze.
    chroma: Chroma {
        /// Chroma attenuation.
        mode: ChromaMode = ChromaMode::Off;
        /// Fall-off of blue-yellow (Cb), the Z of its curve; higher values remove more colour; for mode = "paper".
        cb_bound: f32 = 0.70, 0.70..=0.85 "";
        /// Fall-off of red-green (Cr), the Z of its curve; higher values remove less colour; for mode = "paper".
        cr_bound: f32 = 0.55, 0.35..=0.55 "";
        /// Radius of full colour around the gaze; at least the tracker's error.
        plateau_deg: f32 = 6.3, 1.1..=30.0 "degrees";
        /// Angle from the gaze at which the curves end; in default mode at least 15 degrees beyond the plateau.
        max_eccentricity_deg: f32 = 55.0, 20.0..=110.0 "degrees";
        /// Least width of the colour edge, as a share of the way from plateau_deg to max_eccentricity_deg; higher values are softer.
        rim_fade: f32 = 0.5, 0.25..=1.0 "";
        /// Fastest loss of colour after the gaze has left, as a share of full colour; colour returns at once.
        max_change_per_s: f32 = 0.5, 0.1..=100.0 "per second";
        /// Standard for luma and chroma.
        matrix: ChromaMatrix = ChromaMatrix::Bt709;
    }

    /// Debug views in the headset.
    debug: Debugging {
        /// Overlay on the pictures in the headset; `parafovea status --view` changes it in a running application.
        view: DebugView = DebugView::None;
    }
}
