//! Hard cases of `schedule`.

use super::Case;
use crate::reference::schedule as reference;
use glam::{Quat, Vec3};
use parafovea_core::geometry::{Fov, View};
use parafovea_core::schedule::cap::{PeriodCap, period_cap};
use parafovea_core::schedule::{
    CellAges, Phase, Regions, Schedule, TileCells, UpdateConfiguration, pixel_rate,
};

const MODEL: &str = "schedule";

pub(super) fn cases() -> Vec<Case> {
    [caps(), gazes(), frames(), images()].concat()
}

fn case(case: impl Into<String>, expected: impl ToString, got: impl ToString) -> Case {
    let (expected, got) = (expected.to_string(), got.to_string());
    let passed = expected == got;
    Case { model: MODEL, case: case.into(), expected, got, error: None, passed }
}

fn caps() -> Vec<Case> {
    let mut cases: Vec<Case> = [
        (0.0, 1),
        (f32::NAN, 1),
        (f32::INFINITY, 1),
        (29.0, 1),
        (30.0, 1),
        (90.0, 3),
        (89.9, 2),
        (1000.0, 9),
    ]
    .map(|(rate, cap)| case(format!("cap at {rate} frames/s"), cap, period_cap(rate)))
    .into();
    let mut cap = PeriodCap::default();
    let caps = [89.9, 90.0, 89.9, 90.0, 89.2, 89.0].map(|rate| cap.update(rate));
    cases.push(case("cap, 89.9 90 89.9 90 89.2 89 in turn", "[2, 3, 3, 3, 3, 2]", format!("{caps:?}")));
    cases
}

/// Largest and smallest period of the cells in a forward view.
fn periods(gaze: Vec3) -> String {
    let mut ages = CellAges::new();
    ages.advance(&slowest(Phase::Aligned), 0, [gaze; 2]);
    let mut range = [u8::MAX, 0];
    let tiles = view(256);
    let [columns, rows] = tiles.tiles();
    for (column, row) in (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))) {
        tiles.touched(column, row).for_each(|cell| {
            range = [range[0].min(ages.period(cell)), range[1].max(ages.period(cell))];
        });
    }
    format!("periods {}..={}", range[0], range[1])
}

fn slowest(phase: Phase) -> Schedule {
    Schedule { configuration: UpdateConfiguration::F12345, phase, ..Schedule::default() }
}

/// A square forward view of 86 degrees.
fn view(side: u32) -> TileCells {
    let plane = Fov { left: -0.75, right: 0.75, up: 0.75, down: -0.75 }.tangents().plane([side; 2]);
    let mut tiles = TileCells::default();
    tiles.update(&View { orientation: Quat::IDENTITY, plane }, [side; 2], 16);
    tiles
}

fn gazes() -> Vec<Case> {
    let mut cases: Vec<Case> = [
        ("gaze ahead", Vec3::NEG_Z, "periods 1..=5"),
        ("gaze off screen, 70 degrees to the right", Vec3::new(0.94, 0.0, -0.342), "periods 4..=5"),
        ("gaze at 180 degrees", Vec3::Z, "periods 5..=5"),
        ("gaze at 1e-6 rad", Vec3::new(1e-6, 0.0, -1.0), "periods 1..=5"),
        ("gaze lost (NaN)", Vec3::NAN, "periods 1..=1"),
        ("gaze of zero length", Vec3::ZERO, "periods 1..=1"),
    ]
    .map(|(name, gaze, expected)| case(name, expected, periods(gaze)))
    .into();
    let due =
        |direction| (0..8).filter(|&frame| slowest(Phase::Staggered).is_due(frame, direction, 4, 0)).count();
    cases.push(case("period 4 in 8 frames", "due 2 times", format!("due {} times", due(Vec3::NEG_Z))));
    for (name, direction) in [("NaN", Vec3::NAN), ("zero", Vec3::ZERO)] {
        cases.push(case(
            format!("direction {name}, period 4 in 8 frames"),
            "due 8 times",
            format!("due {} times", due(direction)),
        ));
    }
    let schedule = slowest(Phase::Aligned);
    for (eccentricity_deg, period) in [(f32::NAN, 1), (f32::INFINITY, 5), (180.0, 5), (-1.0, 1)] {
        cases.push(case(
            format!("eccentricity {eccentricity_deg}"),
            format!("period {period}"),
            format!("period {}", schedule.period_at(eccentricity_deg)),
        ));
    }
    cases
}

fn frames() -> Vec<Case> {
    let thirty_days_at_120_hz = 30 * 86_400 * 120;
    [
        ("frames after 30 days at 120 Hz", thirty_days_at_120_hz),
        ("frame counter at its wrap", u64::MAX - 8),
        ("frame counter at 2^32", (1 << 32) - 8),
    ]
    .into_iter()
    .flat_map(|(name, start)| {
        [Phase::Aligned, Phase::Staggered, Phase::AlternateEye].map(|phase| {
            let frames = (0..20).map(|i| u64::wrapping_add(start, i));
            case(format!("{name}, {phase:?}"), "oldest tile 4 frames, 0 late", oldest(phase, frames))
        })
    })
    .chain([
        case(
            "equal frame numbers",
            "oldest tile 4 frames, 0 late",
            oldest(Phase::Staggered, (0..20).map(|i| i / 2)),
        ),
        case(
            "reversed frame numbers",
            "oldest tile 0 frames, 0 late",
            oldest(Phase::Staggered, (0..20).map(|i| 100 - i)),
        ),
    ])
    .collect()
}

/// Greatest age of a tile since it was rendered, and greatest delay beyond a tile's period, both in frames.
fn oldest(phase: Phase, frames: impl Iterator<Item = u64>) -> String {
    let tiles = view(512);
    let [columns, rows] = tiles.tiles();
    let mut due = vec![false; columns as usize * rows as usize];
    let (mut since, mut before) = (vec![0; due.len()], None);
    let (mut oldest, mut latest) = (0, 0);
    let mut ages = CellAges::new();
    for frame in frames {
        ages.advance(&slowest(phase), frame, [Vec3::NEG_Z; 2]);
        ages.finish(0);
        ages.due_tiles(&tiles, 0, &mut due);
        let passed = u32::from(before != Some(frame));
        before = Some(frame);
        for (index, (since, &due)) in since.iter_mut().zip(&due).enumerate() {
            *since = if due { 0 } else { *since + passed };
            let mut period = u32::MAX;
            let (column, row) = (index as u32 % columns, index as u32 / columns);
            tiles.touched(column, row).for_each(|cell| period = period.min(ages.period(cell).into()));
            oldest = oldest.max(*since);
            latest = latest.max((*since + 1).saturating_sub(period));
        }
    }
    format!("oldest tile {oldest} frames, {latest} late")
}

fn images() -> Vec<Case> {
    let count = |extent: [u32; 2]| {
        let plane = Fov { left: -0.75, right: 0.75, up: 0.75, down: -0.75 }.tangents().plane(extent);
        Regions::default().pixel_counts(&plane, extent, Vec3::NEG_Z)
    };
    let areas = [3.0, 1e30, 1e-30, 7.0, 0.1];
    let rate = pixel_rate(areas, UpdateConfiguration::F12345);
    let exact = reference::pixel_rate(areas.map(f64::from), UpdateConfiguration::F12345.factors());
    let error = (f64::from(rate) - exact).abs();
    vec![
        case("pixels of an image of 1 x 1", "[1, 0, 0, 0, 0]", format!("{:?}", count([1, 1]))),
        case("pixels of an image of 0 x 9", "[0, 0, 0, 0, 0]", format!("{:?}", count([0, 9]))),
        Case {
            error: Some(error),
            passed: error < 1e-7,
            ..case("P of areas from 1e-30 to 1e30", format!("{exact:.4}"), format!("{rate:.4}"))
        },
        case("P of no area at all", 1, pixel_rate([0.0; 5], UpdateConfiguration::F12345)),
        case("P of a NaN area", 1, pixel_rate([f32::NAN; 5], UpdateConfiguration::F12345)),
        case("P of an infinite area and another", 0.5, {
            pixel_rate([f32::INFINITY, 1.0, 0.0, 0.0, 0.0], UpdateConfiguration::F12345)
        }),
    ]
}
