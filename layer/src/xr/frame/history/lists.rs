//! Tiles that an eye buffer takes from earlier ones, and tiles that are compared with them.

use super::CompletionSettings;
use crate::planner::Watched;
use glam::Vec2;
use parafovea_core::geometry::ImagePlane;
use parafovea_core::reuse::{ComparedTiles, Picture, Reuse, TileLists};

/// The tiles of the newest eye buffer of an eye, by their treatment.
#[derive(Debug, Default)]
pub(super) struct EyeLists {
    /// Tiles by their source; empty if the picture is whole.
    pub(super) lists: TileLists,
    /// Tiles that are compared with earlier pictures.
    pub(super) compared: ComparedTiles,
}

impl EyeLists {
    /// Sorts the tiles of the first of `pictures`, which come newest first. Compared tiles are rendered tiles with a watched middle; there
    /// are none if `settings` do not turn pictures.
    pub(super) fn update<'a>(
        &mut self,
        pictures: impl Iterator<Item = Picture<'a>> + Clone,
        settings: CompletionSettings,
        watched: Option<&Watched>,
    ) {
        match reuse(pictures.clone(), settings) {
            Some(reuse) => self.lists.update(&reuse, settings.border_of(&reuse), settings.oldest),
            None => self.lists.clear(),
        }
        self.compared.clear();
        let mut pictures = pictures;
        if let (Some(newest), Some(watched), true) = (pictures.next(), watched, settings.turns) {
            let reuse = Reuse::new(newest, pictures, settings.turns);
            let plane = of_tiles(&reuse);
            self.compared.update(&reuse, settings.oldest, |[column, row]| {
                watched.is_watched(plane.direction(Vec2::new(column as f32, row as f32) + 0.5))
            });
        }
    }
}

/// The image of a picture, one of tiles in place of pixels.
pub(super) fn of_tiles(reuse: &Reuse) -> ImagePlane {
    let now = reuse.now();
    ImagePlane { step: now.view.plane.step / now.tiles_per_pixel(), ..now.view.plane }
}

/// Of pictures, the newest first, where something of that is stale.
pub(super) fn reuse<'a>(
    mut pictures: impl Iterator<Item = Picture<'a>>,
    settings: CompletionSettings,
) -> Option<Reuse<'a>> {
    let newest = pictures.next()?;
    (!newest.stale.is_empty()).then(|| Reuse::new(newest, pictures, settings.turns))
}
