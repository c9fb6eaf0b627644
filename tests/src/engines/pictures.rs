//! Images that an engine submits, and their differences from images without the layer.

use crate::HarnessError;
use crate::picture::Picture;
use glam::Vec3;
use parafovea_core::geometry::Fov;
use parafovea_models::errors::{Clip, Eye, Frame, Metric, RING_NAMES, RINGS, Report, Viewing, judge};
use parafovea_test_layers::CapturedView;
use serde::Serialize;
use std::fs;
use std::path::Path;

/// Frames a second of engines' scenes, regardless of their real time: `--fixed-fps` of their command line.
const FRAMES_PER_SECOND: f64 = 60.0;

/// Gaze of engines' users: the centre of the view.
const AHEAD: Vec3 = Vec3::NEG_Z;

/// Differences between images with and without the layer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// Their subject.
    pub look: &'static str,
    /// Peak signal-to-noise ratio by ring around the gaze, named by degrees, dB; none for a ring outside the view, or without any difference.
    pub psnr_db: Vec<(&'static str, Option<f64>)>,
    /// Lost contrast that stays, likewise, in just noticeable differences; none for a ring outside the view.
    pub jnd: Vec<(&'static str, Option<f64>)>,
    /// Mean of the whole view, just noticeable differences, changes over time included.
    pub jnd_view: f64,
    /// Likewise, as detected: small losses far below one JND hardly count.
    pub jnd_detected: f64,
}

impl Errors {
    /// Of a clip with a look, from one without the layer.
    ///
    /// # Errors
    /// Clips that cannot be compared.
    pub fn of(look: &'static str, reference: &Clip, test: &Clip) -> Result<Self, String> {
        let viewing = Viewing { refresh_hz: FRAMES_PER_SECOND as f32, ..Viewing::default() };
        let report = judge(reference, test, &viewing).map_err(|error| error.to_string())?;
        let by_ring = |metric, value: fn(f64) -> Option<f64>| {
            let ring = |ring| report.row(metric, ring).mean.and_then(value);
            (0..RINGS).map(|index| (RING_NAMES[index], ring(index))).collect()
        };
        let psnr = |squared: f64| (squared > 0.0).then(|| -10.0 * squared.log10());
        Ok(Self {
            look,
            psnr_db: by_ring(Metric::Squared, psnr),
            jnd: by_ring(Metric::Sustained, Some),
            jnd_view: mean(&report, Report::loss_by_frame),
            jnd_detected: mean(&report, Report::detected_loss_by_frame),
        })
    }
}

fn mean(report: &Report, values: fn(&Report) -> Vec<f64>) -> f64 {
    let values = values(report);
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The frames that were saved to a folder, by their numbers from 0 on.
///
/// # Errors
/// A frame that is missing, or is not an image.
pub fn clip(folder: &Path, frames: u32) -> Result<Clip, HarnessError> {
    let frames = (0..frames).map(|number| frame(folder, number)).collect::<Result<_, _>>()?;
    Ok(Clip { frames })
}

fn frame(folder: &Path, number: u32) -> Result<Frame, HarnessError> {
    let path = folder.join(format!("{number}.json"));
    let text = fs::read_to_string(&path).map_err(HarnessError::file(&path))?;
    let views: Vec<CapturedView> =
        serde_json::from_str(&text).map_err(|error| HarnessError::format(&path, error))?;
    let eye = |index: usize| -> Result<Option<Eye>, HarnessError> {
        let Some(view) = views.get(index) else { return Ok(None) };
        let picture = Picture::load(&folder.join(format!("{number}-{index}.png")))?;
        let [left, right, up, down] = view.fov;
        let codes =
            parafovea_models::errors::Picture::from_srgb8(picture.width, picture.height, &picture.pixels);
        let fov = Fov { left, right, up, down };
        Ok(codes.map(|picture| Eye { picture, fov, gaze: AHEAD, age: None }))
    };
    Ok(Frame { time_s: f64::from(number) / FRAMES_PER_SECOND, eyes: [eye(0)?, eye(1)?] })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn save(folder: &Path, code: impl Fn(u32, u32) -> u8) {
        let view = CapturedView { fov: [-0.7, 0.7, 0.7, -0.7], position: [0.0; 3], orientation: [0.0; 4] };
        for number in 0..2 {
            for eye in 0..2 {
                let picture = Picture::from_fn(64, 64, |x, y| [code(x, y), 90, 90, 255]);
                picture.save(&folder.join(format!("{number}-{eye}.png"))).unwrap();
            }
            let views = serde_json::to_string(&[view, view]).unwrap();
            fs::write(folder.join(format!("{number}.json")), views).unwrap();
        }
    }

    #[test]
    fn saved_frames_are_compared_around_the_gaze() {
        let folder = tempfile::tempdir().unwrap();
        let stripes = |x: u32| if (x / 2).is_multiple_of(2) { 60 } else { 200 };
        save(folder.path(), |x, _| stripes(x));
        let off = clip(folder.path(), 2).unwrap();
        let same = Errors::of("on", &off, &off).unwrap();
        assert_eq!((same.jnd_view, same.psnr_db[0].1), (0.0, None));
        // The upper edge is flat.
        save(folder.path(), |x, y| if y < 8 { 120 } else { stripes(x) });
        let on = Errors::of("on", &off, &clip(folder.path(), 2).unwrap()).unwrap();
        assert_eq!(on.psnr_db[0], ("0-2", None), "the gaze is ahead, in the middle");
        let [outer, inner] = [5, 1].map(|ring| on.jnd[ring].1.unwrap());
        assert!(outer > inner && on.psnr_db[5].1.unwrap() < 40.0, "{on:?}");
        assert!(clip(folder.path(), 3).is_err());
    }
}
