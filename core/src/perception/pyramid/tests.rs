use super::*;
use proptest::prelude::*;

fn pyramid(picture: &Plane) -> Pyramid {
    let mut pyramid = Pyramid::default();
    pyramid.build(picture);
    pyramid
}

#[test]
fn levels_halve_rounded_up() {
    let pyramid = pyramid(&Plane::filled(37, 3, 1.0));
    let sizes: Vec<_> =
        (1..=LEVELS).map(|level| pyramid.level(level)).map(|l| (l.width(), l.height())).collect();
    assert_eq!(sizes, [(19, 2), (10, 1), (5, 1), (3, 1), (2, 1)]);
}

#[test]
fn a_point_spreads_as_the_filter() {
    let picture = Plane::from_fn(16, 16, |x, y| if (x, y) == (8, 8) { 256.0 } else { 0.0 });
    let level = pyramid(&picture).level(1).clone();
    // (1, 6, 1) / 16 of every second texel, in both directions.
    assert_eq!(level.row(4)[2..7], [0.0, 6.0, 36.0, 6.0, 0.0]);
    assert_eq!(level.row(3)[2..7], [0.0, 1.0, 6.0, 1.0, 0.0]);
    assert_eq!(level.row(2)[2..7], [0.0; 5]);
}

#[test]
fn ramps_stay_ramps_away_from_the_edge() {
    let picture = Plane::from_fn(64, 64, |x, y| (x + 3 * y) as f32);
    let pyramid = pyramid(&picture);
    let (mut out, mut row) = ([0.0; 64], Vec::new());
    for y in 16..48 {
        expand_row(pyramid.level(1), y, &mut out, &mut row);
        assert_eq!(out[8..56], picture.row(y)[8..56]);
        upsampled_row(pyramid.level(2), y, &mut out, &mut row);
        assert_eq!(out[8..56], picture.row(y)[8..56]);
    }
}

proptest! {
    #[test]
    fn level_pictures_stay_level(width in 1u32..70, height in 1u32..70, value in 0.0..1e4f32) {
        let picture = Plane::filled(width, height, value);
        let pyramid = pyramid(&picture);
        for level in 1..=LEVELS {
            prop_assert!(pyramid.level(level).texels().iter().all(|texel| *texel == value));
        }
        let (mut out, mut row) = (vec![0.0; width as usize], Vec::new());
        for y in 0..height {
            expand_row(pyramid.level(1), y, &mut out, &mut row);
            prop_assert!(out.iter().all(|texel| *texel == value));
            upsampled_row(pyramid.level(2), y, &mut out, &mut row);
            prop_assert!(out.iter().all(|texel| *texel == value));
        }
    }

    #[test]
    fn within_the_range_of_the_picture(
        width in 1u32..40, texels in prop::collection::vec(0.0..1e4f32, 1..900),
    ) {
        let height = texels.len() as u32 / width;
        let picture = Plane::from_fn(width, height, |x, y| texels[(y * width + x) as usize]);
        let (least, most) = texels.iter().fold((f32::MAX, 0.0f32), |(a, b), t| (a.min(*t), b.max(*t)));
        let pyramid = pyramid(&picture);
        for level in 1..=LEVELS {
            let within = pyramid.level(level).texels().iter().all(|t| (least * 0.9999 - 1e-3..=most * 1.0001).contains(t));
            prop_assert!(within);
        }
    }
}
