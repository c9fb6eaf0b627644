//! ꟻLIP (Andersson et al. 2020) by NVIDIA's own code.

use crate::errors::clip::Picture;
use nv_flip::FlipImageRgb8;
use parafovea_core::image::Plane;

/// ꟻLIP's error at each pixel, 0..=1.
pub(crate) fn map(reference: &Picture, test: &Picture, pixels_per_degree: f32) -> Plane {
    let [width, height] = reference.extent();
    let image = |picture: &Picture| FlipImageRgb8::with_data(width, height, picture.codes().as_flattened());
    let errors = nv_flip::flip(image(reference), image(test), pixels_per_degree).to_vec();
    let mut map = Plane::filled(width, height, 0.0);
    map.texels_mut().copy_from_slice(&errors);
    map
}
