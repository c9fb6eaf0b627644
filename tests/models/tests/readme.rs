//! Figures and images of `core/README.md` and `manifest/HOW-IT-WORKS.md` match the code.

#![expect(clippy::unwrap_used, reason = "a test says where it failed")]

use parafovea_core::image::Plane;
use parafovea_models::{debug_views, room};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// One value in a thousand may differ: on which side of a border a pixel lies may differ with the machine's last digit.
fn assert_shows(path: &Path, made: &Plane<[u8; 3]>, command: &str) {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut shown = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut shown).unwrap();
    let made = made.texels().as_flattened();
    assert_eq!(shown.len(), made.len());
    let differing = shown.iter().zip(made).filter(|(shown, made)| shown != made).count();
    let all = shown.len();
    assert!(
        differing * 1000 <= all,
        "{differing} of {all} values of {} differ; `cargo run -p parafovea-models --example {command}`",
        path.display()
    );
}

#[test]
fn the_picture_is_that_of_the_plan() {
    let made = room::plan().picture(room::PICTURE_WIDTH);
    assert_shows(&repository().join("core/plan.png"), &made, "plan_picture -- core/plan.png");
}

#[test]
fn the_pictures_are_those_of_the_debug_views() {
    let page = std::fs::read_to_string(repository().join("manifest/HOW-IT-WORKS.md")).unwrap();
    for (view, name) in debug_views::VIEWS {
        let file = format!("pictures/{name}.png");
        assert!(page.contains(&format!("({file})")), "the page does not show {file}");
        let path = repository().join("manifest").join(file);
        assert_shows(&path, &debug_views::picture(view), "debug_views -- manifest/pictures");
        assert!(std::fs::metadata(&path).unwrap().len() <= 60_000, "{} is too large", path.display());
    }
}
