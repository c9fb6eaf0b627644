use super::*;
use parafovea_core::chroma::{ChromaSettings, Mode, cb_gain, cr_gain};

/// The bounds of paper C that belong together, and the two that give the extremes: Z of Cb and of Cr.
const BOUNDS: [(f32, f32); 4] = [(0.70, 0.35), (0.85, 0.55), (0.70, 0.55), (0.85, 0.35)];

/// Paper B's image, on which areas depend: 1440 x 1600 with a focal length of 555 pixels.
const EXTENT: [u32; 2] = [1440, 1600];

fn paper((cb, cr): (f32, f32)) -> impl Fn(f32) -> Gains {
    move |e| Gains { cb: cb_gain(e, cb), cr: cr_gain(e, cr) }
}

fn close(found: f32, expected: f32, what: &str) {
    // As the table states them: three digits.
    assert!((found - expected).abs() < 6e-4, "{what}: {found}, not {expected}");
}

#[test]
fn along_a_line() {
    for (bounds, cb, cr, kept, reduction) in
        [(BOUNDS[0], 0.731, 0.207, 0.469, 0.531), (BOUNDS[1], 0.697, 0.324, 0.510, 0.490)]
    {
        let report = Report::of(paper(bounds));
        close(report.line.cb, cb, "Cb");
        close(report.line.cr, cr, "Cr");
        close(report.line.mean(), kept, "kept");
        close(report.line_reduction(), reduction, "reduction");
    }
    close(Report::of(paper(BOUNDS[2])).line_signal_saving(), 0.315, "least saving of the signal");
    close(Report::of(paper(BOUNDS[3])).line_signal_saving(), 0.365, "most saving of the signal");
}

#[test]
fn over_a_disc() {
    for (bounds, kept) in BOUNDS.into_iter().zip([0.337, 0.348, 0.3722, 0.3128]) {
        let report = Report::of(paper(bounds));
        close(report.disc.mean(), kept, "kept");
        assert!((report.disc.cb - 1.0 / (bounds.0 + 1.0)).abs() < 1e-5, "the closed form");
        close(report.disc_reduction(), 1.0 - kept, "reduction");
    }
}

#[test]
fn over_a_rectangle() {
    let sides = EXTENT.map(|side| side as f32);
    let [half_width, half_height] = sides.map(|side| side / 2.0);
    for (what, normaliser, kept) in [
        ("half diagonal", half_width.hypot(half_height), [0.437, 0.470]),
        ("half height", half_height, [0.291, 0.302]),
        ("half width", half_width, [0.238, 0.246]),
    ] {
        for (bounds, kept) in BOUNDS.into_iter().zip(kept) {
            close(rectangle_mean(sides, normaliser, paper(bounds)).mean(), kept, what);
        }
    }
}

#[test]
fn over_a_view() {
    let plane = ImagePlane { origin: Vec2::new(-720.0, 800.0) / 555.0, step: Vec2::new(1.0, -1.0) / 555.0 };
    for ((cb_bound, cr_bound), kept) in BOUNDS.into_iter().zip([0.222, 0.219]) {
        let settings = ChromaSettings { mode: Mode::Paper, cb_bound, cr_bound, ..ChromaSettings::default() };
        let found = view_mean(&plane, EXTENT, Vec3::NEG_Z, &Curves::new(&settings));
        close(found.mean(), kept, "planar angle over 55 degrees");
    }
    let default = Curves::new(&ChromaSettings::default());
    let found = view_mean(&plane, EXTENT, Vec3::NEG_Z, &default);
    assert!(found.cb > 0.9 && (0.3..0.5).contains(&found.cr), "{found:?}");
    assert_eq!(view_mean(&plane, EXTENT, Vec3::ZERO, &default), Gains::FULL);
}
