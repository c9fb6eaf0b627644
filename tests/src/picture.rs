//! Pictures as the mock runtime saves them: 8-bit RGBA, row by row from the top, as stored in the swapchain.

use crate::HarnessError;
use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::Path;

/// An 8-bit RGBA picture.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` pixels.
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    /// Computes each pixel from its column and row.
    pub fn from_fn(width: u32, height: u32, mut pixel: impl FnMut(u32, u32) -> [u8; 4]) -> Self {
        let pixels =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
        Self { width, height, pixels }
    }

    /// The pixel in column `x` of row `y`.
    pub fn at(&self, x: u32, y: u32) -> [u8; 4] {
        self.pixels[(y * self.width + x) as usize]
    }

    /// Every pixel with its column and row.
    pub fn enumerate(&self) -> impl Iterator<Item = (u32, u32, [u8; 4])> + '_ {
        (0_u32..).zip(&self.pixels).map(|(i, pixel)| (i % self.width, i / self.width, *pixel))
    }

    /// Half as wide and high, each pixel the mean of four code values; an odd last column or row is left out.
    pub fn halved(&self) -> Self {
        Self::from_fn(self.width / 2, self.height / 2, |x, y| {
            let four =
                [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, down)| self.at(2 * x + right, 2 * y + down));
            std::array::from_fn(|channel| {
                let sum: u16 = four.iter().map(|pixel| u16::from(pixel[channel])).sum();
                (sum / 4) as u8
            })
        })
    }

    /// This picture with another of the same height on its right.
    pub fn beside(&self, right: &Self) -> Self {
        assert_eq!(self.height, right.height, "pictures of one height fit beside each other");
        Self::from_fn(self.width + right.width, self.height, |x, y| {
            if x < self.width { self.at(x, y) } else { right.at(x - self.width, y) }
        })
    }

    /// Reads an 8-bit RGBA PNG.
    ///
    /// # Errors
    /// [`HarnessError::File`], or [`HarnessError::Format`] for anything but such a PNG.
    pub fn load(path: &Path) -> Result<Self, HarnessError> {
        let file = File::open(path).map_err(HarnessError::file(path))?;
        let format = |error| HarnessError::format(path, error);
        let mut reader = png::Decoder::new(BufReader::new(file)).read_info().map_err(format)?;
        let size = reader.output_buffer_size().ok_or_else(|| HarnessError::format(path, "too large"))?;
        let mut bytes = vec![0; size];
        let info = reader.next_frame(&mut bytes).map_err(format)?;
        if (info.color_type, info.bit_depth) != (png::ColorType::Rgba, png::BitDepth::Eight) {
            let found = format!("{:?} with {:?} bits, not RGBA with 8", info.color_type, info.bit_depth);
            return Err(HarnessError::format(path, found));
        }
        let pixels = bytes[..info.buffer_size()].as_chunks().0.to_vec();
        Ok(Self { width: info.width, height: info.height, pixels })
    }

    /// Writes a PNG.
    ///
    /// # Errors
    /// [`HarnessError::File`] or [`HarnessError::Format`].
    pub fn save(&self, path: &Path) -> Result<(), HarnessError> {
        let file = File::create(path).map_err(HarnessError::file(path))?;
        let mut encoder = png::Encoder::new(BufWriter::new(file), self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(|error| HarnessError::format(path, error))?;
        let bytes = self.pixels.as_flattened();
        writer.write_image_data(bytes).map_err(|error| HarnessError::format(path, error))
    }
}

impl std::fmt::Debug for Picture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Picture({} x {})", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_saved_picture_loads_as_it_was() {
        let picture = Picture::from_fn(3, 2, |x, y| [x as u8, y as u8, 200, 7]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        picture.save(&path).unwrap();
        assert_eq!(Picture::load(&path).unwrap(), picture);
        assert_eq!(picture.at(2, 1), [2, 1, 200, 7]);
    }

    #[test]
    fn halves_and_neighbours() {
        let picture = Picture::from_fn(5, 4, |x, y| [(10 * x) as u8, (100 * y) as u8 / 2, 8, 255]);
        let half = picture.halved();
        assert_eq!((half.width, half.height), (2, 2));
        assert_eq!(half.at(1, 0), [25, 25, 8, 255]);
        let both = half.beside(&half);
        assert_eq!((both.width, both.at(3, 0)), (4, half.at(1, 0)));
    }

    #[test]
    fn files_that_are_no_image_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text.png");
        std::fs::write(&path, "no picture").unwrap();
        assert!(Picture::load(&path).unwrap_err().to_string().contains("text.png"));
    }
}
