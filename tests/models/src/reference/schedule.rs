//! Paper B's pixel rate.

/// P = (1 / a) sum of a_i / f_i.
pub fn pixel_rate(areas: [f64; 5], factors: [u8; 5]) -> f64 {
    let total: f64 = areas.iter().sum();
    (0..5).map(|i| areas[i] / f64::from(factors[i])).sum::<f64>() / total
}

/// Pixels of each region in an image of `width` x `height`, whose upper edge is seen at `half_fov_deg`, with the
/// gaze at its centre: there the regions are circles of r = f tan e pixels.
pub fn region_counts(width: u32, height: u32, half_fov_deg: f64, radii_deg: [f64; 4]) -> [u64; 5] {
    let focal = f64::from(height) / 2.0 / half_fov_deg.to_radians().tan();
    let mut counts = [0; 5];
    for y in 0..height {
        for x in 0..width {
            let from_centre = |pixel: u32, side: u32| f64::from(pixel) + 0.5 - f64::from(side) / 2.0;
            let radius = from_centre(x, width).hypot(from_centre(y, height));
            let eccentricity_deg = (radius / focal).atan().to_degrees();
            counts[radii_deg.iter().filter(|&&outer| eccentricity_deg > outer).count()] += 1;
        }
    }
    counts
}
