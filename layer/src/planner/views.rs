//! The views of the eyes, as the application locates and shows them.
//!
//! Poses and fields of view that are computed in each frame tremble in their last bits, which must not change the plan; and an application
//! that changes its resolution from frame to frame must not lose the history of its tiles.

use glam::{Quat, Vec3};
use parafovea_core::gaze::NEAREST_ASSUMED_M;
use parafovea_core::geometry::Fov;
use parafovea_core::plan::EyeInput;

/// Smaller differences count as none, radians: 0.06 degrees, a pixel or so, an eighth of the hysteresis of the rings.
const TREMOR: f32 = 1e-3;

/// The same of positions, metres: 0.05 degrees at half a metre.
const TREMOR_M: f32 = 5e-4;

/// Longest movement of the head within a frame that is followed, metres: 4.5 m/s at 90 Hz. Beyond it little of the new view was visible
/// before.
const LONGEST_FOLLOWED_M: f32 = 0.05;

/// A view, as xrLocateViews gives it or a projection layer shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// From the view's space to that in which it was located.
    pub orientation: Quat,
    /// Position in that space, metres.
    pub position: Vec3,
    /// Angles of its edges.
    pub fov: Fov,
}

/// A view of a projection layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownView {
    /// The view.
    pub view: View,
    /// Size of its picture, pixels.
    pub extent: [u32; 2],
}

/// Orientation of the head that has these views: their mean, as the VIEW space is defined. `None` without views.
pub fn head_of(views: impl IntoIterator<Item = Quat>) -> Option<Quat> {
    let mut views = views.into_iter();
    let first = views.next()?;
    let near_first = |view: Quat| if first.dot(view) < 0.0 { -view } else { view };
    let sum = views.fold(first, |sum, view| sum + near_first(view));
    (sum.length() > 0.1).then(|| sum.normalize())
}

/// The left and the right view.
#[derive(Debug, Default)]
pub struct Views {
    eyes: [Eye; 2],
    nearest_m: Option<f32>,
    /// Position of the head in the space in which the application locates its views, metres.
    head: Option<Vec3>,
    /// Its position in the frame before.
    last_head: Option<Vec3>,
    /// Distance that it moved within the last frame, metres.
    moved_m: f32,
    /// Whether re-used tiles are followed by their depth.
    is_followed: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct Eye {
    located: Option<Fov>,
    shown: Option<ShownFov>,
    /// In the space of the head.
    orientation: Quat,
    /// In the space of the head, whose origin is in the middle of both, metres.
    position: Vec3,
    /// Field of view to plan with; of the row above as the top.
    fov: Option<Fov>,
    extent: [u32; 2],
}

/// The field of view that a projection layer showed.
#[derive(Clone, Copy, Debug)]
struct ShownFov {
    fov: Fov,
    /// The answer of xrLocateViews then.
    located: Option<Fov>,
}

impl Views {
    /// A frame begins.
    pub fn frame_begins(&mut self) {
        let moved = self.head.zip(self.last_head).map(|(head, last)| head.distance(last));
        self.moved_m = moved.unwrap_or_default();
        self.last_head = self.head;
    }

    /// Displacement of the nearest object in a picture that is a frame old, arc minutes, after the head's turn is accounted for. The head's
    /// speed is that from the frame before the last one to the last one.
    ///
    /// 0 while re-used tiles are followed by their depth, unless the head moves too far for that.
    pub fn drift_arcmin(&self) -> f32 {
        if self.is_followed && self.moved_m <= LONGEST_FOLLOWED_M {
            return 0.0;
        }
        (self.moved_m / self.nearest_m()).atan().to_degrees() * 60.0
    }

    /// Whether re-used tiles are found by their depth, wherever the head has moved.
    pub fn set_followed(&mut self, is_followed: bool) {
        self.is_followed = is_followed;
    }

    /// The application located its views. Only the first two are eyes.
    pub fn located(&mut self, views: &[View]) {
        let views = &views[..views.len().min(2)];
        let Some(head) = head_of(views.iter().map(|view| view.orientation)) else { return };
        let middle = middle_of(views.iter());
        self.head = Some(middle);
        for (eye, view) in self.eyes.iter_mut().zip(views) {
            eye.located = Some(view.fov);
            eye.place(head, middle, view);
            eye.settle();
        }
    }

    /// A projection layer shows these views.
    pub fn shown(&mut self, views: &[ShownView]) {
        let views = &views[..views.len().min(2)];
        let Some(head) = head_of(views.iter().map(|shown| shown.view.orientation)) else { return };
        let middle = middle_of(views.iter().map(|shown| &shown.view));
        self.eyes[views.len()..].fill(Eye::default());
        for (eye, ShownView { view, extent }) in self.eyes.iter_mut().zip(views) {
            eye.shown = Some(ShownFov { fov: view.fov, located: eye.located });
            if eye.located.is_none() {
                eye.place(head, middle, view);
            }
            eye.resize(*extent);
            eye.settle();
        }
    }

    /// No shown object is nearer than this, metres, where that is known: from submitted depth.
    pub fn set_nearest(&mut self, nearest_m: Option<f32>) {
        self.nearest_m = nearest_m;
    }

    /// Nothing that is looked at is taken to be nearer than this, metres.
    pub fn nearest_m(&self) -> f32 {
        self.nearest_m.map_or(NEAREST_ASSUMED_M, |nearest| nearest.max(NEAREST_ASSUMED_M))
    }

    /// Positions of both eyes in the space of the head, metres.
    pub fn positions(&self) -> [Vec3; 2] {
        self.eyes.each_ref().map(|eye| eye.position)
    }

    /// Both views: fields of view, and orientations relative to the head. `None` for a single one.
    pub fn seen(&self) -> Option<[(Fov, Quat); 2]> {
        let [left, right] = self.eyes.each_ref().map(|eye| eye.fov.map(|fov| (fov, eye.orientation)));
        Some([left?, right?])
    }

    /// Whether enough is known to plan.
    pub fn are_known(&self) -> bool {
        self.eyes[0].fov.is_some() && self.eyes.iter().any(|eye| !eye.extent.contains(&0))
    }

    /// The inputs of the plan; `None` before a projection layer was shown.
    pub fn eyes(&self) -> Option<[EyeInput<'static>; 2]> {
        self.are_known().then(|| self.eyes.each_ref().map(Eye::input))
    }

    /// Orientation of an eye's view relative to the head.
    pub fn orientation(&self, eye: usize) -> Quat {
        self.eyes[eye].orientation
    }
}

/// The mean of the views' positions.
fn middle_of<'a>(views: impl ExactSizeIterator<Item = &'a View>) -> Vec3 {
    let count = views.len().max(1) as f32;
    views.map(|view| view.position).sum::<Vec3>() / count
}

impl Eye {
    fn place(&mut self, head: Quat, middle: Vec3, view: &View) {
        self.turn(head.inverse() * view.orientation);
        let position = head.inverse() * (view.position - middle);
        // A NaN is kept: the models refuse it.
        let apart = self.position.distance(position);
        if apart.is_nan() || apart >= TREMOR_M {
            self.position = position;
        }
    }

    fn turn(&mut self, orientation: Quat) {
        // Twice the length of the vector part is the angle: exact where arc cosines are not.
        let apart = (self.orientation.inverse() * orientation).xyz().length() * 2.0;
        // A NaN is kept: the planner refuses it.
        if apart.is_nan() || apart >= TREMOR {
            self.orientation = orientation;
        }
    }

    /// Plans are scaled to pictures of other sizes, so that only another order of sizes counts.
    fn resize(&mut self, extent: [u32; 2]) {
        let is_like = |new: u32, old: u32| new > old / 2 && new / 2 < old;
        if !(is_like(extent[0], self.extent[0]) && is_like(extent[1], self.extent[1])) {
            self.extent = extent;
        }
    }

    /// The application's submission counts more than the located views, as long as it does not change.
    fn settle(&mut self) {
        let fov = match (self.located, self.shown) {
            (Some(located), Some(shown)) if shown.located.is_some_and(|then| is_same(located, then)) => {
                shown.fov
            }
            (Some(located), _) => located,
            (None, Some(shown)) => shown.fov,
            (None, None) => return,
        };
        // The plan's first row is the top, whichever way up a picture is.
        let fov = if fov.up < fov.down { Fov { up: fov.down, down: fov.up, ..fov } } else { fov };
        if !self.fov.is_some_and(|kept| is_same(kept, fov)) {
            self.fov = Some(fov);
        }
    }

    fn input(&self) -> EyeInput<'static> {
        EyeInput {
            offset: [0; 2],
            extent: self.extent,
            fov: self.fov.unwrap_or(Fov { left: 0.0, right: 0.0, up: 0.0, down: 0.0 }),
            orientation: self.orientation,
            contrast: None,
            refresh: false,
        }
    }
}

fn is_same(a: Fov, b: Fov) -> bool {
    [a.left - b.left, a.right - b.right, a.up - b.up, a.down - b.down].iter().all(|by| by.abs() < TREMOR)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOV: Fov = Fov { left: -0.9, right: 0.7, up: 0.8, down: -0.8 };

    fn canted(head: Quat) -> [View; 2] {
        [0.1f32, -0.1].map(|cant| View {
            orientation: head * Quat::from_rotation_y(cant),
            position: Vec3::new(1.0, 2.0, 3.0) - head * Vec3::X * (0.3 * cant),
            fov: FOV,
        })
    }

    fn shown(views: [View; 2], extent: [u32; 2]) -> [ShownView; 2] {
        views.map(|view| ShownView { view, extent })
    }

    fn known() -> Views {
        let mut views = Views::default();
        views.located(&canted(Quat::IDENTITY));
        views.shown(&shown(canted(Quat::IDENTITY), [1000, 900]));
        views
    }

    fn fov(views: &Views) -> Fov {
        views.eyes().unwrap()[0].fov
    }

    #[test]
    fn nothing_is_known_before_something_was_shown() {
        let mut views = Views::default();
        assert!(views.eyes().is_none());
        views.located(&canted(Quat::IDENTITY));
        assert!(views.eyes().is_none());
        views.shown(&[]);
        assert!(views.eyes().is_none());
        views.shown(&shown(canted(Quat::IDENTITY), [1000, 900]));
        assert_eq!(views.eyes().unwrap()[1].extent, [1000, 900]);
    }

    #[test]
    fn a_turning_head_that_trembles_leaves_the_eyes_as_they_are() {
        let mut views = known();
        let before = views.eyes().unwrap();
        for step in 1..200 {
            let head = Quat::from_euler(glam::EulerRot::YXZ, step as f32 * 0.031, step as f32 * 0.007, 0.2);
            let mut located = canted(if step % 2 == 0 { head } else { -head });
            located[0].fov.left += 1e-4 * (step as f32).sin();
            views.located(&located);
            views.shown(&shown(located, [1000, 900]));
        }
        for (before, after) in before.iter().zip(views.eyes().unwrap()) {
            assert_eq!((before.fov, before.orientation), (after.fov, after.orientation));
        }
        let angle = views.orientation(0).angle_between(Quat::from_rotation_y(0.1));
        assert!(angle < 2e-3, "the left display is turned left by {angle} too much");
    }

    #[test]
    fn eyes_are_beside_the_middle_of_the_head_wherever_it_is() {
        let mut views = Views::default();
        assert_eq!(views.seen(), None);
        for step in 0..50 {
            let head = Quat::from_euler(glam::EulerRot::YXZ, step as f32 * 0.1, 0.3, step as f32 * 0.05);
            views.located(&canted(head));
            let [left, right] = views.positions();
            assert!(
                left.abs_diff_eq(Vec3::X * -0.03, TREMOR_M) && right.abs_diff_eq(Vec3::X * 0.03, TREMOR_M)
            );
        }
        let before = views.positions();
        views.located(&canted(Quat::from_rotation_y(1e-3)));
        assert_eq!(views.positions(), before, "to the last bit");
        assert_eq!(views.seen().unwrap().map(|(fov, _)| fov), [FOV; 2]);
        views.located(&canted(Quat::IDENTITY)[..1]);
        assert_eq!(views.positions()[0], Vec3::ZERO, "one view is the head");
    }

    #[test]
    fn a_head_that_moves_makes_what_is_near_drift() {
        let mut views = Views::default();
        let at = |x: f32| {
            canted(Quat::IDENTITY).map(|view| View { position: view.position + Vec3::X * x, ..view })
        };
        views.frame_begins();
        assert_eq!(views.drift_arcmin(), 0.0, "nothing is known");
        for frame in 0..4 {
            views.located(&at(0.002 * frame as f32));
            views.frame_begins();
        }
        // 2 mm at 0.4 m.
        assert!((views.drift_arcmin() - 17.19).abs() < 0.01, "{}", views.drift_arcmin());
        views.set_nearest(Some(2.0));
        assert!((views.drift_arcmin() - 3.44).abs() < 0.01, "{}", views.drift_arcmin());
        views.frame_begins();
        assert_eq!(views.drift_arcmin(), 0.0, "where it was");
        for (x, is_followed, expected) in
            [(0.046, true, 0.0), (0.086, false, 68.75), (0.126, true, 0.0), (0.226, true, 171.7)]
        {
            views.located(&at(x));
            views.set_followed(is_followed);
            views.frame_begins();
            assert!((views.drift_arcmin() - expected).abs() < 0.1, "{} at {x}", views.drift_arcmin());
        }
    }

    #[test]
    fn what_is_farther_than_assumed_is_believed_and_nothing_else() {
        let mut views = Views::default();
        for (told, nearest) in [(None, 0.4), (Some(0.05), 0.4), (Some(2.0), 2.0), (Some(f32::NAN), 0.4)] {
            views.set_nearest(told);
            assert_eq!(views.nearest_m(), nearest, "{told:?}");
        }
    }

    #[test]
    fn what_drifts_is_followed() {
        let mut views = known();
        let mut located = canted(Quat::IDENTITY);
        for _ in 0..100 {
            located[0].fov.left -= 1e-4;
            views.located(&located);
        }
        assert!((fov(&views).left - located[0].fov.left).abs() <= TREMOR);
    }

    #[test]
    fn an_application_that_shows_another_field_of_view_is_believed() {
        let mut views = known();
        let narrow = Fov { left: -0.5, ..FOV };
        views.shown(&shown(canted(Quat::IDENTITY).map(|view| View { fov: narrow, ..view }), [1000, 900]));
        views.located(&canted(Quat::IDENTITY));
        assert_eq!(fov(&views), narrow);
        let wider = Fov { left: -1.0, ..FOV };
        views.located(&canted(Quat::IDENTITY).map(|view| View { fov: wider, ..view }));
        assert_eq!(fov(&views), wider, "until the headset has another one");
    }

    #[test]
    fn pictures_that_are_upside_down_have_the_same_plan() {
        let mut views = known();
        let flipped = Fov { up: FOV.down, down: FOV.up, ..FOV };
        views.shown(&shown(canted(Quat::IDENTITY).map(|view| View { fov: flipped, ..view }), [1000, 900]));
        assert_eq!(fov(&views), FOV);
    }

    #[test]
    fn dynamic_resolution_keeps_the_tiles() {
        let mut views = known();
        for (extent, expected) in [
            ([700, 630], [1000, 900]),
            ([1900, 1700], [1000, 900]),
            ([500, 450], [500, 450]),
            ([900, 800], [500, 450]),
            ([1000, 900], [1000, 900]),
        ] {
            views.shown(&shown(canted(Quat::IDENTITY), extent));
            assert_eq!(views.eyes().unwrap()[0].extent, expected, "{extent:?}");
        }
    }

    #[test]
    fn one_view_is_the_left_eye() {
        let mut views = known();
        views.shown(&shown(canted(Quat::IDENTITY), [1000, 900])[..1]);
        assert_eq!(views.eyes().unwrap().map(|eye| eye.extent), [[1000, 900], [0, 0]]);
    }

    #[test]
    fn opposite_views_have_no_head() {
        assert_eq!(head_of([]), None);
        let half_turn = Quat::from_rotation_y(std::f32::consts::PI);
        assert!(head_of([Quat::IDENTITY, half_turn]).is_none_or(|head| head.is_finite()));
        let head = Quat::from_rotation_x(0.4);
        let mean = head_of(canted(head).map(|view| view.orientation)).unwrap();
        assert!(mean.angle_between(head) < 1e-3);
    }
}
