//! Boxes with holes whose edges are anti-aliased by alpha to coverage.

use super::msaa_resolve;
use crate::scene::{FORWARD, Shaders};
use crate::shader;
use crate::style::Style;

pub const STYLE: Style = Style {
    name: "alpha-to-coverage",
    says: "four samples a pixel, holes in the boxes by alpha to coverage",
    direct: false,
    likeness: None,
    can_set_rates: true,
    passes: msaa_resolve::four_samples,
    start: |app| msaa_resolve::start(app, &HOLES, true),
    ..Style::PLAIN
};

const HOLES: Shaders = Shaders { boxes: [FORWARD.boxes[0], shader!("fragments", "coverage_fs")], ..FORWARD };
