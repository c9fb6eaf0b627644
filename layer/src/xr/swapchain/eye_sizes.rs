//! Sizes of eye buffers. Swapchains of other sizes are for quads, as overlays and menus are: no picture in them is attenuated, completed or
//! re-used.

use crate::xr::session::Session;
use openxr_sys as xr;
use smallvec::SmallVec;
use std::ptr;

/// Scales of rendering that an application may choose on either axis, relative to the recommended size.
const SCALES: std::ops::RangeInclusive<f32> = 0.4..=2.5;

/// The greatest stretch of a picture's aspect.
const MOST_STRETCH: f32 = 1.6;

/// Columns and rows of eyes in one image.
const ARRANGEMENTS: [[f32; 2]; 3] = [[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]];

/// Sizes of the views of a stereo headset.
pub type EyeSizes = SmallVec<[[u32; 2]; 2]>;

/// The recommended sizes of the eyes, pixels; none if the runtime does not know them.
pub fn recommended(session: &Session) -> EyeSizes {
    let empty = xr::ViewConfigurationView {
        ty: xr::ViewConfigurationView::TYPE,
        next: ptr::null_mut(),
        recommended_image_rect_width: 0,
        max_image_rect_width: 0,
        recommended_image_rect_height: 0,
        max_image_rect_height: 0,
        recommended_swapchain_sample_count: 0,
        max_swapchain_sample_count: 0,
    };
    let mut views = [empty; 2];
    let mut count = 0;
    // SAFETY: the next layer's function with a live instance, and an array of as many structures as said.
    let result = unsafe {
        (session.instance.next.enumerate_view_configuration_views)(
            session.instance.handle,
            session.system,
            xr::ViewConfigurationType::PRIMARY_STEREO,
            views.len() as u32,
            &mut count,
            views.as_mut_ptr(),
        )
    };
    if result.into_raw() < 0 {
        return EyeSizes::new();
    }
    let size = |view: &xr::ViewConfigurationView| {
        [view.recommended_image_rect_width, view.recommended_image_rect_height]
    };
    views.iter().take(count as usize).map(size).filter(|size| !size.contains(&0)).collect()
}

/// Whether images of a size, pixels, may show an eye or two: one in each array layer, side by side, or one above the other. Without
/// `recommended` sizes, all may.
pub fn may_show_eyes(size: [u32; 2], recommended: &[[u32; 2]]) -> bool {
    let fits = |eye: &[u32; 2], arrangement: &[f32; 2]| {
        let scale = |axis: usize| size[axis] as f32 / (eye[axis] as f32 * arrangement[axis]);
        let [x, y] = [scale(0), scale(1)];
        SCALES.contains(&x) && SCALES.contains(&y) && (x / y).max(y / x) <= MOST_STRETCH
    };
    recommended.is_empty() || recommended.iter().any(|eye| ARRANGEMENTS.iter().any(|way| fits(eye, way)))
}

#[cfg(test)]
mod tests {
    use super::super::history_memory::images;
    use super::*;
    use crate::kernels::compose::ImageMemory;

    const EYE: [u32; 2] = [2064, 2208];

    #[test]
    fn quads_are_no_eyes() {
        let is_eye = |size| may_show_eyes(size, &[EYE, EYE]);
        for quad in [[512, 512], [1024, 768], [256, 256], [4096, 512], [3840, 64], [1, 1], [0, 2208]] {
            assert!(!is_eye(quad), "{quad:?}");
        }
        for eye in [EYE, [1440, 1600], [4128, 2208], [2064, 4416], [2880, 1600], [3096, 3312], [1032, 1104]] {
            assert!(is_eye(eye), "{eye:?}");
        }
        assert!(may_show_eyes([512, 512], &[]), "of a runtime without an answer");
    }

    #[test]
    fn either_eye_counts() {
        assert!(may_show_eyes([1000, 1000], &[[200, 200], [1000, 1000]]));
    }

    /// Images of 1 MiB for overlays and of 17.4 MiB for eyes, whose history takes 52 MiB each: had the overlays a history too, the second eye
    /// would get none.
    #[test]
    fn quads_before_the_eyes_take_no_history() {
        const MIB: u64 = 1 << 20;
        let mut remaining = 560 * MIB;
        let sizes = [[[512, 512]; 8].as_slice(), &[EYE, EYE]].concat();
        let counts: Vec<u32> = sizes
            .into_iter()
            .map(|size| {
                let bytes = u64::from(size[0] * size[1] * 4);
                let least = if may_show_eyes(size, &[EYE]) { 6 } else { 0 };
                let count = images(3, least, ImageMemory { bytes, remaining: Some(remaining) }).unwrap();
                remaining -= u64::from(count) * bytes;
                count
            })
            .collect();
        assert_eq!(counts, [3, 3, 3, 3, 3, 3, 3, 3, 6, 6]);
    }
}
