//! The demo's applications.

use crate::artifacts::system_program;
use crate::measure::{Effort, LAYER_RUN_UP, Subject};
use parafovea_scene::scene::SceneName;
use parafovea_scene::script::tracker::Tracker;
use parafovea_zoo::{STYLES, Style};

/// Style of the zoo: two render passes a frame that draw into the swapchain, which is how most simple engines render.
const STYLE: &str = "render-pass";

/// Frames of the counted runs that are judged. The eyes jump after two thirds of them.
const JUDGED: u64 = 9;

/// Frames until a pass is recognised and rates have become as coarse as they get.
const SETTLING: u64 = LAYER_RUN_UP;

/// An application with a user, and the effort that is spent on it.
pub struct Exhibit {
    /// The application, and the script of head and eyes.
    pub subject: Subject,
    /// The timed turns.
    pub timed: Effort,
    /// Frames before the timed ones, with the decision made: frames of a millisecond become faster for hundreds of frames.
    pub warming: u64,
    /// The counted runs.
    pub counted: Effort,
    /// Time that a pixel takes, in units of our scene's.
    pub weight: f64,
}

impl Exhibit {
    /// Its name in tables and files.
    pub fn name(&self) -> &'static str {
        self.subject.name()
    }
}

/// Our scene, one style of the zoo, and hello_xr where it is installed.
pub fn exhibits() -> Vec<Exhibit> {
    let counted = Effort { turns: 1, run_up: SETTLING, frames: JUDGED, size: 512 };
    let timed = Effort { turns: 1, run_up: SETTLING, frames: 30, size: 512 };
    let scene =
        Subject::before_a_saccade(SceneName::Courtyard, Tracker::GOOD, counted.run_up + JUDGED * 2 / 3);
    let exhibit = |subject: &Subject, timed, weight| Exhibit {
        subject: subject.clone(),
        timed,
        warming: 0,
        counted,
        weight,
    };
    let mut exhibits = vec![exhibit(&scene, timed, 1.0)];
    let style: Option<&'static Style> = STYLES.iter().copied().find(|style| style.name == STYLE);
    exhibits.extend(style.map(|style| exhibit(&scene.clone().with_style(style), timed, 1.0)));
    match system_program("hello_xr") {
        // A frame takes a millisecond: more of them, for the same certainty.
        Ok(_) => {
            // Each start of a process places its threads differently, which changes such short frames by a tenth.
            let longer = Effort { turns: 3, frames: 150, ..timed };
            exhibits.push(Exhibit { warming: 400, ..exhibit(&scene.with_hello_xr(), longer, 0.03) });
        }
        Err(missing) => eprintln!("hello_xr is omitted: {missing}"),
    }
    exhibits
}
