//! Octave bands of a picture, at full resolution: a Laplacian pyramid that is not decimated.
//!
//! Level i + 1 is level i smoothed by the binomial (1 4 6 4 1) / 16 with its taps 2^i pixels apart (Burt and Adelson 1983
//! with a = 0.375; "a trous", Holschneider et al. 1989), and band i is the difference of both. Edges are continued by
//! the outermost pixel. Without decimation a band is not displaced by where a change lies in the pixel grid, and where
//! nothing changed within its support it is exactly 0.

use parafovea_core::image::Plane;

/// Bands including the last, which is all that the others leave.
pub(crate) const BANDS: usize = 5;

/// Frequency of band i, cycles per pixel: the middle of the finest octave; the peaks of the next three; and half of the last peak for the
/// rest, which has all frequencies below.
pub(crate) const BAND_CYCLES_PER_PIXEL: [f32; BANDS] =
    [0.353_553, 0.140_495, 0.066_826, 0.033_032, 0.016_516];

/// Factor of each band with which a grating of its peak frequency keeps its amplitude: the second to fourth have cos^4(w/2) (1 - cos^4(w))
/// times the gain of the levels before.
pub(crate) const BAND_GAIN: [f32; BANDS] = [1.0, 1.786_84, 1.961_65, 2.004_93, 1.0];

/// Largest distance at which a change affects any band, pixels along each axis: 2 (1 + 2 + 4 + 8).
pub const BAND_SUPPORT_PX: u32 = 30;

/// Room for the computation, kept between pictures.
#[derive(Default)]
pub(crate) struct Bands {
    level: Plane,
    next: Plane,
    rows: Vec<f32>,
    padded: Vec<f32>,
}

impl Bands {
    /// Calls `take` with each band of `picture`, finest first.
    pub fn split(&mut self, picture: &Plane, mut take: impl FnMut(usize, &Plane)) {
        self.level.clone_from(picture);
        for band in 0..BANDS - 1 {
            self.smooth(1 << band);
            for (fine, coarse) in self.level.texels_mut().iter_mut().zip(self.next.texels()) {
                *fine -= coarse;
            }
            take(band, &self.level);
            std::mem::swap(&mut self.level, &mut self.next);
        }
        take(BANDS - 1, &self.level);
    }

    /// `picture` without its four finer bands: its local mean over some 20 pixels.
    pub fn mean(&mut self, picture: &Plane) -> &Plane {
        self.level.clone_from(picture);
        for band in 0..BANDS - 1 {
            self.smooth(1 << band);
            std::mem::swap(&mut self.level, &mut self.next);
        }
        &self.level
    }

    /// `next` becomes `level` smoothed with taps `step` pixels apart.
    fn smooth(&mut self, step: usize) {
        let (width, height) = (self.level.width() as usize, self.level.height() as usize);
        self.rows.resize(width * height, 0.0);
        self.padded.resize(width + 4 * step, 0.0);
        for (from, to) in self.level.texels().chunks_exact(width).zip(self.rows.chunks_exact_mut(width)) {
            self.padded[..2 * step].fill(from[0]);
            self.padded[2 * step..][..width].copy_from_slice(from);
            self.padded[2 * step + width..].fill(from[width - 1]);
            binomial(to, [0, 1, 2, 3, 4].map(|tap| &self.padded[tap * step..][..width]));
        }
        self.next.clone_from(&self.level);
        for (y, to) in self.next.texels_mut().chunks_exact_mut(width).enumerate() {
            let row = |tap: usize| (y + tap * step).saturating_sub(2 * step).min(height - 1);
            binomial(to, [0, 1, 2, 3, 4].map(|tap| &self.rows[row(tap) * width..][..width]));
        }
    }
}

fn binomial(to: &mut [f32], [a, b, c, d, e]: [&[f32]; 5]) {
    for (((((to, a), b), c), d), e) in to.iter_mut().zip(a).zip(b).zip(c).zip(d).zip(e) {
        *to = ((a + e) + 4.0 * (b + d) + 6.0 * c) / 16.0;
    }
}

#[cfg(test)]
mod tests;
