//! Squared error of stored values: sRGB codes, as the PSNR of images is customarily given.

use crate::errors::clip::Picture;
use parafovea_core::image::Plane;

/// Mean over the three channels of the squared difference, components in 0..=1.
pub(crate) fn map(reference: &Picture, test: &Picture) -> Plane {
    let [width, height] = reference.extent();
    let mut map = Plane::filled(width, height, 0.0);
    for ((value, a), b) in map.texels_mut().iter_mut().zip(reference.codes()).zip(test.codes()) {
        let squares = [0, 1, 2].map(|channel| u32::from(a[channel].abs_diff(b[channel])).pow(2));
        *value = squares.iter().sum::<u32>() as f32 / (3.0 * 255.0 * 255.0);
    }
    map
}
