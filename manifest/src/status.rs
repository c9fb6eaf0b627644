//! Status of a running application: a small file for each process, rewritten every second, which `parafovea status` reads.
//!
//! The file is the user's alone (mode 0600, in a folder of mode 0700: [`Environment::status_folder`]). It has no direction of the gaze and
//! no level of the sound: of both only their source, and whether and since when they are available; the stored correction of the eye
//! tracker, and the drift of the mean gaze.
//!
//! [`Environment::status_folder`]: crate::paths::Environment::status_folder

mod correction;
mod effect;
mod folder;
mod gaze;
mod request;
mod view;
mod watch;

pub use correction::{AskedMeasurement, CorrectionStatus, GazeMeasurement, ask_measurement};
pub use effect::effect;
pub use folder::{Found, Gone, StatusFile, Statuses, UnreadableStatus, read_all};
pub use gaze::ASSUMED_DELAY_MS;
pub use view::{AskedView, ask_view};
pub use watch::{GazeWatch, watch_gaze};

use serde::{Deserialize, Serialize};

/// A status that was not written for longer than this, seconds, is of an application that ended, or hangs.
pub const FRESH_S: u64 = 5;

/// Interval at which the layer writes the status, seconds.
pub const EVERY_S: u64 = 1;

/// Status of an application's session.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Status {
    /// The version of the layer.
    pub version: String,
    /// The process; in a container it may have another number outside.
    pub pid: u32,
    /// The program, by which configuration and log are named.
    pub executable: String,
    /// The application's name for OpenXR.
    pub application: String,
    /// Reason why nothing is done in this session; empty where it is active.
    pub inert: String,
    /// The source of the configuration.
    pub settings: Settings,
    /// Frames that ended in it.
    pub frames: u64,
    /// Frames a second, Hz; 0: not known.
    pub frame_rate_hz: f32,
    /// Technique of coarser shading: "rate attachment", "mask" or "none".
    pub backend: String,
    /// Passes that had coarser rates, or parts left out, in the last frame.
    pub passes_matched: u32,
    /// Decisions with reasons, as in the log: how the device makes shading coarser, the kind of each pass, and the passes with a mask.
    pub decisions: Vec<Decision>,
    /// The gaze.
    pub gaze: Gaze,
    /// The correction of the eye tracker.
    pub gaze_correction: CorrectionStatus,
    /// The sound.
    pub sound: Sound,
    /// Shading rates.
    pub rates: Rates,
    /// The gate of rates.
    pub rates_gate: Gate,
    /// The gate of re-use.
    pub reuse_gate: Gate,
    /// Device memory of the session.
    pub memory: Memory,
    /// Whether colour is removed at this moment.
    pub attenuates_colour: bool,
    /// The debug view over the pictures.
    pub debug_view: View,
}

/// Device memory of the layer's images and buffers for a session.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Memory {
    /// All of it, MiB.
    pub all_mib: f32,
    /// That of the pictures that re-use keeps, MiB.
    pub reuse_mib: f32,
    /// Reason why re-use keeps no pictures of a swapchain, for lack of memory; empty otherwise.
    pub refused: String,
}

/// A decision on a device or a kind of passes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Decision {
    /// Its subject.
    pub topic: Topic,
    /// Reason why it went against the subject, in words of its own; empty for topics without that.
    pub reason: String,
    /// One line with all of it, as the log has it.
    pub line: String,
}

/// The subject of a decision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Topic {
    /// Special treatment of a driver or a device.
    Quirk,
    /// A device has no rate attachments, or no masks.
    NoBackend,
    /// A pass that was recognised as the scene.
    Scene,
    /// A pass that was recognised as something else.
    OtherPass,
    /// A pass of the scene got a mask.
    Mask,
    /// A pass of the scene got none, for the decision's reason.
    NoMask,
    /// Nothing of the layer's work is visible.
    Unseen,
    /// Draws in passes of the scene that stay at 1x1, for the decision's reason.
    FullRate,
    /// Images of earlier frames that passes read, so that nothing is re-used.
    Feedback,
    /// A topic of a later version.
    #[default]
    #[serde(other)]
    Other,
}

impl Status {
    /// The decisions on a topic, in the order of the log.
    pub fn decided(&self, topic: Topic) -> impl DoubleEndedIterator<Item = &Decision> {
        self.decisions.iter().filter(move |decision| decision.topic == topic)
    }
}

/// The source of an application's configuration.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Path of the configuration file; empty: no file, and the defaults hold.
    pub file: String,
    /// Whether the last version of that file was refused, and the one before it, or the defaults, hold.
    pub has_error: bool,
}

/// Source and quality of the gaze: numbers about the signal, from which no direction follows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Gaze {
    /// `gaze.source`.
    pub source: String,
    /// Source of the last frame's gaze: "eyes", "osc", "file" or "centre".
    pub holder: String,
    /// Whether there was one in the last frame.
    pub is_valid: bool,
    /// Age of the last gaze when that frame was displayed, milliseconds; `None`: there was none, or it is the centre of the view.
    pub age_ms: Option<f32>,
    /// Samples a second, Hz; `None`: not known.
    pub rate_hz: Option<f32>,
    /// Share of the last frames with a gaze, 0..=1; `None`: not known.
    pub valid: Option<f32>,
    /// Noise in fixations, degrees: root mean square of the angles from sample to sample; `None`: not known.
    pub noise_deg: Option<f32>,
    /// Blinks since the session began.
    pub blinks: u32,
    /// Saccades since the session began.
    pub saccades: u32,
    /// Whether the application gets it too (`gaze.offer`).
    pub is_given: bool,
    /// Time from the eye to the display of a frame that is planned when its OSC packet arrives, milliseconds, by the runtime's eye tracker;
    /// `None`: not known.
    pub packet_delay_ms: Option<f32>,
    /// Angle between the mean gaze of the last two minutes and that of the session's first five, degrees; `None`: not known, or no larger than
    /// by chance.
    pub drift_deg: Option<f32>,
    /// OSC packets.
    pub osc: Osc,
}

/// The OSC packets that a session received.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Osc {
    /// Address and port; empty: the session receives none, and was not to.
    pub address: String,
    /// Reason why it receives none; empty: it does.
    pub failure: String,
    /// The format of the sender, such as "VRChat"; empty without one.
    pub format: String,
    /// All of them.
    pub packets: u64,
    /// Of these: no OSC, or too large.
    pub malformed: u64,
    /// Messages about the eyes that are not a gaze.
    pub implausible: u64,
    /// Packets about the eyes, from another sender than the one in use.
    pub other_senders: u64,
    /// Packets that came late, by their own time.
    pub late: u64,
    /// Intervals with more packets than the layer reads.
    pub floods: u64,
}

/// Source of the sound.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Sound {
    /// `audio.source`.
    pub source: String,
    /// Whether something is known of the last seconds.
    pub is_heard: bool,
}

/// Rates in the maps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Rates {
    /// Share of the tiles of both eyes at each rate that passes obeyed, such as `("4x4", 0.3)`, the coarsest first: the device's rates; of
    /// a mask "1x1", and "skipped" for its unshaded blocks of 4x4 pixels; all "1x1" if no pass was changed. Empty without maps.
    pub tiles: Vec<(String, f32)>,
    /// Share of the pixels that passes shaded: 0..=1; 1 where no pass was changed.
    pub shaded: f32,
    /// Whether the GPU decides each tile by the image's contrast: then `tiles` and `shaded` are those for unknown contrast, and only the
    /// GPU has the real ones.
    pub decided_on_gpu: bool,
    /// Share of the tiles that is rendered in a frame, 0..=1; 1: nothing is re-used.
    pub rendered: f32,
}

/// A debug view.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct View {
    /// As `debug.view` has it, such as "none".
    pub name: String,
    /// Whether `parafovea status --view` asks for it, instead of the configuration.
    pub is_asked: bool,
    /// Whether it was drawn over the last pictures.
    pub is_drawn: bool,
}

/// State of a technique's gate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Gate {
    /// Mode of the decision: "auto", "on" or "off".
    pub mode: String,
    /// Whether the technique stays; false where it was dropped.
    pub is_kept: bool,
    /// Whether a trial is under way or due: the technique is switched off and on, and frames are measured.
    pub is_on_trial: bool,
    /// Cost of frames with it, in costs without it, and the bounds of a confidence interval; `None`: not known yet.
    pub ratio: Option<[f32; 3]>,
}
