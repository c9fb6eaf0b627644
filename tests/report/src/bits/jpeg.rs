//! JPEG: each component in a scan of its own, with Huffman tables made for it.

use super::planes::{Planes, Sampling, squared_error};
use super::{Encoded, Size};
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use zune_jpeg::JpegDecoder;

/// From small to fine.
pub const QUALITIES: [u8; 4] = [30, 50, 70, 90];

/// Encodes an image, and compares luma with the original's.
pub fn encode(planes: &Planes, sampling: Sampling, quality: u8) -> Result<Encoded, String> {
    let luma: Vec<u8> = planes.luma().collect();
    // Luma's scan is the same in both, as its tables are its own.
    let grey = bytes(&luma, planes, ColorType::Luma, sampling, quality)?;
    let all = bytes(planes.pixels.as_flattened(), planes, ColorType::Ycbcr, sampling, quality)?;
    let decoded = JpegDecoder::new(&grey).decode().map_err(|error| format!("JPEG: {error:?}"))?;
    Ok(Encoded {
        size: Size { total: 8 * all.len() as u64, luma: 8 * grey.len() as u64 },
        squared_error: squared_error(decoded.into_iter(), planes.luma()),
        pixels: planes.pixels.len() as u64,
    })
}

fn bytes(
    data: &[u8],
    planes: &Planes,
    colour: ColorType,
    sampling: Sampling,
    quality: u8,
) -> Result<Vec<u8>, String> {
    let [width, height] = [planes.width, planes.height].map(u16::try_from);
    let (Ok(width), Ok(height)) = (width, height) else {
        return Err("JPEG: a picture is too large".to_owned());
    };
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, quality);
    encoder.set_sampling_factor(match sampling {
        Sampling::Half => SamplingFactor::F_2_2,
        Sampling::Full => SamplingFactor::F_1_1,
    });
    encoder.set_optimized_huffman_tables(true);
    encoder.encode(data, width, height, colour).map_err(|error| format!("JPEG: {error}"))?;
    Ok(bytes)
}
