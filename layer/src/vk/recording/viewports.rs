//! The regions that draws of a pass can reach, by their viewports: an application with dynamic resolution draws to a part of its targets,
//! in passes whose render area is the whole of them.

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
}
