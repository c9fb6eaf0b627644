//! What a report measures, known before it is measured.

use crate::hardware::{HardwarePoint, Rates, hardware_points};
use crate::points::{Extent, Point, points};
use parafovea_scene::scene::SceneName;
use parafovea_scene::script::tracker::Tracker;
use parafovea_tests::installation::Driver;
use parafovea_tests::measure::{Effort, LAYER_RUN_UP};

/// Pixels along a side at which a picture of 90 degrees has 20 a degree at its centre: half of 20 x 180 / pi, as its edge is at a tangent of 1.
pub const FINE_SIZE: u32 = 2292;

/// How much longer it takes to judge a picture than to render it with lavapipe: a weight for how far along the work is.
const JUDGING: u64 = 5;

/// What starting an application takes, in pixels that could be rendered meanwhile.
const START: u64 = 15_000_000;

/// What is measured.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Where.
    pub scenes: Vec<SceneName>,
    /// What is done there, the application alone first.
    pub points: Vec<Point>,
    /// Maps over the pictures of the judged runs, by the look of hardware rates.
    pub hardware: Vec<HardwarePoint>,
    /// The timed runs of each.
    pub timed: Effort,
    /// The run of each whose pictures are judged and whose fragments are counted.
    pub judged: Effort,
    /// A run of each in one scene at the finest resolution, whose pictures are judged only.
    pub fine: Option<(SceneName, Effort)>,
    /// Who tells the application where the eyes look.
    pub tracker: Tracker,
    /// What it runs on.
    pub driver: Driver,
}

impl Plan {
    /// What fits into five minutes: 2 scenes, 30 frames at 512 x 512.
    pub fn quick() -> Self {
        let timed = Effort { turns: 2, run_up: LAYER_RUN_UP, frames: 30, size: 512 };
        Self {
            scenes: vec![SceneName::Cockpit, SceneName::Foliage],
            points: points(Extent::Quick),
            hardware: hardware_points(Extent::Quick),
            timed,
            judged: Effort { turns: 1, ..timed },
            fine: None,
            tracker: Tracker::GOOD,
            driver: Driver::Lavapipe,
        }
    }

    /// A morning's work: 6 scenes, 90 frames at 1024 x 1024, errors of 30 of these, and of a few at 20 pixels a degree.
    pub fn full() -> Self {
        let timed = Effort { turns: 2, run_up: LAYER_RUN_UP, frames: 90, size: 1024 };
        // Rates need half a second to become coarse.
        let fine = Effort { turns: 1, run_up: 48, frames: 4, size: FINE_SIZE };
        Self {
            scenes: SceneName::ALL.into_iter().filter(|scene| *scene != SceneName::Courtyard).collect(),
            points: points(Extent::Full),
            hardware: hardware_points(Extent::Full),
            timed,
            judged: Effort { turns: 1, frames: 30, ..timed },
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

    /// Those whose maps are the layer's.
    fn attached(&self) -> usize {
        self.hardware.iter().filter(|point| matches!(point.rates, Rates::Layer(_))).count()
    }

    /// Runs of an application.
    pub fn runs(&self) -> usize {
        let judged = self.points.len() + self.attached();
        let timed = self.timed_points().count() * self.timed.turns;
        self.scenes.len() * (judged + timed) + if self.fine.is_some() { self.points.len() } else { 0 }
    }

    /// All of it, in the unit of [`rendering`] and [`judging`].
    pub fn work(&self) -> u64 {
        let pictures = |effort: Effort| {
            self.points.len() as u64 * (rendering(effort) + judging(effort)) - judging(effort)
        };
        let timed = self.timed_points().map(|(_, point)| rendering(self.timed.of(&point.technique)));
        let timed = timed.sum::<u64>() * self.timed.turns as u64;
        let fine = self.fine.map_or(0, |(_, effort)| pictures(effort));
        let hardware = self.attached() as u64 * rendering(self.judged)
            + self.hardware.len() as u64 * judging(self.judged);
        self.scenes.len() as u64 * (pictures(self.judged) + hardware + timed) + fine
    }
}

/// How much work a run is, in pixels.
pub fn rendering(effort: Effort) -> u64 {
    START + effort.length() * u64::from(effort.size).pow(2)
}

/// How much work it is to judge its pictures.
pub fn judging(effort: Effort) -> u64 {
    JUDGING * effort.frames * u64::from(effort.size).pow(2)
}
