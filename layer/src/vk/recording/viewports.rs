//! The regions that draws of a pass can reach, by their viewports: an application with dynamic resolution draws to a part of its targets,
//! in passes whose render area is the whole of them.
//!
//! Draws are not looked at one by one: a viewport reaches as far as draws were counted from its command to the next.

use super::draws::Counts;
use ash::vk;

/// A region of a pass's targets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Region {
    /// No pixel.
    #[default]
    Nothing,
    /// From its left and top edge to its right and bottom edge, pixels.
    Rect([f32; 4]),
    /// All pixels: viewports are not known.
    Everything,
}

impl Region {
    /// The region of all these viewports.
    pub fn of(viewports: &[vk::Viewport]) -> Self {
        viewports.iter().map(Self::of_one).fold(Self::Nothing, Self::with)
    }

    fn of_one(viewport: &vk::Viewport) -> Self {
        // A negative height flips the picture (VK_KHR_maintenance1), and begins at the bottom.
        let [y, end] = [viewport.y, viewport.y + viewport.height];
        let rect = [viewport.x, y.min(end), viewport.x + viewport.width, y.max(end)];
        if rect.iter().all(|edge| edge.is_finite()) { Self::Rect(rect) } else { Self::Everything }
    }

    /// The smallest region with both in it.
    pub fn with(self, other: Self) -> Self {
        match (self, other) {
            (Self::Nothing, region) | (region, Self::Nothing) => region,
            (Self::Everything, _) | (_, Self::Everything) => Self::Everything,
            (Self::Rect(one), Self::Rect(two)) => {
                Self::Rect([one[0].min(two[0]), one[1].min(two[1]), one[2].max(two[2]), one[3].max(two[3])])
            }
        }
    }

    /// The part of a render area (x, y, width, height in pixels) in the region, its edges rounded to pixels; all of it if that is empty, or
    /// the region is not known.
    pub fn of_area(self, area: [u32; 4]) -> [u32; 4] {
        let Self::Rect([left, top, right, bottom]) = self else { return area };
        let along = |first: f32, end: f32, axis: usize| {
            let (from, to) = (area[axis], area[axis].saturating_add(area[axis + 2]));
            // Saturates.
            let [first, end] = [first, end].map(|edge| (edge.round() as u32).clamp(from, to));
            (first < end).then_some((first, end - first))
        };
        match (along(left, right, 0), along(top, bottom, 1)) {
            (Some((x, width)), Some((y, height))) => [x, y, width, height],
            _ => area,
        }
    }
}

/// The viewports of a command buffer, and the regions that its pass has drawn to.
#[derive(Clone, Debug)]
pub struct Viewports {
    current: Region,
    /// The draws of the pass when `current` was set.
    counts: Counts,
    /// Regions of quads, and of other draws.
    drawn: [Region; 2],
}

impl Default for Viewports {
    fn default() -> Self {
        Self { current: Region::Everything, counts: Counts::default(), drawn: [Region::Nothing; 2] }
    }
}

impl Viewports {
    /// Viewports are set from number `first` on, after these draws of the pass; from number 0 on, they count as all of them.
    pub fn set(&mut self, first: u32, viewports: &[vk::Viewport], counts: Counts) {
        self.count(counts);
        let region = Region::of(viewports);
        self.current = if first == 0 { region } else { region.with(self.current) };
    }

    /// The pass has made these draws so far.
    pub fn count(&mut self, counts: Counts) {
        let is_more = [counts.quads > self.counts.quads, counts.meshes > self.counts.meshes];
        for (drawn, _) in self.drawn.iter_mut().zip(is_more).filter(|(_, is_more)| *is_more) {
            *drawn = drawn.with(self.current);
        }
        self.counts = counts;
    }

    /// A pass begins.
    pub fn pass_begins(&mut self) {
        *self = Self { current: self.current, ..Self::default() };
    }

    /// A secondary command buffer with that many draws is executed. It leaves no viewports.
    pub fn execute(&mut self, secondary: &Self, draws: Counts) {
        self.counts.add(draws);
        self.current = Region::Everything;
        for (drawn, more) in self.drawn.iter_mut().zip(secondary.drawn) {
            *drawn = drawn.with(more);
        }
    }

    /// The region of a pass that ends with these draws: that of the meshes, if there are any, as a quad may clear more than the picture.
    pub fn finish(&mut self, counts: Counts) -> Region {
        self.count(counts);
        let [of_quads, of_meshes] = self.drawn;
        if counts.meshes > 0 { of_meshes } else { of_quads }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn viewport(x: f32, y: f32, width: f32, height: f32) -> vk::Viewport {
        vk::Viewport { x, y, width, height, min_depth: 0.0, max_depth: 1.0 }
    }

    const AREA: [u32; 4] = [0, 0, 100, 80];

    #[test]
    fn areas_are_cut_to_viewports() {
        let of = |viewports: &[vk::Viewport]| Region::of(viewports).of_area(AREA);
        assert_eq!(of(&[viewport(0.0, 0.0, 80.0, 64.0)]), [0, 0, 80, 64]);
        assert_eq!(of(&[viewport(10.0, 74.0, 80.0, -64.0)]), [10, 10, 80, 64], "flipped");
        assert_eq!(of(&[viewport(-0.4, 0.3, 80.2, 63.9)]), [0, 0, 80, 64], "jittered by less than a pixel");
        assert_eq!(of(&[viewport(-20.0, -20.0, 500.0, 500.0)]), AREA);
        // Both eyes beside each other.
        assert_eq!(of(&[viewport(0.0, 0.0, 40.0, 64.0), viewport(40.0, 0.0, 40.0, 64.0)]), [0, 0, 80, 64]);
    }

    #[test]
    fn areas_stay_without_a_usable_viewport() {
        let of = |viewports: &[vk::Viewport]| Region::of(viewports).of_area(AREA);
        assert_eq!(of(&[]), AREA);
        assert_eq!(of(&[viewport(0.0, 0.0, 0.0, 0.0)]), AREA);
        assert_eq!(of(&[viewport(200.0, 0.0, 10.0, 10.0)]), AREA);
        assert_eq!(of(&[viewport(f32::NAN, 0.0, 10.0, 10.0)]), AREA);
        let known = Region::of(&[viewport(0.0, 0.0, 10.0, 10.0)]);
        assert_eq!(known.with(Region::Everything).of_area(AREA), AREA);
        assert_eq!(Region::Nothing.with(known), known);
    }

    const QUAD: Counts = Counts { quads: 1, meshes: 0, vertices: 3 };
    const MESH: Counts = Counts { quads: 0, meshes: 1, vertices: 300 };

    fn sum(all: &[Counts]) -> Counts {
        all.iter().fold(Counts::default(), |mut sum, more| {
            sum.add(*more);
            sum
        })
    }

    #[test]
    fn viewports_count_once_they_are_drawn_with() {
        let [whole, part] = [viewport(0.0, 0.0, 100.0, 80.0), viewport(0.0, 0.0, 80.0, 64.0)];
        let region = |viewport| Region::of(&[viewport]);
        let mut viewports = Viewports::default();
        // From before the pass; nothing is drawn with it.
        viewports.set(0, &[whole], Counts::default());
        viewports.pass_begins();
        viewports.set(0, &[part], Counts::default());
        assert_eq!(viewports.clone().finish(MESH), region(part));
        // A quad with another one clears.
        viewports.set(0, &[whole], MESH);
        assert_eq!(viewports.clone().finish(sum(&[MESH, QUAD])), region(part));
        assert_eq!(viewports.clone().finish(sum(&[MESH, MESH])), region(whole));
        // It is still set in the next pass.
        viewports.pass_begins();
        assert_eq!(viewports.clone().finish(QUAD), region(whole));
        assert_eq!(viewports.clone().finish(Counts::default()), Region::Nothing);
        // Another one beside it.
        viewports.set(1, &[part], Counts::default());
        assert_eq!(viewports.finish(MESH), region(whole));
    }

    #[test]
    fn regions_of_secondaries_are_those_of_the_pass() {
        let part = viewport(0.0, 0.0, 80.0, 64.0);
        let mut secondary = Viewports::default();
        secondary.set(0, &[part], Counts::default());
        secondary.count(MESH);
        let mut viewports = Viewports::default();
        viewports.pass_begins();
        viewports.execute(&secondary, MESH);
        assert_eq!(viewports.clone().finish(MESH), Region::of(&[part]));
        assert_eq!(viewports.finish(sum(&[MESH, MESH])), Region::Everything, "unknown after a secondary");
        let mut unknown = Viewports::default();
        assert_eq!(unknown.finish(MESH), Region::Everything, "nothing was set");
    }
}
