//! The scenario file: behaviour of the headset, its wearer and the runtime during a run.
//!
//! `README.md` of this crate explains every key; [`Scenario::default`] has the defaults.

mod check;
mod defaults;

use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::{Path, PathBuf};

/// A whole scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scenario {
    /// Output files.
    pub output: Output,
    /// Clock of the frames.
    pub clock: Clock,
    /// Course of the sessions.
    pub session: Session,
    /// Capabilities of the headset and the runtime.
    pub system: System,
    /// Behaviour of the eye tracker.
    pub tracker: Tracker,
    /// Deviations of the runtime from the specification.
    pub quirks: Quirks,
    /// Behaviour of swapchains.
    pub swapchain: Swapchain,
    /// Requirements of the runtime on Vulkan.
    pub vulkan: Vulkan,
    /// The two views: left, right.
    #[serde(rename = "view")]
    pub views: Vec<View>,
    /// Keyframes of the head in the LOCAL space, interpolated linearly.
    pub head: Vec<Head>,
    /// Keyframes of the gaze in the VIEW space, interpolated linearly.
    pub gaze: Vec<Gaze>,
    /// Keyframes of the fields of view; each lasts until the next.
    pub zoom: Vec<Zoom>,
    /// Keyframes of buttons, triggers and sticks; each lasts until the next of the same path.
    pub input: Vec<Input>,
    /// Faults.
    pub fault: Vec<Fault>,
}

/// `[output]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Output {
    /// Folder, relative to the scenario file. Nothing is written where there is no scenario file.
    pub dir: PathBuf,
    /// Whether `record.jsonl` is written.
    pub record: bool,
    /// Numbers of the frames whose pictures are saved; the first frame of the process is 0.
    pub save_frames: Vec<u64>,
    /// Kinds of images saved of these frames.
    pub save: Vec<Picture>,
    /// Whether eyes are composited in the other frames too.
    pub composite: bool,
    /// Whether the record has attached and synchronised action sets, and polled events.
    pub input: bool,
}

/// A kind of picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Picture {
    /// Frames whose eye views are saved: `eye<e>_<frame>.png`.
    Eye,
    /// Frames whose submitted images are saved: `submitted_<layer>_<view>_<frame>.png`.
    Submitted,
}

/// `[clock]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Clock {
    /// Kind of clock.
    pub mode: ClockMode,
    /// Frames a second, 1 to 1000.
    pub refresh_hz: f64,
    /// A Unix socket, relative to the scenario file, that gives each frame its turn; empty: none.
    pub turns: PathBuf,
}

/// A kind of clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClockMode {
    /// A frame lasts one refresh period, however long it takes: the same times in every run.
    Simulated,
    /// `CLOCK_MONOTONIC`; `xrWaitFrame` blocks as a headset would make it.
    Real,
}

/// `[session]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Session {
    /// Frames that a session lasts until it is stopped, then exits; 0: until the application asks for its end.
    pub frames: u64,
    /// The session's frame from which on it is visible.
    pub visible_from: u64,
    /// The session's frame from which on it is focused; not before it is visible.
    pub focused_from: u64,
    /// The session's frames for which `xrWaitFrame` returns `shouldRender` false.
    pub should_render_off: Vec<u64>,
}

/// `[system]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct System {
    /// Name of the system.
    pub name: String,
    /// Whether there is an eye tracker.
    pub eye_gaze: bool,
    /// Extensions that are not offered.
    pub extensions_off: Vec<String>,
    /// The newest OpenXR version that is accepted: `1.0` or `1.1`.
    pub max_api: String,
    /// Height of the LOCAL space's origin above the STAGE's floor, in metres.
    pub eye_height: f32,
    /// Largest swapchain width and height, in pixels.
    pub max_size: u32,
    /// Most samples of a swapchain image: 1, 2, 4 or 8.
    pub max_samples: u32,
    /// Hands that hold a controller.
    pub hands: Vec<Hand>,
}

/// `[tracker]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tracker {
    /// Whether `xrGetSystemProperties` reports an existing eye tracker.
    pub reported: bool,
    /// Whether the action of the gaze ever becomes active.
    pub active: bool,
    /// Whether `XrEyeGazeSampleTimeEXT` has a time; else 0.
    pub sample_time: bool,
    /// Age of the newest gaze at the requested time, milliseconds.
    pub latency_ms: f64,
    /// Reduction of that age once the views of the frame were located, milliseconds.
    pub newer_at_views_ms: f64,
    /// Whether the gaze points out of the back of the head.
    pub backwards: bool,
}

/// `[quirks]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Quirks {
    /// Extensions that are listed, and refused.
    pub refused_extensions: Vec<String>,
    /// Extensions that work, and are not listed.
    pub unlisted_extensions: Vec<String>,
    /// Functions that the runtime does not have.
    pub missing_functions: Vec<String>,
    /// Whether only the last of several action sets that are attached works.
    pub only_last_set: bool,
    /// Whether bound actions are active from their attachment, and a synchronisation without action sets, or without the focus, changes
    /// nothing, as in Monado.
    pub active_from_attachment: bool,
    /// Whether spaces of actions that are not attached are refused.
    pub no_early_spaces: bool,
    /// A file, relative to the scenario file, whose lock (`flock`) `xrLocateSpace` waits for; empty: none.
    pub locate_lock: PathBuf,
}

/// A hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Hand {
    /// `/user/hand/left`.
    Left,
    /// `/user/hand/right`.
    Right,
}

/// `[swapchain]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Swapchain {
    /// Images of a swapchain, 1 to 8; a static one has one.
    pub images: u32,
    /// Numbers of the calls of `xrWaitSwapchainImage` that time out, from 0 in each swapchain; the call after each succeeds.
    pub wait_timeouts: Vec<u64>,
    /// Whether `xrEnumerateSwapchainImages` writes images without reading the structures' `type` and `next`, as in Monado.
    pub unread_images: bool,
}

/// `[vulkan]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Vulkan {
    /// Part of the name of the device to be used; empty: the first.
    pub device: String,
    /// Instance extensions that the runtime asks for.
    pub instance_extensions: Vec<String>,
    /// Device extensions that the runtime asks for.
    pub device_extensions: Vec<String>,
}

/// A `[[fault]]`: calls of a function that fail, come late or have a strange answer. Where several hold for a call, the first does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fault {
    /// The function, such as `xrLocateViews`.
    pub call: String,
    /// Its result, such as `XR_ERROR_SESSION_LOST`, in place of any effect; empty: its usual result. `XR_SESSION_LOSS_PENDING` alone is
    /// returned by a call that did succeed.
    #[serde(default)]
    pub result: String,
    /// Its answer on success.
    #[serde(default)]
    pub answer: Answer,
    /// Delay before it returns, in milliseconds.
    #[serde(default)]
    pub late_ms: u64,
    /// First frame of the process with the fault.
    #[serde(default)]
    pub from_frame: u64,
    /// Number of calls from that frame on that pass before the fault.
    #[serde(default)]
    pub skip: u64,
    /// Number of calls with the fault; 0: all.
    #[serde(default)]
    pub count: u64,
}

/// Answer of a call.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// Its usual answer.
    #[default]
    Usual,
    /// Poses that are not numbers, of `xrLocateViews` and `xrLocateSpace`.
    Nan,
    /// Fields of view without extent, of `xrLocateViews`.
    ZeroFov,
    /// Fields of view of nearly 180 degrees, of `xrLocateViews`.
    HugeFov,
    /// Poses that are neither valid nor tracked, of `xrLocateViews` and `xrLocateSpace`.
    Untracked,
    /// A display time a second before the last one, of `xrWaitFrame`.
    Backwards,
    /// No images, of `xrEnumerateSwapchainImages`.
    NoImages,
    /// The event that the instance is about to be lost, of `xrPollEvent`.
    InstanceLossPending,
    /// The event that the session is about to be lost, of `xrPollEvent`.
    SessionLossPending,
}

/// A `[[view]]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct View {
    /// Recommended width, in pixels.
    pub width: u32,
    /// Recommended height, in pixels.
    pub height: u32,
    /// Angles of the edges.
    pub fov_deg: FovDegrees,
    /// In the VIEW space, in metres.
    pub position: [f32; 3],
    /// In the VIEW space: a unit quaternion x, y, z, w.
    pub orientation: [f32; 4],
}

/// Field of view of a [`View`] in degrees, each -89 to 89; left and down are usually negative.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the four edges")]
pub struct FovDegrees {
    pub left: f32,
    pub right: f32,
    pub up: f32,
    pub down: f32,
}

/// A `[[head]]` keyframe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Head {
    /// Seconds since the display time of the first frame.
    pub t: f64,
    /// In the LOCAL space, in metres.
    pub position: [f32; 3],
    /// About +y: to the left, in degrees.
    pub yaw_deg: f32,
    /// About +x: upwards, in degrees.
    pub pitch_deg: f32,
    /// About +z: counter-clockwise, in degrees.
    pub roll_deg: f32,
}

/// A `[[gaze]]` keyframe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Gaze {
    /// Seconds since the display time of the first frame.
    pub t: f64,
    /// To the left, in degrees.
    pub yaw_deg: f32,
    /// Upwards, in degrees.
    pub pitch_deg: f32,
    /// Whether the tracker sees the eyes, from here to the next keyframe.
    pub tracked: bool,
}

/// A `[[zoom]]` keyframe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Zoom {
    /// Seconds since the display time of the first frame.
    pub t: f64,
    /// Factor of every view's `fov_deg`, 0.1 to 1.
    pub scale: f32,
}

/// An `[[input]]` keyframe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Seconds since the display time of the first frame.
    #[serde(default)]
    pub t: f64,
    /// The whole path, such as `/user/hand/right/input/select/click`.
    pub path: String,
    /// The new state.
    pub value: InputValue,
}

/// State of an input.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum InputValue {
    /// Of a button.
    Boolean(bool),
    /// Of a trigger.
    Float(f32),
    /// Of a stick.
    Vector([f32; 2]),
}

impl InputValue {
    pub(crate) fn pair(self) -> [f32; 2] {
        match self {
            Self::Boolean(value) => [f32::from(u8::from(value)), 0.0],
            Self::Float(value) => [value, 0.0],
            Self::Vector(value) => value,
        }
    }
}

/// Reason why a scenario cannot be used.
#[derive(Debug)]
pub struct ScenarioError {
    file: PathBuf,
    reason: String,
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file.display(), self.reason.trim_end())
    }
}

impl std::error::Error for ScenarioError {}

impl Scenario {
    /// Reads a scenario file. [`Output::dir`] becomes absolute, or relative to the working directory.
    ///
    /// # Errors
    /// The file cannot be read, is no TOML, has an unknown key, or a value outside its key's range; the message
    /// names the file, the key and the range.
    pub fn load(file: &Path) -> Result<Self, ScenarioError> {
        let failed = |reason: String| ScenarioError { file: file.to_owned(), reason };
        let text = std::fs::read_to_string(file).map_err(|error| failed(error.to_string()))?;
        let mut scenario = Self::parse(&text).map_err(failed)?;
        let folder = file.parent().unwrap_or(Path::new(""));
        scenario.output.dir = folder.join(&scenario.output.dir);
        for file in [&mut scenario.quirks.locate_lock, &mut scenario.clock.turns] {
            if !file.as_os_str().is_empty() {
                *file = folder.join(&file);
            }
        }
        Ok(scenario)
    }

    /// Reads the text of a scenario file.
    ///
    /// # Errors
    /// As for [`Self::load`], without the file's name.
    pub fn parse(text: &str) -> Result<Self, String> {
        let scenario: Self = toml::from_str(text).map_err(|error| error.to_string())?;
        check::check(&scenario)?;
        Ok(scenario)
    }
}
