//! Saving of chroma attenuation in encoded images: bits at equal quality of luma, which it leaves unchanged.

mod h264;
mod jpeg;
mod planes;

use crate::results::Bits;
use crate::statistics::{RatePoint, bd_rate};
use parafovea_tests::HarnessError;
use parafovea_tests::picture::Picture;
use parafovea_tests::run::Outcome;
use parafovea_tests::scenario::Scenario;
use planes::Planes;

pub use planes::Sampling;

/// Of the pictures of a clip, every so manieth is encoded as a JPEG.
const JPEG_STEP: usize = 10;

/// Sizes of encoded pictures, bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Size {
    /// Of all.
    total: u64,
    /// Without colour.
    luma: u64,
}

/// One picture or clip, encoded at one setting.
struct Encoded {
    size: Size,
    /// Sum of the squared differences of the decoded luma codes from the encoder's input.
    squared_error: f64,
    pixels: u64,
}

/// Encodes images of two runs, without and with the technique, by JPEG, and by H.264 if the system has ffmpeg with libx264.
///
/// Quality is the fidelity of luma through the encoder: each run is compared with its own images. Codes of luma are not light:
/// less colour of the same luminance has other codes, which is not a loss. The errors measure the visible loss.
///
/// # Errors
/// [`HarnessError::File`] where a picture was not saved, [`HarnessError::Application`] where an encoder fails.
pub fn measure(
    technique: &str,
    reference: &Outcome,
    test: &Outcome,
    scenario: &Scenario,
) -> Result<Vec<Bits>, HarnessError> {
    let frames = &scenario.output.save_frames;
    let load = |outcome: &Outcome,
                eyes: std::ops::Range<usize>,
                step: usize|
     -> Result<Vec<Picture>, HarnessError> {
        let pictures =
            frames.iter().step_by(step).flat_map(|&frame| eyes.clone().map(move |eye| (eye, frame)));
        pictures.map(|(eye, frame)| outcome.eye(eye, frame)).collect()
    };
    let stills = [load(reference, 0..2, JPEG_STEP)?, load(test, 0..2, JPEG_STEP)?];
    let mut all = Vec::new();
    for sampling in Sampling::ALL {
        let encoded = |quality: u8, pictures: &[Picture]| -> Result<Encoded, String> {
            let each = pictures.iter().map(|picture| jpeg::encode(&Planes::of(picture), sampling, quality));
            each.reduce(|sum, next| Ok(sum?.and(next?))).unwrap_or_else(|| Err("no pictures".to_owned()))
        };
        all.push(bits(technique, &format!("JPEG {}", sampling.name()), jpeg::QUALITIES, &stills, encoded));
    }
    if h264::is_there() {
        let clips = [load(reference, 0..1, 1)?, load(test, 0..1, 1)?];
        for sampling in Sampling::ALL {
            let encoded = |quality: u8, pictures: &[Picture]| h264::encode(pictures, sampling, quality);
            all.push(bits(
                technique,
                &format!("H.264 {}", sampling.name()),
                h264::QUANTISERS,
                &clips,
                encoded,
            ));
        }
    }
    all.into_iter().collect::<Result<_, String>>().map_err(|reason| test.failed(&reason))
}

fn bits(
    technique: &str,
    codec: &str,
    settings: [u8; 4],
    [reference, test]: &[Vec<Picture>; 2],
    encoded: impl Fn(u8, &[Picture]) -> Result<Encoded, String>,
) -> Result<Bits, String> {
    let curve = |pictures: &[Picture]| -> Result<[[RatePoint; 4]; 2], String> {
        let mut points = [[RatePoint { bits: 0.0, psnr_db: 0.0 }; 4]; 2];
        for (index, setting) in settings.into_iter().enumerate() {
            let encoded = encoded(setting, pictures)?;
            let psnr_db = encoded.psnr_db();
            let Size { total, luma } = encoded.size;
            points[0][index] = RatePoint { bits: total as f64, psnr_db };
            points[1][index] = RatePoint { bits: total.saturating_sub(luma) as f64, psnr_db };
        }
        Ok(points)
    };
    let (reference, test) = (curve(reference)?, curve(test)?);
    let saved = |kind: usize| {
        bd_rate(&reference[kind], &test[kind]).map_err(|error| format!("{codec}: no BD-rate: {error}"))
    };
    Ok(Bits {
        technique: technique.to_owned(),
        codec: codec.to_owned(),
        total: saved(0)?,
        chroma: saved(1)?,
        curves: [reference[0].to_vec(), test[0].to_vec()],
    })
}

impl Encoded {
    fn and(self, other: Self) -> Self {
        let (a, b) = (self.size, other.size);
        Self {
            size: Size { total: a.total + b.total, luma: a.luma + b.luma },
            squared_error: self.squared_error + other.squared_error,
            pixels: self.pixels + other.pixels,
        }
    }

    /// Peak signal-to-noise ratio of luma, decibels.
    fn psnr_db(&self) -> f64 {
        10.0 * (255.0 * 255.0 * self.pixels as f64 / self.squared_error).log10()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coloured noise over a ramp, as saturated as asked for.
    fn picture(saturation: f32) -> Picture {
        let mut random = fastrand::Rng::with_seed(5);
        Picture::from_fn(96, 64, |x, y| {
            let grey = 60.0 + x as f32 + y as f32 * 0.5;
            let colour: [f32; 3] = std::array::from_fn(|_| saturation * (random.f32() - 0.5) * 80.0);
            // The added colour has no luma of BT.709.
            let luma = 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2];
            let [r, g, b] = colour.map(|channel| (grey + channel - luma).round() as u8);
            [r, g, b, 255]
        })
    }

    fn saved(saturation: f32) -> [Bits; 2] {
        let pictures = [vec![picture(1.0)], vec![picture(saturation)]];
        Sampling::ALL.map(|sampling| {
            let encoded =
                |quality: u8, test: &[Picture]| jpeg::encode(&Planes::of(&test[0]), sampling, quality);
            bits("chroma", "JPEG", jpeg::QUALITIES, &pictures, encoded).unwrap()
        })
    }

    #[test]
    fn less_colour_takes_fewer_bits_of_chroma_and_of_all() {
        for bits in saved(0.3) {
            assert!(bits.chroma < -0.3, "{bits:?}");
            assert!(bits.total < -0.05 && bits.total > bits.chroma, "{bits:?}");
        }
        for bits in saved(1.0) {
            assert_eq!((bits.total, bits.chroma), (0.0, 0.0));
        }
    }

    /// Luma codes that differ between the runs are not a loss of the encoder.
    #[test]
    fn another_luma_is_no_loss() {
        let brighter = |picture: &Picture| {
            Picture::from_fn(96, 64, |x, y| {
                let [r, g, b, a] = picture.at(x, y);
                [r + 8, g + 8, b + 8, a]
            })
        };
        let pictures = [vec![picture(0.3)], vec![brighter(&picture(0.3))]];
        for sampling in Sampling::ALL {
            let encoded =
                |quality: u8, test: &[Picture]| jpeg::encode(&Planes::of(&test[0]), sampling, quality);
            let bits = bits("brighter", "JPEG", jpeg::QUALITIES, &pictures, encoded).unwrap();
            assert!(bits.total.abs() < 0.02 && bits.chroma.abs() < 0.02, "{bits:?}");
        }
    }

    #[test]
    fn luma_is_what_its_own_picture_takes() {
        let planes = Planes::of(&picture(1.0));
        let [half, full] = Sampling::ALL.map(|sampling| jpeg::encode(&planes, sampling, 70).unwrap());
        assert_eq!(half.size.luma, full.size.luma);
        assert!(half.size.total > half.size.luma && full.size.total > half.size.total);
        // The same codes of luma are decoded.
        assert_eq!(half.squared_error, full.squared_error);
        assert!((25.0..60.0).contains(&half.psnr_db()), "{}", half.psnr_db());
    }
}
