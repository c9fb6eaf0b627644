//! Bits of pictures with colour and with less of it.

use crate::HarnessError;
use crate::picture::Picture;
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use std::path::Path;

/// JPEG's usual quality for photographs.
const QUALITY: u8 = 80;

/// Bytes of a picture as a JPEG with half the colour resolution each way, as video has it.
///
/// # Errors
/// [`HarnessError::Format`] for pictures that JPEG cannot hold.
pub fn encoded_bytes(picture: &Picture) -> Result<usize, HarnessError> {
    let failed = |reason: String| HarnessError::format(Path::new("a picture as a JPEG"), reason);
    let side = |side: u32| u16::try_from(side).map_err(|error| failed(error.to_string()));
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, QUALITY);
    encoder.set_sampling_factor(SamplingFactor::F_2_2);
    let (width, height) = (side(picture.width)?, side(picture.height)?);
    let encoded = encoder.encode(picture.pixels.as_flattened(), width, height, ColorType::Rgba);
    encoded.map_err(|error| failed(error.to_string()))?;
    Ok(bytes.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_takes_fewer_bytes_than_colour() {
        let colour = |x: u32, y: u32| [(x * 7) as u8, (y * 11) as u8, ((x + y) * 5) as u8, 255];
        let grey = |x: u32, y: u32| {
            let [red, green, blue, alpha] = colour(x, y).map(u16::from);
            let mean = ((red + green + blue) / 3) as u8;
            [mean, mean, mean, alpha as u8]
        };
        let bytes = [Picture::from_fn(64, 64, colour), Picture::from_fn(64, 64, grey)]
            .map(|picture| encoded_bytes(&picture).unwrap());
        assert!(bytes[1] < bytes[0], "{bytes:?}");
    }
}
