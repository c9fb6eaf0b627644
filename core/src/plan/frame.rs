//! The plan of one frame.

use super::reasons::Reasons;
use super::rings::{AvailableRates, Rings};
use super::statistics::Statistics;
use crate::chroma::{ChromaSettings, Focus};
use crate::geometry::{Fov, ImagePlane};
use crate::image::Plane;
use crate::kernels::decide::DecideParams;
use crate::rate::ShadingRate;
use crate::reuse::STALE;
use glam::{UVec2, Vec2, Vec3};

/// The plan of one frame, for both eyes.
#[derive(Clone, Debug, Default)]
pub struct FramePlan {
    /// Number of the frame.
    pub frame: u64,
    /// For the left and the right eye.
    pub eyes: [EyePlan; 2],
    /// Reasons for a plan that is more careful than its settings.
    pub reasons: Reasons,
    /// The rates that there are.
    pub available: AvailableRates,
    /// Angle by which the rings are widened for the uncertainty of the gaze, degrees, 0..=180.
    pub inflation_deg: f32,
    /// Outer radii of the first four regions of the update schedule, widened too, degrees; infinite without a schedule.
    pub regions_deg: [f32; 4],
    /// Frames between updates in the five regions.
    pub periods: [u8; 5],
    /// Greatest loss of visible contrast, alpha of paper A Eq. 17, where contrast is judged.
    pub budget: Option<f32>,
    /// Chroma attenuation around [`EyePlan::focus`].
    pub chroma: Option<ChromaSettings>,
}

/// The plan of one frame for one eye.
#[derive(Clone, Debug)]
pub struct EyePlan {
    /// First pixel of the view in its image.
    pub offset: [u32; 2],
    /// Size of the view, pixels.
    pub extent: [u32; 2],
    /// Size of a tile, pixels. The first tile begins at `offset` rounded down to a multiple of this.
    pub texel: [u32; 2],
    /// Field of view of the view.
    pub fov: Fov,
    /// Gaze direction of this eye, unit vector in the view's space; all 0 if unknown.
    pub gaze: Vec3,
    /// Centres of the rings, unit vectors in the view's space: the gaze of the left and of the right eye, or the axes of
    /// both lenses.
    pub centres: [Vec3; 2],
    /// Area of full colour, in the view's space; `None`: full colour everywhere.
    pub focus: Option<Focus>,
    /// [`ShadingRate::texel`] with which a tile is shaded when it is rendered.
    pub rates: Plane<u8>,
    /// Frames since a tile was rendered; 0: it is rendered in this frame.
    pub ages: Plane<u8>,
    /// Rings that limit the rates, with everything that widens them.
    pub rings: Rings,
    /// Parameters of the decision about rates: the uniform of the kernel `decide`.
    pub decision: DecideParams,
    /// Parameters of the decision on the GPU, by contrast; `None` if contrast does not count in this frame.
    pub by_contrast: Option<DecideParams>,
}

impl Default for EyePlan {
    fn default() -> Self {
        Self {
            offset: [0; 2],
            extent: [0; 2],
            texel: [16; 2],
            fov: Fov { left: 0.0, right: 0.0, up: 0.0, down: 0.0 },
            gaze: Vec3::ZERO,
            centres: [Vec3::NEG_Z; 2],
            focus: None,
            rates: Plane::filled(0, 0, 0),
            ages: Plane::filled(0, 0, 0),
            rings: Rings::FULL,
            decision: bytemuck::Zeroable::zeroed(),
            by_contrast: None,
        }
    }
}

impl EyePlan {
    /// Rate of the tile in column `x`, row `y`; 1x1 outside of the plan.
    pub fn rate(&self, x: u32, y: u32) -> ShadingRate {
        let inside = x < self.rates.width() && y < self.rates.height();
        inside.then(|| ShadingRate::from_texel(self.rates.at(x, y))).flatten().unwrap_or(ShadingRate::R1X1)
    }

    /// Whether the tile in column `x`, row `y` is rendered in this frame; true outside of the plan.
    pub fn is_due(&self, x: u32, y: u32) -> bool {
        x >= self.ages.width() || y >= self.ages.height() || self.ages.at(x, y) == 0
    }

    /// Sums over the tiles.
    pub fn statistics(&self) -> Statistics {
        Statistics::new(self)
    }

    /// Appends the map of the tiles to `out`, row by row: a byte for each, its rate, with [`STALE`] where it is not rendered.
    pub fn write_map(&self, out: &mut Vec<u8>) {
        let tiles = self.rates.texels().iter().zip(self.ages.texels());
        out.extend(tiles.map(|(rate, age)| if *age == 0 { *rate } else { *rate | STALE }));
    }

    /// The tile that shows a pixel of the view.
    pub fn tile_of(&self, pixel: [u32; 2]) -> [u32; 2] {
        let texel = UVec2::from(self.texel).max(UVec2::ONE);
        ((UVec2::from(pixel).saturating_add(UVec2::from(self.offset) % texel)) / texel).into()
    }

    /// The image of the view.
    pub(super) fn plane(&self) -> ImagePlane {
        self.fov.tangents().plane(self.extent)
    }

    /// The pixel of the view that this eye looks at.
    pub fn gaze_pixel(&self) -> Option<Vec2> {
        let plane = self.plane();
        let on_plane = (self.gaze.z < 0.0).then(|| self.gaze.truncate() / -self.gaze.z)?;
        let pixel = (on_plane - plane.origin) / plane.step;
        pixel.is_finite().then_some(pixel)
    }
}
