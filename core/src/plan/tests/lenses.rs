//! Without a gaze: rings around the axes of both lenses.

use super::*;
use glam::Vec2;

/// Displays that are canted outwards, degrees; half fields of view to the temporal and to the nasal side, upwards and downwards.
struct Headset {
    cant_deg: f32,
    fov_deg: [f32; 4],
}

/// A Valve Index, a Pimax and a headset with parallel displays, roughly; the last one sees farther downwards than upwards.
const HEADSETS: [Headset; 3] = [
    Headset { cant_deg: 5.0, fov_deg: [50.0, 46.0, 54.0, 54.0] },
    Headset { cant_deg: 10.0, fov_deg: [62.0, 40.0, 51.0, 51.0] },
    Headset { cant_deg: 0.0, fov_deg: [54.0, 40.0, 44.0, 55.0] },
];

impl Headset {
    fn input(&self) -> PlanInput<'static> {
        let [temporal, nasal, up, down] = self.fov_deg.map(f32::to_radians);
        let eye = |sign: f32, left: f32, right: f32| EyeInput {
            offset: [0; 2],
            extent: [1440, 1600],
            fov: Fov { left: -left, right, up, down: -down },
            orientation: Quat::from_rotation_y((sign * self.cant_deg).to_radians()),
            contrast: None,
            refresh: false,
        };
        let eyes = [eye(1.0, temporal, nasal), eye(-1.0, nasal, temporal)];
        PlanInput { eyes, gaze: GazeState::LOST, ..input() }
    }

    fn plan(&self) -> FramePlan {
        settled(&mut Planner::new(fixed()), self.input()).clone()
    }
}

/// Tiles of a plan with the direction of their middle in the view.
fn tiles(eye: &EyePlan) -> impl Iterator<Item = (Vec3, ShadingRate)> {
    let [width, height] = [eye.rates.width(), eye.rates.height()];
    (0..width)
        .flat_map(move |x| (0..height).map(move |y| (x, y)))
        .map(|(x, y)| (middle_of(eye, x, y).normalize(), eye.rate(x, y)))
}

/// The rate of a direction in the common space, as a view shows it; `None` beyond its edge.
fn rate_of(headset: &PlanInput, plan: &FramePlan, index: usize, direction: Vec3) -> Option<ShadingRate> {
    let eye = &plan.eyes[index];
    let in_view = headset.eyes[index].orientation.inverse() * direction;
    let at = (in_view.truncate() / -in_view.z - eye.plane().origin) / eye.plane().step;
    let is_inside = in_view.z < 0.0 && at.cmpge(Vec2::ZERO).all() && at.x < 1440.0 && at.y < 1600.0;
    is_inside.then(|| {
        let [x, y] = eye.tile_of([at.x as u32, at.y as u32]);
        eye.rate(x, y)
    })
}

#[test]
fn each_eye_has_its_own_lens_as_a_centre() {
    for headset in &HEADSETS {
        let plan = headset.plan();
        for (index, eye) in plan.eyes.iter().enumerate() {
            let off = eccentricity(eye.centres[index], Vec3::NEG_Z).to_degrees();
            assert!(off < 1e-3, "the axis of lens {index} is {off} degrees off");
            assert_eq!(eye.gaze, Vec3::ZERO, "no gaze is known");
        }
        // Left and right mirror each other.
        let shares = plan.eyes.each_ref().map(|eye| eye.statistics().pixel_share);
        assert!((shares[0] - shares[1]).abs() < 0.02, "{shares:?}");
    }
}

#[test]
fn rates_fall_off_from_the_nearer_lens_and_never_rise() {
    let lost = SafetySettings::default().lost.unwrap();
    for headset in &HEADSETS {
        for eye in &headset.plan().eyes {
            let mut by_angle: Vec<(f32, f32)> = tiles(eye)
                .map(|(direction, rate)| {
                    let angles = eye.centres.map(|centre| eccentricity(centre, direction).to_degrees());
                    (angles[0].min(angles[1]), rate.octaves())
                })
                .collect();
            by_angle.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut finest_beyond = f32::INFINITY;
            // From outside inwards; a tile is less than 1.2 degrees from its middle to its edge.
            let mut outer = by_angle.iter().rev().peekable();
            for (angle, octaves) in by_angle.iter().rev() {
                while let Some((_, beyond)) = outer.next_if(|(at, _)| *at > angle + 2.4) {
                    finest_beyond = finest_beyond.min(*beyond);
                }
                assert!(*octaves <= finest_beyond, "{octaves} at {angle}, {finest_beyond} farther out");
                assert!(*octaves == 0.0 || *angle > lost.foveal_deg, "{octaves} at {angle}");
            }
            assert_eq!(by_angle.last().unwrap().1, ShadingRate::R2X2.octaves(), "the farthest corner");
        }
    }
}

/// Directions that both eyes see have one rate. Tiles lie elsewhere in either view, so that the one may have a finer rate for the sake of
/// a neighbour: directions near the border of a ring are left out.
#[test]
fn where_the_views_overlap_both_eyes_have_one_rate() {
    for headset in &HEADSETS {
        let (input, plan) = (headset.input(), headset.plan());
        assert_eq!(plan.eyes[0].rings, plan.eyes[1].rings);
        let centres = [0, 1].map(|index: usize| input.eyes[index].orientation * Vec3::NEG_Z);
        let borders = plan.eyes[0].rings.from_deg();
        let mut compared = 0;
        for (yaw, pitch) in (-60..=60).flat_map(|yaw| (-50..=50).map(move |pitch| (yaw, pitch))) {
            let [yaw, pitch] = [yaw as f32, pitch as f32].map(f32::to_radians);
            let direction = Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch) * Vec3::NEG_Z;
            let [left, right] = centres.map(|centre| eccentricity(centre, direction).to_degrees());
            let angle = left.min(right);
            if borders.iter().any(|border| (angle - border).abs() < 2.0) {
                continue;
            }
            let rates = [0, 1].map(|index| rate_of(&input, &plan, index, direction));
            if let [Some(left), Some(right)] = rates {
                assert_eq!(left, right, "{direction} at {angle}");
                compared += 1;
            }
        }
        assert!(compared > 2000, "{compared}");
    }
}

/// On a canted display, the additional area over rings around the head's forward direction is small; with parallel displays nothing
/// changes.
#[test]
fn canted_displays_shade_little_more_than_with_one_centre() {
    let shares = HEADSETS.each_ref().map(|headset| {
        let safety = SafetySettings { hysteresis_deg: 0.0, ..SafetySettings::default() };
        let mut planner = Planner::new(PlanSettings { safety, ..fixed() });
        let around_lenses = settled(&mut planner, headset.input()).clone();
        let mut ahead = headset.input();
        ahead.gaze = gaze(Vec3::NEG_Z, Vec3::NEG_Z);
        let rates = RateSettings::Fixed(FixedFoveation::WITHOUT_TRACKER);
        let settings = without_safety_limits(PlanSettings { rates, ..fixed() });
        let around_ahead = settled(&mut Planner::new(settings), ahead).clone();
        [around_lenses, around_ahead].map(|plan| plan.eyes[0].statistics().pixel_share)
    });
    let [index, pimax, parallel] = shares;
    assert_eq!(parallel[0], parallel[1]);
    for (canted, most) in [(index, 0.06), (pimax, 0.11)] {
        assert!(canted[0] > canted[1] && canted[0] < canted[1] + most, "{canted:?}");
        assert!(canted[0] < 0.85, "{canted:?}");
    }
}
