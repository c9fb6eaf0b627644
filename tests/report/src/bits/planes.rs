//! Pictures as codecs take them: luma and two planes of chroma.

use parafovea_tests::picture::Picture;

/// Density of the chroma samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// One for 2 x 2 pixels.
    Half,
    /// One for each pixel.
    Full,
}

impl Sampling {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Half, Self::Full];

    /// As people write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Half => "4:2:0",
            Self::Full => "4:4:4",
        }
    }
}

/// Luma and chroma of BT.709, which headsets' streams use, with 8 bits over their whole range; as many samples of each as there
/// are pixels.
pub struct Planes {
    pub width: u32,
    pub height: u32,
    /// Y', Cb, Cr of each pixel.
    pub pixels: Vec<[u8; 3]>,
}

impl Planes {
    pub fn of(picture: &Picture) -> Self {
        let pixels = picture.pixels.iter().map(|&[r, g, b, _]| {
            let [r, g, b] = [r, g, b].map(f32::from);
            let luma = 0.2126 * r + 0.7152 * g + 0.0722 * b;
            // Cb and Cr are B' - Y' and R' - Y' over their own range.
            let chroma = [(b - luma) / 1.8556, (r - luma) / 1.5748].map(|chroma| chroma + 128.0);
            [luma, chroma[0], chroma[1]].map(|code| code.round().clamp(0.0, 255.0) as u8)
        });
        Self { width: picture.width, height: picture.height, pixels: pixels.collect() }
    }

    pub fn luma(&self) -> impl Iterator<Item = u8> + '_ {
        self.pixels.iter().map(|pixel| pixel[0])
    }

    /// Plane after plane, as raw video has them; without `colour` chroma is grey.
    pub fn raw(&self, sampling: Sampling, colour: bool) -> Vec<u8> {
        let mut bytes: Vec<u8> = self.luma().collect();
        let step = if sampling == Sampling::Half { 2 } else { 1 };
        for channel in [1, 2] {
            for y in (0..self.height).step_by(step) {
                for x in (0..self.width).step_by(step) {
                    bytes.push(if colour { self.mean([x, y], step as u32, channel) } else { 128 });
                }
            }
        }
        bytes
    }

    /// Mean of a channel over a square that begins at a pixel.
    fn mean(&self, [x, y]: [u32; 2], side: u32, channel: usize) -> u8 {
        let square = (y..(y + side).min(self.height))
            .flat_map(|y| (x..(x + side).min(self.width)).map(move |x| (x, y)));
        let codes = square.map(|(x, y)| u32::from(self.pixels[(y * self.width + x) as usize][channel]));
        let (sum, count) = codes.fold((0, 0), |(sum, count), code| (sum + code, count + 1));
        ((sum + count / 2) / count.max(1)) as u8
    }
}

/// Sum of the squared differences of codes.
pub fn squared_error(a: impl Iterator<Item = u8>, b: impl Iterator<Item = u8>) -> f64 {
    a.zip(b).map(|(a, b)| (f64::from(a) - f64::from(b)).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_has_no_chroma_and_raw_video_has_plane_after_plane() {
        let grey = Planes::of(&Picture::from_fn(2, 2, |x, _| [100 + x as u8; 4]));
        assert_eq!(grey.pixels, [[100, 128, 128], [101, 128, 128], [100, 128, 128], [101, 128, 128]]);
        // Red: luma .2126, and as far from it as Cr goes.
        let red = Planes::of(&Picture::from_fn(2, 2, |_, _| [255, 0, 0, 255]));
        assert_eq!(red.pixels[0], [54, 99, 255]);
        assert_eq!(red.raw(Sampling::Half, true), [54, 54, 54, 54, 99, 255]);
        assert_eq!(red.raw(Sampling::Full, false)[4..], [128; 8]);
    }
}
