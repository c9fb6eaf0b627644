//! A user's behaviour in a scene, as pure data: head movement, gaze, sound, and samples of an eye tracker. The application does not use it;
//! it is for measurements of the application.
//!
//! Times are seconds, 0 being that of frame 0, so frame n is at n / 90. The animation, the head and the gaze all
//! follow this one clock.

pub mod gaze;
pub mod head;
mod scenes;
pub mod sound;
pub mod tracker;

use self::gaze::TrueGaze;
use self::head::HeadPath;
use self::sound::Sound;
use crate::scene::SceneName;

/// Duration of every script, seconds.
pub const DURATION_S: f64 = 12.0;

/// Luminance of white (all three linear channels 1) on the display that the scenes are made for, cd/m2. Black is 0.
/// The scenes' levels are relative to it: a mean of 0.014 in the library is 1.4 cd/m2.
pub const WHITE_CD_M2: f32 = 100.0;

/// The script of a scene.
#[derive(Clone, Debug)]
pub struct Script {
    /// The scene.
    pub scene: SceneName,
    /// Motion of the head.
    pub head: HeadPath,
    /// Gaze of the eyes.
    pub gaze: TrueGaze,
    /// The sound.
    pub sound: Sound,
}

impl Script {
    /// The script of a scene; always the same.
    pub fn new(scene: SceneName) -> Self {
        Self::of(scene, 0, gaze::REACH_DEG)
    }

    /// Another gaze in the same scene, from 1 on, of eyes that look as far to the side as [`gaze::FAR_REACH_DEG`].
    pub fn glancing(scene: SceneName, number: u32) -> Self {
        Self::of(scene, number, gaze::FAR_REACH_DEG)
    }

    fn of(scene: SceneName, number: u32, reach_deg: f32) -> Self {
        let scenes::Content { waypoints, targets, sound, seed } = scenes::content(scene);
        let head = HeadPath::new(waypoints);
        let gaze = TrueGaze::new(&head, &targets, seed.wrapping_add(7919 * number), reach_deg);
        Self { scene, head, gaze, sound }
    }
}
