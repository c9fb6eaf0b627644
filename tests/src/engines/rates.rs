//! The look that a device with shading rates would give to an engine's pictures, with the map that the layer plans for them.
//!
//! No CPU device has rates, and the layer of tests that stands in for them draws everything in full. So pictures of the engine alone are
//! shown at the rates of the map, as `cargo dev report` does ([`parafovea_models::errors::Picture::shaded_at`]).

use glam::{Quat, Vec3};
use parafovea::config::{Config, GazeSource, Preset};
use parafovea::link::{BACKEND_RATE_ATTACHMENT, CapabilitiesRecord};
use parafovea::planner::{Capabilities, SessionPlanner, ShownView, View};
use parafovea_core::rate::{ShadingRate, VULKAN_RATES};
use parafovea_models::errors::{Clip, Eye};

/// Size of a tile, pixels: that of most devices.
const TEXEL: u32 = 16;

/// The same clip as such a device would show it with a preset: gaze at the centre of the view, every frame with the map of the
/// first one. None if that frame lacks an eye, or nothing is planned for its eyes.
pub fn shown_at_rates(reference: &Clip, preset: Preset) -> Option<Clip> {
    let [left, right] = &reference.frames.first()?.eyes;
    let maps = maps([left.as_ref()?, right.as_ref()?], preset)?;
    let mut clip = reference.clone();
    for frame in &mut clip.frames {
        for (eye, map) in frame.eyes.iter_mut().zip(&maps) {
            if let Some(eye) = eye {
                eye.picture = eye.picture.shaded_at(|x, y| map.at(x, y));
            }
        }
    }
    Some(clip)
}

/// Rates of one eye's tiles, row by row.
struct Map {
    texel: [u32; 2],
    columns: u32,
    rates: Vec<u8>,
}

impl Map {
    fn at(&self, x: u32, y: u32) -> ShadingRate {
        let [width, height] = self.texel;
        let tile = (y / height * self.columns + x / width) as usize;
        let rate = self.rates.get(tile).and_then(|texel| ShadingRate::from_texel(*texel));
        rate.unwrap_or(ShadingRate::R1X1)
    }
}

fn maps(eyes: [&Eye; 2], preset: Preset) -> Option<[Map; 2]> {
    let mut config = Config::of_preset(preset);
    config.gaze.source = GazeSource::Centre;
    let mut offer = CapabilitiesRecord {
        backend: BACKEND_RATE_ATTACHMENT,
        texel: [TEXEL; 2],
        rate_count: VULKAN_RATES.len() as u32,
        rates: [0; 16],
        is_cpu: 1,
    };
    for (texel, rate) in offer.rates.iter_mut().zip(VULKAN_RATES) {
        *texel = rate.texel();
    }
    let views = eyes.map(|eye| View { position: Vec3::ZERO, orientation: Quat::IDENTITY, fov: eye.fov });
    let extents = eyes.map(|eye| eye.picture.extent());
    let mut planner = SessionPlanner::new(Capabilities::from(&offer));
    planner.views.located(&views);
    planner
        .views
        .shown(Some(1), &[0, 1].map(|index: usize| ShownView { view: views[index], extent: extents[index] }));
    planner.frame_begins(0, 1);
    if !planner.plan(&config, false, Quat::IDENTITY, 0) {
        return None;
    }
    let record = planner.new_rates(&config, || 1)?;
    let map = |index: usize| {
        let eye = &record.eyes[index];
        let count = (eye.tiles[0] * eye.tiles[1]) as usize;
        // SAFETY: the record has a rate for each tile until `planner` is used again.
        let rates = unsafe { std::slice::from_raw_parts(eye.rates, count) }.to_vec();
        Map { texel: eye.texel, columns: eye.tiles[0], rates }
    };
    Some([map(0), map(1)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_core::geometry::Fov;
    use parafovea_models::errors::{Frame, Picture};

    /// Stripes of one pixel, of which a block of several shows the mean.
    #[test]
    fn stripes_stay_where_the_gaze_is_and_fade_at_the_edge() {
        let fov = Fov { left: -0.7, right: 0.7, up: 0.7, down: -0.7 };
        let stripes: Vec<[u8; 4]> =
            (0..256 * 256).map(|index| if index % 2 == 0 { [0, 0, 0, 255] } else { [255; 4] }).collect();
        let picture = Picture::from_srgb8(256, 256, &stripes).unwrap();
        let eye = Eye { picture, fov, gaze: Vec3::NEG_Z, age: None };
        let frame = Frame { time_s: 0.0, eyes: [Some(eye.clone()), Some(eye)] };
        let clip = Clip { frames: vec![frame] };
        let shown = shown_at_rates(&clip, Preset::Balanced).unwrap();
        let picture = &shown.frames[0].eyes[0].as_ref().unwrap().picture;
        let at = |x: usize, y: usize| picture.codes()[y * 256 + x];
        assert_ne!(at(128, 128), at(129, 128), "1x1 ahead");
        assert_eq!(at(0, 128), at(1, 128), "coarse at the edge");
        assert!(shown_at_rates(&Clip::default(), Preset::Balanced).is_none());
    }
}
