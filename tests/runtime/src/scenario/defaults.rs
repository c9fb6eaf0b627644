//! Defaults of a scenario.

use super::{
    Clock, ClockMode, FovDegrees, Gaze, Hand, Head, Output, Picture, Quirks, Scenario, Session, Swapchain,
    System, Tracker, View, Vulkan,
};
use std::path::PathBuf;

impl Default for Scenario {
    fn default() -> Self {
        let eye = |x| View { position: [x, 0.0, 0.0], ..View::default() };
        Self {
            output: Output::default(),
            clock: Clock::default(),
            session: Session::default(),
            system: System::default(),
            tracker: Tracker::default(),
            quirks: Quirks::default(),
            swapchain: Swapchain::default(),
            vulkan: Vulkan::default(),
            views: vec![eye(-0.032), eye(0.032)],
            head: vec![Head::default()],
            gaze: vec![Gaze::default()],
            zoom: Vec::new(),
            input: Vec::new(),
            fault: Vec::new(),
        }
    }
}

impl Default for Output {
    fn default() -> Self {
        Self {
            dir: "out".into(),
            record: true,
            save_frames: Vec::new(),
            save: vec![Picture::Eye],
            composite: true,
            input: false,
        }
    }
}

impl Default for Clock {
    fn default() -> Self {
        Self { mode: ClockMode::Simulated, refresh_hz: 90.0, turns: PathBuf::new() }
    }
}

impl Default for Session {
    fn default() -> Self {
        Self { frames: 200, visible_from: 0, focused_from: 0, should_render_off: Vec::new() }
    }
}

impl Default for System {
    fn default() -> Self {
        Self {
            name: "Parafovea mock headset".to_owned(),
            eye_gaze: true,
            extensions_off: Vec::new(),
            max_api: "1.1".to_owned(),
            eye_height: 1.6,
            max_size: 8192,
            max_samples: 4,
            hands: vec![Hand::Left, Hand::Right],
        }
    }
}

impl Default for Tracker {
    fn default() -> Self {
        Self {
            reported: true,
            active: true,
            sample_time: true,
            latency_ms: 0.0,
            newer_at_views_ms: 0.0,
            backwards: false,
        }
    }
}

impl Default for Swapchain {
    fn default() -> Self {
        Self { images: 3, wait_timeouts: Vec::new(), unread_images: false }
    }
}

impl Default for Vulkan {
    fn default() -> Self {
        let only = |name: &str| vec![name.to_owned()];
        Self {
            device: String::new(),
            instance_extensions: only("VK_KHR_get_physical_device_properties2"),
            device_extensions: only("VK_KHR_image_format_list"),
        }
    }
}

impl Default for View {
    fn default() -> Self {
        Self {
            width: 1024,
            height: 1024,
            fov_deg: FovDegrees { left: -45.0, right: 45.0, up: 45.0, down: -45.0 },
            position: [0.0; 3],
            orientation: [0.0, 0.0, 0.0, 1.0],
        }
    }
}

impl Default for Gaze {
    fn default() -> Self {
        Self { t: 0.0, yaw_deg: 0.0, pitch_deg: 0.0, tracked: true }
    }
}
