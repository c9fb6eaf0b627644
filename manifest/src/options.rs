//! The options, each defined once: the table below makes the typed [`Config`], its defaults, allowed values, error texts and the commented
//! default file.

mod angles;
mod choice;
mod default_file;
mod file_path;
mod listen_address;
mod pass_rules;
mod periods;
mod preset;
mod reference;
mod setting;
mod table;

pub use angles::Angles;
pub use default_file::default_file;
pub use file_path::FilePath;
pub use listen_address::ListenAddress;
pub use pass_rules::{
    COLOR_FORMATS, ColorFormat, MOST_RULES, PassKind, PassRule, PassRules, PassRulesError, WayUp,
};
pub use periods::Periods;
pub use reference::reference;
pub use setting::{Allowed, Setting};
pub use table::{OptionSpec, keys_named};

use choice::choice;
use preset::presets;
use table::options;

choice! {
    /// Amount of detail in the log.
    LogLevel {
        /// failures, and the features that they turn off
        Error = "error",
        /// also features that work only in part
        Warn = "warn",
        /// also results of detection, and decisions
        Info = "info",
        /// also every step, for bug reports
        Debug = "debug",
    }
}

choice! {
    /// Source of the gaze.
    GazeSource {
        /// the eye tracker of the OpenXR runtime; else OSC packets, while they arrive; else wide fixed foveation and no chroma attenuation
        Auto = "auto",
        /// the eye tracker of the OpenXR runtime; without one, wide fixed foveation and no chroma attenuation
        Eyes = "eyes",
        /// OSC packets at gaze.osc_listen, as eye trackers send them to VRChat; without any, wide fixed foveation and no chroma attenuation
        Osc = "osc",
        /// always the axis of each lens: fixed foveation with the rings of rates.foveal_deg; without an eye tracker, prefer preset = "fixed", whose rings are wide
        Centre = "centre",
        /// the recording in gaze.file: for tests and demonstrations
        File = "file",
    }
}

choice! {
    /// Model for shading rates.
    RatesMode {
        /// the mode "audio-visual" on a GPU; the mode "fixed" with gaze.source = "centre", and on a CPU device, where the measurement of contrast costs more than it saves
        Auto = "auto",
        /// full rate everywhere
        Off = "off",
        /// foveation in rings, by the angle from the gaze alone
        Fixed = "fixed",
        /// foveation by image contrast, and by sound if audio.source is set; in silence, rates.silence applies
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
        /// by image contrast alone, with a limit that is 1.8 below rates.greatest_loss
        Contrast = "contrast",
    }
}

choice! {
    /// Backend for shading rates.
    RatesBackend {
        /// a rate attachment if the device supports it, otherwise a mask
        Auto = "auto",
        /// a rate attachment (VK_KHR_fragment_shading_rate) or nothing
        Attachment = "attachment",
        /// a mask: skips blocks of pixels and fills them from their neighbours
        Mask = "mask",
        /// no backend: full rate everywhere, and no re-use
        Off = "off",
    }
}

choice! {
    /// Reaction of rates and re-use to a slowdown.
    RatesGate {
        /// drop a technique without a clear saving of GPU time (CPU time on CPU devices), and try it again from time to time
        Auto = "auto",
        /// keep both techniques, even with a slowdown
        On = "on",
        /// drop both techniques, but keep everything else active: for comparison
        Off = "off",
    }
}

choice! {
    /// Pixels for each shader invocation.
    PeripheralRate {
        /// "4x4" on devices with shading rates; "4x2" with a mask, which loses more contrast at the same rate
        Auto = "auto",
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
        /// no temporal re-use
        Off = "off",
        /// temporal re-use, with reprojection for head rotation, and for head movement if the application submits depth
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
        /// a whole region in one frame, the right eye half a period after the left; motion may then look like depth
        AlternateEye = "alternate-eye",
    }
}

choice! {
    /// Chroma attenuation.
    ChromaMode {
        /// no chroma attenuation
        Off = "off",
        /// the published curves, modified: a plateau of full colour, slow fades, and large colour fields that stay visible
        Default = "default",
        /// the published curves, unmodified: for comparison
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
        /// the system's output (PulseAudio, PipeWire with pipewire-pulse, or an ALSA loopback card); never a microphone
        System = "system",
        /// the WAV file in audio.file, looped
        File = "file",
    }
}

choice! {
    /// Summary of the last seconds of sound.
    AudioMode {
        /// the more cautious of two summaries: of the last 400 ms, and of all of audio.window_s
        Default = "default",
        /// the published summary of all of audio.window_s, with the gating of BS.1770: for comparison
        Paper = "paper",
    }
}

choice! {
    /// Overlay on the images in the headset; see the guide.
    DebugView {
        /// no overlay
        None = "none",
        /// shading rate of each tile: from green for one half to violet for one sixteenth
        Rates = "rates",
        /// angle from the gaze, with a line every 10 degrees
        Eccentricity = "eccentricity",
        /// age of each tile in frames: clear for new tiles, then yellow to red
        Age = "age",
        /// a dot at the gaze, visible to every viewer of the image
        Gaze = "gaze",
        /// a dot in front of the head, as in parafovea gaze recentre and calibrate
        Ahead = "ahead",
    }
}

// The radii are pairs of paper A's pilot study, the only ones with scores behind them; its baseline is L1-C1 (balanced). From there
// Table 1 lists for how many combinations of loudness and frequency another pair scored no worse: L1-C2 16, L2-C1 11, L1-C3 8 (scores
// up to 4.14), L2-C2 6 (up to 3.24), L3-C1 5, and none for the other three. Of these L1-C3 (performance) shades least, and it keeps the
// widest fovea, which tolerates the largest tracker error. Quality has balanced's schedule: with reprojection, updates lose less than
// rates do for the same time.
presets! {
    /// Preset that provides the values of all options that the file does not set.
    Preset {
        /// every technique off
        None = "none" { rates.mode = RatesMode::Off; }
        /// few visible changes: the periphery keeps at least a quarter of its shading, and on a GPU tiles lose at most half of the contrast that balanced allows
        Quality = "quality" {
            rates.peripheral = PeripheralRate::R2x2;
            rates.greatest_loss = 4.0;
        }
        /// on a GPU, coarse rates in areas that lose little contrast; on a CPU device, an eighth of the shading beyond 27 degrees from the gaze
        Balanced = "balanced" {}
        /// more visible changes: on a GPU, up to 1.65 times the contrast loss that balanced allows; on a CPU device, a sixteenth of the shading beyond 18 degrees from the gaze
        Performance = "performance" {
            rates.transitional_deg = 18.39;
            rates.peripheral = PeripheralRate::R4x4;
            rates.greatest_loss = 12.0;
            reuse.periods = Periods::of([1, 1, 2, 3, 3]);
        }
        /// balanced with chroma attenuation, for frames that are streamed to the headset as video; chroma attenuation is a slowdown, in exchange for fewer bits for colour
        Streaming = "streaming" { chroma.mode = ChromaMode::Default; }
        /// wide fixed foveation, for headsets without an eye tracker: full rate up to 30 degrees from the axis of each lens, a quarter of the shading beyond 40 degrees; people turn the head to look further than that
        Fixed = "fixed" {
            gaze.source = GazeSource::Centre;
            rates.mode = RatesMode::Fixed;
            rates.foveal_deg = 30.0;
            rates.transitional_deg = 40.0;
            rates.peripheral = PeripheralRate::R2x2;
        }
        /// the three published methods together, without safeguards and at any cost: for comparison; needs audio.source
        Paper = "paper" {
            audio.mode = AudioMode::Paper;
            rates.mode = RatesMode::Paper;
            rates.peripheral = PeripheralRate::R4x4;
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
        /// Preset that provides the values of all options that the file does not set.
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
        source: GazeSource = GazeSource::Auto;
        /// Time that the last gaze stays in use after the tracker has lost the eyes, for instance in a blink.
        hold_ms: u32 = 500, 0..=500 "milliseconds";
        /// Time that the layer waits for the application to set up its OpenXR input, such as controllers, before it attaches the eye tracker alone; with 0, it never does. If the application sets up its input later than this, its controllers do not work until a restart: set a longer time.
        attach_alone_after_s: u32 = 30, 0..=600 "seconds";
        /// Correction of the eye tracker, in degrees to the left and upwards; added to the gaze before the correction from parafovea gaze calibrate or recentre.
        offset_deg: Angles = Angles::NONE;
        /// Address and port that receive OSC packets, for source = "osc" or "auto"; unless it is a loopback address such as 127.0.0.1, other computers can send, too.
        osc_listen: ListenAddress = ListenAddress::loopback(9020);
        /// Angle for the value 1 in the OSC formats without a unit, those of VRCFaceTracking and Baballonia.
        osc_scale_deg: f32 = 45.0, 10.0..=60.0 "degrees";
        /// Recording for source = "file": each line has seconds, degrees left and degrees up, separated by commas, or seconds alone while the eyes are lost.
        file: FilePath = FilePath::NONE;
        /// Permission for the application to read the gaze through XR_EXT_eye_gaze_interaction, and so to store or send it. Needs source = "osc", "auto" or "file", and a runtime without an eye tracker. After a change, restart the application; parafovea doctor checks that applications find the extension.
        offer: bool = false;
        /// New file for a recording of the gaze, in the format of gaze.file; without this option, no file contains the gaze.
        record: FilePath = FilePath::NONE;
    }

    /// The sound, which stays in memory, in the application's process.
    audio: Audio {
        /// Source of the sound.
        source: AudioSource = AudioSource::Off;
        /// WAV file for audio.source = "file".
        file: FilePath = FilePath::NONE;
        /// Method of summarising the last seconds of sound.
        mode: AudioMode = AudioMode::Default;
        /// Length of the sound that the summary covers.
        window_s: f32 = 3.0, 0.4..=120.0 "seconds";
        /// Interval between updates of loudness and pitch, a multiple of 0.1.
        interval_s: f32 = 0.1, 0.1..=1.0 "seconds";
        /// Lower bound of loudness; quieter sound counts as this loud.
        least_lufs: f32 = -35.0, -70.0..=0.0 "LUFS";
        /// Upper bound of loudness; louder sound counts as this loud.
        greatest_lufs: f32 = -10.0, -70.0..=0.0 "LUFS";
    }

    /// Shading rates, coarser away from the gaze.
    rates: Rates {
        /// Model for shading rates.
        mode: RatesMode = RatesMode::Auto;
        /// Backend for shading rates.
        backend: RatesBackend = RatesBackend::Auto;
        /// Protection from slowdowns: reaction to shading rates or re-use that show no clear saving of time. The two are judged separately; chroma attenuation is not judged.
        gate: RatesGate = RatesGate::Auto;
        /// Rules that name the scene's render passes; empty for automatic recognition.
        passes: PassRules = PassRules::default();
        /// Radius of full shading rate around the gaze, if rates form rings: with mode = "fixed", with gaze.source = "centre", on a CPU device, in silence with silence = "fixed", and while contrast cannot be measured. Without a gaze, the radius is at least 30 degrees. The layer adds a margin for the tracker's error and for eye movement.
        foveal_deg: f32 = 14.34, 5.0..=110.0 "degrees";
        /// Angle from the gaze at which the coarsest rate begins, for the same rings as foveal_deg. Between the two, rates become coarser step by step.
        transitional_deg: f32 = 27.08, 5.0..=110.0 "degrees";
        /// Coarsest shading rate, in pixels; a device without this rate uses the next finer one.
        peripheral: PeripheralRate = PeripheralRate::Auto;
        /// Greatest contrast loss of a tile with the loudest sound, in just-noticeable differences, for mode = "auto" on a GPU and for "audio-visual"; a lower value looks better and saves less. With quieter sound, the limit is up to 1.8 lower; in silence and with audio.source = "off", it is 1.8 lower: 6.2 by default. Most tiles lose less than the limit.
        greatest_loss: f32 = 8.0, 0.0..=16.0 "";
        /// Shading rates in silence, and always with audio.source = "off", for mode = "auto" on a GPU and for mode = "audio-visual".
        silence: SilenceRule = SilenceRule::Contrast;
        /// Luminance of white in the headset, for modes that measure contrast.
        white_cd_m2: f32 = 100.0, 10.0..=2_500.0 "cd/m^2";
        /// Coarse shading rates for draws that stay at 1x1 only because their fragment shaders write to buffers or images, or use atomics, as materials with virtual textures do in Unreal Engine. Each coarse fragment then writes once for all of its pixels; a pass that reads these writes may find gaps. No effect on masks. After a change, restart the application.
        coarse_stores: bool = false;
    }

    /// Temporal re-use: a periphery that is rendered less often, and reprojected in between.
    reuse: Reuse {
        /// Temporal re-use of the periphery.
        mode: ReuseMode = ReuseMode::Off;
        /// Update periods, in frames, of five regions around the gaze, innermost first; the first four regions end at 6.3, 9.1, 18.1 and 31.1 degrees.
        periods: Periods = Periods::of([1, 1, 2, 2, 3]);
        /// Order in which regions are updated, for mode = "on".
        phase: ReusePhase = ReusePhase::Staggered;
        /// Permission to update regions less than 30 times per second, although flicker is most visible at such rates; always given with mode = "paper".
        below_30_hz: bool = false;
        /// Render tiles with visible changes in every frame, as long as this costs less time than re-use saves; always off with mode = "paper".
        refresh: bool = true;
    }

    /// Chroma attenuation: less colour away from the gaze.
    chroma: Chroma {
        /// Chroma attenuation: a slowdown that rates.gate does not drop. With ALVR's passthrough by colour key, attenuated colours may no longer match the key.
        mode: ChromaMode = ChromaMode::Off;
        /// Parameter Z of the curve for blue-yellow (Cb), for mode = "paper"; a higher value removes more colour.
        cb_bound: f32 = 0.70, 0.70..=0.85 "";
        /// Parameter Z of the curve for red-green (Cr), for mode = "paper"; a higher value removes less colour.
        cr_bound: f32 = 0.55, 0.35..=0.55 "";
        /// Radius of full colour around the gaze; never less than the tracker's error.
        plateau_deg: f32 = 6.3, 1.1..=30.0 "degrees";
        /// Angle from the gaze at which the curves end; with mode = "default", at least plateau_deg plus 15.
        max_eccentricity_deg: f32 = 55.0, 20.0..=110.0 "degrees";
        /// Minimum width of the transition from full to attenuated colour, as a fraction of the distance from plateau_deg to max_eccentricity_deg; higher values are softer.
        rim_fade: f32 = 0.5, 0.25..=1.0 "";
        /// Fastest loss of colour after the gaze has moved away, as a fraction of full colour; colour returns at once.
        max_change_per_s: f32 = 0.5, 0.1..=100.0 "per second";
        /// Standard that defines luma and chroma.
        matrix: ChromaMatrix = ChromaMatrix::Bt709;
    }

    /// Debug views in the headset.
    debug: Debugging {
        /// Overlay on the images in the headset; `parafovea status --view` changes it in a running application.
        view: DebugView = DebugView::None;
    }
}
