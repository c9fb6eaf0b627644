//! What `core/README.md` shows is what the code makes.

use parafovea_models::room;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

#[test]
fn the_picture_is_that_of_the_plan() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../core/plan.png");
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut shown = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut shown).unwrap();
    let made = room::plan().picture(room::PICTURE_WIDTH);
    let made = made.texels().as_flattened();
    assert_eq!(shown.len(), made.len());
    let differing = shown.iter().zip(made).filter(|(shown, made)| shown != made).count();
    // One in a thousand: on which side of a border a pixel lies may differ with the machine's last digit.
    assert!(
        differing * 1000 <= shown.len(),
        "{differing} of {} values differ; `cargo run -p parafovea-models --example plan_picture -- core/plan.png`",
        shown.len()
    );
}
