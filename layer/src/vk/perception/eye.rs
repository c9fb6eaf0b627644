//! The state of one eye.

use super::Tools;
use crate::gpu::{Gpu, GpuError};
use crate::kernels::analyze::{Levels, ViewTiles};
use crate::kernels::decide::DecideTarget;
use crate::link::{EyeBufferRecord, EyeViewRecord};
use ash::vk;
use glam::{Quat, Vec2};
use parafovea_core::geometry::{ImagePlane, View};
use std::sync::{Arc, OnceLock};

/// An eye whose pictures are analysed.
pub struct Eye {
    /// Its tiles.
    pub tiles: Arc<EyeTiles>,
    /// The picture that was analysed last; `None` if its view is known too.
    pub analyzed: Option<Analyzed>,
    /// The last picture that was analysed and shown; `None` if contrast is not known.
    pub measured: Option<Measured>,
}

/// Place of an eye buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    swapchain: u64,
    layer: u32,
    rect: [u32; 4],
}

impl Place {
    /// That of a picture.
    pub fn of(record: &EyeBufferRecord) -> Self {
        Self { swapchain: record.swapchain, layer: record.layer, rect: record.rect }
    }
}

/// A picture that was analysed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Analyzed {
    /// Its place.
    pub place: Place,
    /// Number of the plan at that time.
    pub received: u64,
    /// The parameters of the analysis.
    pub by: Parameters,
    /// Number of consecutive analyses up to this one that began with a comparison with the picture before.
    pub comparison: u32,
}

/// A picture that was analysed, and whose view is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The view that it shows.
    pub view: View,
    /// Number of the plan at the time of its analysis.
    pub received: u64,
    by: Parameters,
    comparison: u32,
    /// Whether the picture before it showed the same view.
    is_still: bool,
}

/// Parameters of a picture's analysis, beside its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    texel: [u32; 2],
    white_cd_m2: f32,
    is_mean: bool,
    format: vk::Format,
}

impl Parameters {
    /// The parameters in a record, with tiles of `texel` pixels.
    pub fn new(record: &EyeBufferRecord, texel: [u32; 2]) -> Self {
        let EyeBufferRecord { white_cd_m2, is_mean, format, .. } = *record;
        Self { texel, white_cd_m2, is_mean: is_mean == 1, format }
    }
}

impl Measured {
    /// An analysed picture in its view, after the last one; `None` if the frame shows another place, or the view is not finite.
    pub fn new(record: &EyeViewRecord, analyzed: &Analyzed, last: Option<&Self>) -> Option<Self> {
        let place = Place { swapchain: record.swapchain, layer: record.layer, rect: record.rect };
        let view = view_of(record).filter(|_| place == analyzed.place)?;
        let Analyzed { received, by, comparison, .. } = *analyzed;
        let is_still = last.is_some_and(|last| last.view == view && last.by == by);
        Some(Self { view, received, by, comparison, is_still })
    }

    /// [`Analyzed::comparison`] of the picture after this one. Its view is not known yet: if the last two pictures showed the same view, it is
    /// expected to remain, and a comparison may save the analysis. Pictures of a moving view hardly ever equal each other.
    pub fn next_comparison(&self, by: Parameters) -> u32 {
        if self.is_still && self.by == by { self.comparison.saturating_add(1) } else { 0 }
    }
}

/// The tiles of an eye buffer, on the GPU.
pub struct EyeTiles {
    /// 0: left, 1: right.
    pub eye: usize,
    /// Contrast and rates.
    pub view: Arc<ViewTiles>,
    /// Size of the pictures, pixels.
    pub extent: [u32; 2],
    /// Made for the first picture that is analysed: none is while contrast does not count.
    levels: OnceLock<Arc<Levels>>,
    /// The target of decisions.
    pub decide: DecideTarget,
}

impl EyeTiles {
    /// Of that many columns and rows, with nothing known, of pictures of that many pixels.
    ///
    /// # Errors
    /// A failed call, or more tiles than the device takes.
    pub fn new(tools: &Tools, eye: usize, tiles: [u32; 2], extent: [u32; 2]) -> Result<Self, GpuError> {
        let view = Arc::new(ViewTiles::new(&tools.gpu, tiles)?);
        let decide = tools.decide.target(&view)?;
        Ok(Self { eye, view, extent, levels: OnceLock::new(), decide })
    }

    /// Memory for the analysis of pictures.
    ///
    /// # Errors
    /// A failed call, or more pixels than the device takes.
    pub fn levels(&self, gpu: &Arc<Gpu>) -> Result<&Arc<Levels>, GpuError> {
        if let Some(levels) = self.levels.get() {
            return Ok(levels);
        }
        let new = Arc::new(Levels::new(gpu, self.extent)?);
        Ok(self.levels.get_or_init(|| new))
    }
}

/// The view of a picture.
fn view_of(record: &EyeViewRecord) -> Option<View> {
    let [x, y, z, w] = record.orientation;
    let [origin, step] = record.plane.map(Vec2::from);
    let view = View { orientation: Quat::from_xyzw(x, y, z, w), plane: ImagePlane { origin, step } };
    (view.orientation.is_finite() && origin.is_finite() && step.is_finite()).then_some(view)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;

    const RECT: [u32; 4] = [0, 0, 64, 64];

    fn record() -> EyeBufferRecord {
        EyeBufferRecord {
            eye: 0,
            queue: [0; 2],
            swapchain: 1,
            image: vk::Image::null(),
            format: vk::Format::R8G8B8A8_SRGB,
            layer: 0,
            rect: RECT,
            white_cd_m2: 100.0,
            is_mean: 0,
        }
    }

    fn view() -> EyeViewRecord {
        EyeViewRecord {
            eye: 0,
            swapchain: 1,
            layer: 0,
            rect: RECT,
            plane: [[-1.0, 1.0], [0.03, -0.03]],
            orientation: [0.0, 0.0, 0.0, 1.0],
        }
    }

    /// Pictures one after the other, each analysed and then shown.
    #[derive(Default)]
    struct Pictures(Option<Measured>);

    impl Pictures {
        /// The comparison of the next one; `None` if its contrast does not count.
        fn next(&mut self, record: &EyeBufferRecord, texel: u32, view: &EyeViewRecord) -> Option<u32> {
            let by = Parameters::new(record, [texel; 2]);
            let comparison = self.0.map_or(0, |last| last.next_comparison(by));
            let analyzed = Analyzed { place: Place::of(record), received: 7, by, comparison };
            self.0 = Measured::new(view, &analyzed, self.0.as_ref());
            self.0.map(|measured| measured.comparison)
        }
    }

    #[test]
    fn pictures_are_compared_while_the_view_rests() {
        let mut pictures = Pictures::default();
        let mut next =
            |record: &EyeBufferRecord, texel, view: &EyeViewRecord| pictures.next(record, texel, view);
        // Two of the same view are needed.
        assert_eq!([(); 4].map(|()| next(&record(), 16, &view())), [Some(0), Some(0), Some(1), Some(2)]);
        // Another image of the swapchain shows the same.
        let image = vk::Image::from_raw(5);
        assert_eq!(next(&EyeBufferRecord { image, ..record() }, 16, &view()), Some(3));
        // Other parameters: no comparison with it, nor of the next with it.
        let others = [
            EyeBufferRecord { white_cd_m2: 99.0, ..record() },
            EyeBufferRecord { is_mean: 1, ..record() },
            EyeBufferRecord { format: vk::Format::R8G8B8A8_UNORM, ..record() },
        ];
        for other in others {
            assert_eq!(next(&other, 16, &view()), Some(0), "{other:?}");
            assert_eq!([(); 3].map(|()| next(&record(), 16, &view())), [Some(0), Some(0), Some(1)]);
        }
        assert_eq!([(); 2].map(|()| next(&record(), 32, &view())), [Some(0); 2]);
    }

    #[test]
    fn moving_views_end_comparisons() {
        let moved = [
            EyeViewRecord { orientation: [0.0, 1e-3, 0.0, 1.0], ..view() },
            EyeViewRecord { plane: [[-1.0, 1.0], [0.03, -0.031]], ..view() },
        ];
        for moved in moved {
            let mut pictures = Pictures::default();
            let mut next = |view: &EyeViewRecord| pictures.next(&record(), 16, view);
            assert_eq!([(); 3].map(|()| next(&view())), [Some(0), Some(0), Some(1)]);
            // The first one was expected to be the same; a comparison finds that it differs.
            assert_eq!(
                [next(&moved), next(&view()), next(&view())],
                [Some(2), Some(0), Some(0)],
                "{moved:?}"
            );
        }
    }

    #[test]
    fn contrast_counts_for_its_own_place_and_finite_views() {
        let wrong = [
            EyeViewRecord { swapchain: 2, ..view() },
            EyeViewRecord { layer: 1, ..view() },
            EyeViewRecord { rect: [0, 0, 63, 64], ..view() },
            EyeViewRecord { orientation: [f32::NAN; 4], ..view() },
            EyeViewRecord { plane: [[f32::INFINITY, 1.0], [0.03, -0.03]], ..view() },
        ];
        for wrong in wrong {
            let mut pictures = Pictures::default();
            assert_eq!(pictures.next(&record(), 16, &wrong), None, "{wrong:?}");
            assert_eq!(pictures.next(&record(), 16, &view()), Some(0));
        }
    }
}
