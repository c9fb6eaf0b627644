//! What the mock runtime is to do: its scenario file, typed.
//!
//! Only what the harness sets is here; the mock runtime documents the whole format and its defaults.

use serde::Serialize;

/// A scenario. [`Scenario::new`] has the harness's defaults; fields are changed as needed.
#[derive(Clone, Debug, Serialize)]
pub struct Scenario {
    /// What is written, and where.
    pub output: Output,
    /// How time passes.
    pub clock: Clock,
    /// How long it runs.
    pub session: Session,
    /// What the headset can do.
    pub system: System,
    /// How swapchains behave.
    pub swapchain: Swapchain,
    /// The views; two.
    #[serde(rename = "view")]
    pub views: Vec<View>,
    /// Head poses over time, interpolated linearly.
    #[serde(rename = "head")]
    pub head: Vec<Head>,
    /// Gaze directions over time, relative to the head, interpolated linearly.
    #[serde(rename = "gaze")]
    pub gaze: Vec<Gaze>,
    /// States of buttons over time.
    pub input: Vec<Input>,
}

/// `[output]`.
#[derive(Clone, Debug, Serialize)]
pub struct Output {
    /// Folder, relative to the scenario file.
    pub dir: String,
    /// Whether a record is written.
    pub record: bool,
    /// Numbers of the frames whose pictures are saved, from 0.
    pub save_frames: Vec<u64>,
    /// Which pictures: `eye` (the composite), `submitted` (the sub-images as the application submitted them).
    pub save: Vec<&'static str>,
    /// Whether eyes are composited at all; runs that are timed do without.
    pub composite: bool,
}

/// `[clock]`.
#[derive(Clone, Debug, Serialize)]
pub struct Clock {
    /// `simulated` (as fast as it goes, the same times in every run) or `real`.
    pub mode: &'static str,
    /// Frames a second.
    pub refresh_hz: f64,
}

/// `[session]`.
#[derive(Clone, Debug, Serialize)]
pub struct Session {
    /// Frames until the session is asked to end.
    pub frames: u64,
    /// Frames that the application is told not to render.
    pub should_render_off: Vec<u64>,
}

/// `[system]`.
#[derive(Clone, Debug, Serialize)]
pub struct System {
    /// Whether there is an eye tracker.
    pub eye_gaze: bool,
    /// Extensions that the runtime does not offer.
    pub extensions_off: Vec<String>,
}

/// `[swapchain]`.
#[derive(Clone, Debug, Serialize)]
pub struct Swapchain {
    /// Calls of `xrWaitSwapchainImage` that time out, counted from 0 in each swapchain.
    pub wait_timeouts: Vec<u64>,
}

/// A `[[view]]`.
#[derive(Clone, Debug, Serialize)]
pub struct View {
    /// Recommended width, in pixels.
    pub width: u32,
    /// Recommended height, in pixels.
    pub height: u32,
    /// Angles of the edges, in degrees; left and down are negative.
    pub fov_deg: FovDegrees,
    /// In the head's space, in metres.
    pub position: [f32; 3],
    /// In the head's space, as a quaternion x, y, z, w.
    pub orientation: [f32; 4],
}

/// Field of view of a [`View`], in degrees.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(missing_docs, reason = "the four edges")]
pub struct FovDegrees {
    pub left: f32,
    pub right: f32,
    pub up: f32,
    pub down: f32,
}

/// A `[[head]]` keyframe.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Head {
    /// Seconds since the start.
    pub t: f64,
    /// In the LOCAL space, in metres.
    pub position: [f32; 3],
    /// To the left, in degrees.
    pub yaw_deg: f32,
    /// Upwards, in degrees.
    pub pitch_deg: f32,
    /// Counter-clockwise, in degrees.
    pub roll_deg: f32,
}

/// A `[[gaze]]` keyframe.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Gaze {
    /// Seconds since the start.
    pub t: f64,
    /// To the left, in degrees.
    pub yaw_deg: f32,
    /// Upwards, in degrees.
    pub pitch_deg: f32,
    /// Whether the tracker sees the eyes.
    pub tracked: bool,
}

/// An `[[input]]` keyframe.
#[derive(Clone, Debug, Serialize)]
pub struct Input {
    /// Seconds since the start.
    pub t: f64,
    /// The button, such as `/user/hand/left/input/select/click`.
    pub path: String,
    /// Whether it is down from then on.
    pub value: bool,
}

impl Scenario {
    /// So many frames of two upright eyes of 90 by 90 degrees and 1024 by 1024 pixels, a still head that looks
    /// ahead and a gaze that rests straight ahead; simulated time, a record, no pictures.
    pub fn new(frames: u64) -> Self {
        let fov_deg = FovDegrees { left: -45.0, right: 45.0, up: 45.0, down: -45.0 };
        let eye = |x| View {
            width: 1024,
            height: 1024,
            fov_deg,
            position: [x, 0.0, 0.0],
            orientation: [0.0, 0.0, 0.0, 1.0],
        };
        Self {
            output: Output {
                dir: "out".to_owned(),
                record: true,
                save_frames: Vec::new(),
                save: Vec::new(),
                composite: false,
            },
            clock: Clock { mode: "simulated", refresh_hz: 90.0 },
            session: Session { frames, should_render_off: Vec::new() },
            system: System { eye_gaze: true, extensions_off: Vec::new() },
            swapchain: Swapchain { wait_timeouts: Vec::new() },
            views: vec![eye(-0.032), eye(0.032)],
            head: vec![Head { t: 0.0, position: [0.0; 3], yaw_deg: 0.0, pitch_deg: 0.0, roll_deg: 0.0 }],
            gaze: vec![Gaze { t: 0.0, yaw_deg: 0.0, pitch_deg: 0.0, tracked: true }],
            input: Vec::new(),
        }
    }

    /// Saves the sub-images of these frames as the application submitted them.
    pub fn saving(mut self, frames: &[u64]) -> Self {
        self.output.save_frames = frames.to_vec();
        self.output.save = vec!["submitted"];
        self
    }

    /// Rests the gaze in one direction: degrees to the left and upwards.
    pub fn gazing(mut self, yaw_deg: f32, pitch_deg: f32) -> Self {
        self.gaze = vec![Gaze { t: 0.0, yaw_deg, pitch_deg, tracked: true }];
        self
    }

    /// Makes both views this large, in pixels.
    pub fn sized(mut self, width: u32, height: u32) -> Self {
        for view in &mut self.views {
            (view.width, view.height) = (width, height);
        }
        self
    }

    /// Lets time pass as it does outside.
    pub fn in_real_time(mut self) -> Self {
        self.clock.mode = "real";
        self
    }
}
