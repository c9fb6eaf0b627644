//! The views of the eyes, as the application locates and shows them.
//!
//! Poses and fields of view that are computed in each frame tremble in their last bits, which must not change the plan; and an application
//! that changes its resolution from frame to frame must not lose the history of its tiles.

use glam::{Quat, Vec3};
use parafovea_core::gaze::NEAREST_ASSUMED_M;
use parafovea_core::geometry::Fov;
use parafovea_core::plan::EyeInput;

/// Smaller differences count as none, radians: 0.06 degrees, a pixel or so, an eighth of the hysteresis of the rings.
pub const TREMOR: f32 = 1e-3;

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
    /// The space of the projection layer, if that rests in the world, and the head's position there, metres.
    head: Option<(u64, Vec3)>,
    /// The same of the frame before.
    last_head: Option<(u64, Vec3)>,
    /// Distance that it moved within the last frame, metres.
    moved_m: f32,
    /// Whether re-used tiles are followed by their depth.
    is_followed: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct Eye {
    located: Option<Shape>,
    shown: Option<ShownShape>,
    /// Number of frames in a row that showed this orientation relative to the head.
    steady_frames: u32,
    /// In the space of the head.
    orientation: Quat,
    /// In the space of the head, whose origin is in the middle of both, metres.
    position: Vec3,
    /// Field of view to plan with; of the row above as the top.
    fov: Option<Fov>,
    extent: [u32; 2],
    /// Another extent that was shown last, and the number of frames in a row.
    other_extent: ([u32; 2], u32),
}

/// Frames after which an extent that stays the same is planned with: a render scale that an application has set once. Dynamic resolution changes
/// more often.
const SETTLED_FRAMES: u32 = 60;

/// Frames in a row after which a shown orientation that differs from the located one is believed.
const STEADY_FRAMES: u32 = 3;

/// The shape of a view, relative to the head.
#[derive(Clone, Copy, Debug)]
struct Shape {
    fov: Fov,
    orientation: Quat,
}

/// The shape that a projection layer showed.
#[derive(Clone, Copy, Debug)]
struct ShownShape {
    shape: Shape,
    /// The answer of xrLocateViews then.
    located: Option<Shape>,
}

impl Views {
    /// A frame begins.
    pub fn frame_begins(&mut self) {
        let is_in_one = |((space, _), (last, _)): &((u64, Vec3), (u64, Vec3))| space == last;
        let heads = self.head.zip(self.last_head).filter(is_in_one);
        self.moved_m = heads.map_or(0.0, |((_, head), (_, last))| head.distance(last));
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
        for (eye, view) in self.eyes.iter_mut().zip(views) {
            eye.located = Some(Shape { fov: view.fov, orientation: head.inverse() * view.orientation });
            eye.place(head, middle, view);
            eye.settle();
        }
    }

    /// A projection layer shows these views in a space, which is missing unless it rests in the world.
    ///
    /// Applications may locate their views relative to the head (Unreal), where it never moves, and show views of another orientation (xrizer
    /// makes canted ones parallel).
    pub fn shown(&mut self, space: Option<u64>, views: &[ShownView]) {
        let views = &views[..views.len().min(2)];
        let Some(head) = head_of(views.iter().map(|shown| shown.view.orientation)) else { return };
        let middle = middle_of(views.iter().map(|shown| &shown.view));
        self.head = space.map(|space| (space, middle));
        self.eyes[views.len()..].fill(Eye::default());
        for (eye, ShownView { view, extent }) in self.eyes.iter_mut().zip(views) {
            let shape = Shape { fov: view.fov, orientation: head.inverse() * view.orientation };
            let is_steady = |last: &ShownShape| angle(last.shape.orientation, shape.orientation) < TREMOR;
            let is_steady = eye.shown.as_ref().is_some_and(is_steady);
            eye.steady_frames = if is_steady { eye.steady_frames.saturating_add(1) } else { 0 };
            eye.shown = Some(ShownShape { shape, located: eye.located });
            if eye.located.is_none() {
                eye.place(head, middle, view);
            }
            eye.resize(*extent);
            eye.settle();
        }
    }

    /// Sets the least distance of a shown object, metres; `None` without submitted depth.
    pub fn set_nearest(&mut self, nearest_m: Option<f32>) {
        self.nearest_m = nearest_m;
    }

    /// The assumed least distance of the objects in view, metres.
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
        let position = head.inverse() * (view.position - middle);
        // A NaN is kept: the models refuse it.
        let apart = self.position.distance(position);
        if apart.is_nan() || apart >= TREMOR_M {
            self.position = position;
        }
    }

    fn turn(&mut self, orientation: Quat) {
        let apart = angle(self.orientation, orientation);
        // A NaN is kept: the planner refuses it.
        if apart.is_nan() || apart >= TREMOR {
            self.orientation = orientation;
        }
    }

    /// Plans are scaled to pictures of other sizes, so that another order of sizes counts at once, and another size only if it stays. The contrast
    /// of pictures is known at the planned size alone.
    fn resize(&mut self, extent: [u32; 2]) {
        let is_like = |new: u32, old: u32| new > old / 2 && new / 2 < old;
        let (other, frames) = self.other_extent;
        let frames = if other == extent { frames + 1 } else { 1 };
        let is_near = is_like(extent[0], self.extent[0]) && is_like(extent[1], self.extent[1]);
        if extent == self.extent || !is_near || frames >= SETTLED_FRAMES {
            self.extent = extent;
            self.other_extent = Default::default();
        } else {
            self.other_extent = (extent, frames);
        }
    }

    /// The application's submission counts more than the located views, as long as it does not change.
    fn settle(&mut self) {
        let is_located_so = |located: Shape| {
            move |then: Shape| {
                is_same(located.fov, then.fov) && angle(located.orientation, then.orientation) < TREMOR
            }
        };
        let Shape { fov, orientation } = match (self.located, self.shown) {
            (Some(located), Some(shown)) if shown.located.is_some_and(is_located_so(located)) => {
                // An old picture of one eye beside a new one of the other is turned by the head's turn.
                let is_steady = self.steady_frames >= STEADY_FRAMES;
                let orientation = if is_steady { shown.shape.orientation } else { located.orientation };
                Shape { orientation, ..shown.shape }
            }
            (Some(located), _) => located,
            (None, Some(shown)) => shown.shape,
            (None, None) => return,
        };
        self.turn(orientation);
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

/// The angle between two orientations, radians, if it is small.
fn angle(a: Quat, b: Quat) -> f32 {
    // Twice the length of the vector part: exact where arc cosines are not.
    (a.inverse() * b).xyz().length() * 2.0
}

fn is_same(a: Fov, b: Fov) -> bool {
    [a.left - b.left, a.right - b.right, a.up - b.up, a.down - b.down].iter().all(|by| by.abs() < TREMOR)
}

#[cfg(test)]
mod tests;
