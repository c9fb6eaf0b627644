//! The images of a report: an eye's view with each technique, and the map beside it.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use parafovea_tests::picture::Picture;
use std::io;
use std::path::{Path, PathBuf};

/// Pixels of a side in the report, at most.
const SIDE: u32 = 256;

/// A folder with pictures, by scene and technique.
pub struct Pictures {
    folder: PathBuf,
}

impl Pictures {
    /// Images in a folder, which is created if it is missing.
    ///
    /// # Errors
    /// The folder cannot be created.
    pub fn new(folder: &Path) -> io::Result<Self> {
        std::fs::create_dir_all(folder)?;
        Ok(Self { folder: folder.to_owned() })
    }

    /// Keeps an eye's view, and the map of its pass if there is one. An image that cannot be written is left out of the report, with a
    /// line about it.
    pub fn keep(&mut self, scene: &str, technique: &str, seen: &Picture, map: Option<&Picture>) {
        let mut small = seen.clone();
        while small.width > SIDE && small.height > 1 {
            small = small.halved();
        }
        let pictures = [("seen", Some(small)), ("map", map.map(|map| enlarged(map, seen)))];
        for (kind, picture) in pictures {
            let path = self.path(scene, technique, kind);
            // One of an earlier report would be shown.
            let _ = std::fs::remove_file(&path);
            if let Some(Err(error)) = picture.map(|picture| picture.save(&path)) {
                eprintln!("{error}");
            }
        }
    }

    fn path(&self, scene: &str, technique: &str, kind: &str) -> PathBuf {
        self.folder.join(format!("{scene}-{}-{kind}.png", technique.replace([' ', '.', '/'], "-")))
    }

    /// An eye's view, or the map (`seen` or `map`), as a data URI; `None` if there is no such image.
    pub fn data_uri(&self, scene: &str, technique: &str, kind: &str) -> Option<String> {
        let bytes = std::fs::read(self.path(scene, technique, kind)).ok()?;
        Some(format!("data:image/png;base64,{}", STANDARD.encode(bytes)))
    }
}

/// A map as large as an image of the report, each tile at its place in the `seen` image.
fn enlarged(map: &Picture, seen: &Picture) -> Picture {
    let height = (SIDE * seen.height / seen.width.max(1)).max(1);
    Picture::from_fn(SIDE, height, |x, y| map.at(x * map.width / SIDE, y * map.height / height))
}
