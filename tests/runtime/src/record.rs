//! The record: the application's actions, one JSON object a line.
//!
//! `README.md` of this crate explains the lines.

use serde::{Deserialize, Serialize};

/// The message of the warning that the record has for each call that a fault of the scenario happens to.
pub const INJECTED: &str = "a fault of the scenario";

/// One line of `record.jsonl`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Line {
    /// `xrCreateInstance` succeeded.
    InstanceCreated(InstanceCreated),
    /// A session is in another state.
    SessionState {
        /// Handle of the session.
        session: u64,
        /// `IDLE`, `READY`, `SYNCHRONIZED`, `VISIBLE`, `FOCUSED`, `STOPPING` or `EXITING`.
        state: String,
    },
    /// `xrCreateSwapchain` succeeded.
    SwapchainCreated(SwapchainCreated),
    /// `xrAttachSessionActionSets` succeeded.
    ActionsAttached {
        /// Handle of the session.
        session: u64,
        /// Names of the action sets.
        sets: Vec<String>,
    },
    /// `xrSyncActions` succeeded.
    ActionsSynced {
        /// Handle of the session.
        session: u64,
        /// `XR_SUCCESS` or `XR_SESSION_NOT_FOCUSED`.
        result: String,
        /// Names of the action sets that are active.
        sets: Vec<String>,
        /// Values of the actions, without subaction paths.
        states: Vec<ActionState>,
    },
    /// `xrPollEvent` gave an event.
    EventPolled {
        /// Its subject.
        event: String,
    },
    /// `xrEndFrame` succeeded.
    Frame(Frame),
    /// A call broke a rule.
    Error(Error),
    /// A call is allowed, but hardly meant so.
    Warning {
        /// The function.
        call: String,
        /// The oddity.
        message: String,
    },
    /// `xrDestroyInstance` succeeded.
    End {
        /// Handle of the instance.
        instance: u64,
        /// Frames that the process has ended until now.
        frames: u64,
        /// Calls of the process that broke a rule until now.
        errors: u64,
    },
}

/// Value of an action.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActionState {
    /// Names of its set and of itself, with a slash between.
    pub action: String,
    /// Whether a source drives it.
    pub active: bool,
    /// Its value.
    pub value: [f32; 2],
    /// Whether it changed.
    pub changed: bool,
}

/// An application's description of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InstanceCreated {
    /// The new instance.
    pub instance: u64,
    /// Name of the application.
    pub application: String,
    /// Name of its engine.
    pub engine: String,
    /// OpenXR version it is written for, such as `1.0.20`.
    pub api_version: String,
    /// Extensions it enabled.
    pub extensions: Vec<String>,
}

/// Parameters of a swapchain. Flags are bits of OpenXR's, formats are named without `VK_FORMAT_`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "members of XrSwapchainCreateInfo")]
pub struct SwapchainCreated {
    pub session: u64,
    pub swapchain: u64,
    pub format: String,
    pub create_flags: u64,
    pub usage_flags: u64,
    pub width: u32,
    pub height: u32,
    pub sample_count: u32,
    pub face_count: u32,
    pub array_size: u32,
    pub mip_count: u32,
    /// From `XrVulkanSwapchainFormatListCreateInfoKHR`; empty where none was given.
    pub view_formats: Vec<String>,
    /// Number of images.
    pub images: u32,
}

/// A frame that was ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Frames that the process ended before.
    pub index: u64,
    /// Its session.
    pub session: u64,
    /// Display time, in nanoseconds of the runtime's clock.
    pub display_time_ns: i64,
    /// CPU time of the whole process at `xrEndFrame`, in nanoseconds.
    pub process_cpu_ns: i64,
    /// CPU time of the thread that called `xrEndFrame`, in nanoseconds.
    #[serde(default)]
    pub thread_cpu_ns: i64,
    /// The part of it that was spent while frames waited for their turn (`clock.turns`).
    #[serde(default)]
    pub held_cpu_ns: i64,
    /// Most memory that the process has had resident until then, KiB.
    #[serde(default)]
    pub peak_memory_kib: i64,
    /// Whether `xrWaitFrame` asked for it to be rendered.
    pub should_render: bool,
    /// The head in the LOCAL space at the display time, as scripted.
    pub head: Pose,
    /// The gaze in the VIEW space at the display time, as scripted: a unit vector; absent in gaps.
    pub gaze: Option<[f32; 3]>,
    /// Number of times since the previous frame that the gaze was located and available.
    #[serde(default)]
    pub gaze_reads: u32,
    /// The submitted layers.
    pub layers: Vec<Layer>,
}

/// A composition layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Layer {
    /// `XrCompositionLayerProjection`.
    Projection {
        /// Bits of `XrCompositionLayerFlags`.
        flags: u64,
        /// Its space.
        space: u64,
        /// Left, right.
        views: Vec<ProjectionView>,
    },
    /// `XrCompositionLayerQuad`.
    Quad {
        /// Bits of `XrCompositionLayerFlags`.
        flags: u64,
        /// Its space.
        space: u64,
        /// `both`, `left` or `right`.
        eyes: String,
        /// In its space.
        pose: Pose,
        /// Width and height in metres.
        size: [f32; 2],
        /// Its image.
        #[serde(flatten)]
        image: SubImage,
    },
}

/// A view of a projection layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProjectionView {
    /// In the layer's space.
    pub pose: Pose,
    /// In radians.
    pub fov: Fov,
    /// Its image.
    #[serde(flatten)]
    pub image: SubImage,
    /// `XrCompositionLayerDepthInfoKHR`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth: Option<Depth>,
}

/// Depth of a view.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "members of XrCompositionLayerDepthInfoKHR")]
pub struct Depth {
    #[serde(flatten)]
    pub image: SubImage,
    pub min_depth: f32,
    pub max_depth: f32,
    /// In metres, possibly infinite, which JSON has as `null`.
    pub near_z: Option<f32>,
    /// In metres, possibly infinite, which JSON has as `null`.
    pub far_z: Option<f32>,
}

/// Part of a swapchain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SubImage {
    /// Handle of the swapchain.
    pub swapchain: u64,
    /// Index of the image that is shown: the one released last.
    pub image: u32,
    /// The swapchain's format without `VK_FORMAT_`.
    pub format: String,
    /// x, y, width, height in pixels.
    pub rect: [i32; 4],
    /// Layer of the array.
    pub array_layer: u32,
}

/// A pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// In metres.
    pub position: [f32; 3],
    /// x, y, z, w.
    pub orientation: [f32; 4],
}

/// A field of view in radians.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the four edges")]
pub struct Fov {
    pub left: f32,
    pub right: f32,
    pub up: f32,
    pub down: f32,
}

/// A broken rule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Error {
    /// The function.
    pub call: String,
    /// Its result.
    pub result: String,
    /// The violation.
    pub message: String,
    /// Title of the specification's section, or the extension, that has the rule.
    pub section: String,
}
