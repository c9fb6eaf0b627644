//! Amounts of work, for the progress that is shown.

use super::Exhibit;
use super::single::work_of;
use crate::measure::{Effort, RUN_UP_ALONE};

/// Starting an application, in pixels that could be rendered meanwhile.
const START: f64 = 8e6;

/// Judging a pixel, in pixels that could be rendered meanwhile.
const JUDGING: f64 = 5.0;

/// All work of [`super::run`], and, with `each_technique`, of [`super::savings`] for the first exhibit.
pub fn work(exhibits: &[Exhibit], each_technique: bool) -> u64 {
    let of_one = |exhibit: &Exhibit| {
        let alone = Effort { run_up: RUN_UP_ALONE, ..exhibit.timed };
        let turn = rendering(exhibit, alone) + rendering(exhibit, exhibit.timed);
        exhibit.timed.turns as u64 * turn + 3 * rendering(exhibit, exhibit.counted) + judging(exhibit)
    };
    let savings = exhibits.first().filter(|_| each_technique).map_or(0, work_of);
    exhibits.iter().map(of_one).sum::<u64>() + savings
}

/// One run.
pub fn rendering(exhibit: &Exhibit, effort: Effort) -> u64 {
    let pixels = effort.length() as f64 * f64::from(effort.size).powi(2);
    (START + exhibit.weight * pixels) as u64
}

/// Judging the pictures of one counted run.
pub fn judging(exhibit: &Exhibit) -> u64 {
    (JUDGING * exhibit.counted.frames as f64 * f64::from(exhibit.counted.size).powi(2)) as u64
}
