//! The plan of a report, before any measurement.

use crate::hardware::{HardwarePoint, Look, Rates, hardware_points};
use crate::points::{Extent, Point, Sweep, points};
use parafovea_models::errors::fvvdp::Fvvdp;
use parafovea_scene::scene::SceneName;
use parafovea_scene::script::tracker::Tracker;
use parafovea_tests::installation::Driver;
use parafovea_tests::measure::{Effort, LAYER_RUN_UP};

/// Pixels along a side at which a picture of 90 degrees has 20 a degree at its centre: half of 20 x 180 / pi, as its edge is at a tangent of 1.
pub const FINE_SIZE: u32 = 2292;

/// Ratio of the time to judge an image to the time to render it with lavapipe: a weight in the progress of the work.
const JUDGING: u64 = 5;

/// Cost of an application's start, in pixels that could be rendered meanwhile.
const START: u64 = 15_000_000;

/// One subject of measurements.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Scenes.
    pub scenes: Vec<SceneName>,
    /// Techniques on it, the application alone first.
    pub points: Vec<Point>,
    /// Maps over the pictures of the judged runs.
    pub hardware: Vec<HardwarePoint>,
    /// Their look.
    pub look: Look,
    /// Gaze scripts by which these are judged: the scene's, and others, whose eyes look farther to the side.
    pub scripts: u32,
    /// The timed runs of each.
    pub timed: Effort,
    /// The run of each whose pictures are judged and whose fragments are counted.
    pub judged: Effort,
    /// A run of the points of the quick report in one scene at the finest resolution, whose pictures are judged only.
    pub fine: Option<(SceneName, Effort)>,
    /// Source of the application's gaze.
    pub tracker: Tracker,
    /// Its device.
    pub driver: Driver,
    /// The judge in JOD, if there is to be one.
    pub fvvdp: Option<Fvvdp>,
}

impl Plan {
    /// A plan for five minutes: 2 scenes, 30 frames at 512 x 512.
    pub fn quick() -> Self {
        let timed = Effort { turns: 2, run_up: LAYER_RUN_UP, frames: 30, size: 512 };
        Self {
            scenes: vec![SceneName::Cockpit, SceneName::Foliage],
            points: points(Extent::Quick),
            hardware: hardware_points(Extent::Quick),
            look: Look::Rates,
            scripts: 1,
            timed,
            judged: Effort { turns: 1, ..timed },
            fine: None,
            tracker: Tracker::GOOD,
            driver: Driver::Lavapipe,
            fvvdp: None,
        }
    }

    /// A plan for an hour and a half: 6 scenes, 40 frames at 640 x 640, errors of 15 of these, and of a few at 20 pixels a degree.
    pub fn full() -> Self {
        let timed = Effort { turns: 2, run_up: LAYER_RUN_UP, frames: 40, size: 640 };
        // Rates need half a second to become coarse.
        let fine = Effort { turns: 1, run_up: 48, frames: 4, size: FINE_SIZE };
        Self {
            scenes: SceneName::ALL.into_iter().filter(|scene| *scene != SceneName::Courtyard).collect(),
            points: points(Extent::Full),
            hardware: hardware_points(Extent::Full),
            timed,
            judged: Effort { turns: 1, frames: 15, ..timed },
            scripts: 2,
            fine: Some((SceneName::Cockpit, fine)),
            ..Self::quick()
        }
    }

    /// As [`Self::full`], with every point of every sweep: at least four each.
    pub fn all() -> Self {
        Self { points: points(Extent::All), hardware: hardware_points(Extent::All), ..Self::full() }
    }

    /// The points that are timed, with their indices among all.
    pub fn timed_points(&self) -> impl Iterator<Item = (usize, &Point)> {
        self.points.iter().enumerate().filter(|(_, point)| point.is_timed)
    }

    /// The points that are judged at the finest resolution.
    pub fn fine_points(&self) -> Vec<&Point> {
        self.points.iter().filter(|point| point.is_in(Extent::Quick)).collect()
    }

    /// Number of techniques with maps of the layer.
    fn attached(&self) -> usize {
        self.hardware.iter().filter(|point| matches!(point.rates, Rates::Layer(_))).count()
    }

    fn scaled(&self) -> usize {
        self.points.iter().filter(|point| point.sweep == Sweep::RenderScale).count()
    }

    /// The work of judging the pictures of a point: a JOD takes twice as long as all else together.
    pub fn judging(&self) -> u64 {
        judging(self.judged) * if self.fvvdp.is_some() { 3 } else { 1 }
    }

    /// The work of judging maps by one more gaze script.
    pub fn work_of_script(&self) -> u64 {
        let shown = 1 + self.scaled() + self.attached();
        let judged = self.scaled() + self.hardware.len();
        shown as u64 * rendering(self.judged) + judged as u64 * self.judging()
    }

    fn further_scripts(&self) -> u32 {
        if self.hardware.is_empty() { 0 } else { self.scripts.saturating_sub(1) }
    }

    /// Runs of an application.
    pub fn runs(&self) -> usize {
        let glances = self.further_scripts() as usize * (1 + self.scaled() + self.attached());
        let judged = self.points.len() + self.attached() + glances;
        let timed = self.timed_points().count() * self.timed.turns;
        self.scenes.len() * (judged + timed) + if self.fine.is_some() { self.fine_points().len() } else { 0 }
    }

    /// All of it, in the unit of [`rendering`] and [`judging`].
    pub fn work(&self) -> u64 {
        let pictures = |points: usize, effort: Effort, judging: u64| {
            points as u64 * (rendering(effort) + judging) - judging
        };
        let timed = self.timed_points().map(|(_, point)| rendering(self.timed.of(&point.technique)));
        let timed = timed.sum::<u64>() * self.timed.turns as u64;
        let fine =
            self.fine.map_or(0, |(_, effort)| pictures(self.fine_points().len(), effort, judging(effort)));
        let hardware = self.attached() as u64 * rendering(self.judged)
            + self.hardware.len() as u64 * self.judging()
            + u64::from(self.further_scripts()) * self.work_of_script();
        self.scenes.len() as u64
            * (pictures(self.points.len(), self.judged, self.judging()) + hardware + timed)
            + fine
    }
}

/// Work of a run, in pixels.
pub fn rendering(effort: Effort) -> u64 {
    START + effort.length() * u64::from(effort.size).pow(2)
}

/// Work of judging its images, in the same unit.
pub fn judging(effort: Effort) -> u64 {
    JUDGING * effort.frames * u64::from(effort.size).pow(2)
}
