//! Number of frames and image size of each style's run.

use parafovea_tests::scenario::{Head, Scenario, ScenarioExt};
use std::path::Path;

/// Frames and size of a run.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Frames.
    pub frames: u64,
    /// Side of an eye buffer, pixels.
    pub size: u32,
}

impl Effort {
    /// All of it where `PARAFOVEA_ZOO` is "full", as `cargo dev zoo` sets it, or else this share.
    pub fn or_share(frames: u64, size: u32) -> Self {
        if is_full() { Self { frames: 120, size: 256 } } else { Self { frames, size } }
    }

    /// The scenario of a run whose gaze rests at the centre of the view.
    pub fn scenario(self) -> Scenario {
        Scenario::new(self.frames).sized(self.size, self.size)
    }

    /// The same, with a head that turns and moves.
    #[allow(dead_code, reason = "each test uses a part of it")]
    pub fn scenario_of_moving_head(self) -> Scenario {
        let head = |t: f64, turn: f32| Head {
            t,
            position: [0.05 * turn, 1.6, -0.02 * turn],
            yaw_deg: 40.0 * turn,
            pitch_deg: 6.0 * turn,
            roll_deg: -3.0 * turn,
        };
        Scenario { head: vec![head(0.0, 0.0), head(1.0, 1.0), head(1.2, 0.9)], ..self.scenario() }
    }
}

/// The lines of a configuration for a gaze that rests for a time, and then jumps from one place to another eight times a second and follows
/// something between, by a file in `folder`: the styles have no input, and the eye tracker is not asked before half a minute.
#[allow(dead_code, reason = "each test uses a part of it")]
pub fn moving_gaze(folder: &Path, rests_s: f64) -> std::io::Result<String> {
    const JUMP_S: f64 = 0.125;
    let directions: [(f32, f32); 5] = [(-18.0, 4.0), (12.0, -9.0), (3.0, 14.0), (20.0, 0.0), (-6.0, -12.0)];
    let (left, up) = directions[0];
    let mut text = if rests_s > 0.0 { format!("0,{left},{up}\n") } else { String::new() };
    for (jump, (left, up)) in (0..).zip(directions.iter().cycle()).take(20) {
        let t = rests_s + f64::from(jump) * JUMP_S;
        text += &format!("{t},{left},{up}\n{},{},{up}\n", t + 0.9 * JUMP_S, left + 2.0);
    }
    let file = folder.join("gaze.txt");
    std::fs::write(&file, text)?;
    Ok(format!("[gaze]\nsource = \"file\"\nfile = {file:?}\n"))
}

/// Whether all of it is run.
pub fn is_full() -> bool {
    std::env::var_os("PARAFOVEA_ZOO").is_some_and(|value| value == "full")
}
