//! Images whose periphery is re-used as in paper B, against the application's images.

use parafovea_tests::picture::Picture;
use parafovea_zoo::{History, Style};

/// Frames of the longest period.
pub const PERIOD: u64 = 3;

/// Every pixel is shaded when its turn comes, and all of a region has its turn in one frame.
pub const AS_PUBLISHED: &str = "[gaze]\nsource = \"centre\"\n[rates]\nmode = \"off\"\ngate = \"on\"\n[chroma]\nmode = \"off\"\n\
    [reuse]\nmode = \"paper\"\nperiods = \"11223\"\n";

/// Allowed mean difference of images that another pass reads before they are shown, code values: filters spread coarsely shaded texels over
/// a tile's edge, and move re-used ones.
const READ_LIMIT: f64 = 1.5;

/// Side of a tile, pixels.
const TILE: u32 = 16;

/// Allowed mean difference of a tile of a style that blends its pictures with earlier ones, code values: re-use is off there, and its
/// earlier traces have faded.
const TILE_LIMIT: f64 = 1.0;

/// Asserts that the log gives the style's [`History`].
pub fn check_history(style: &Style, log: &str) {
    let says = |line: &str| log.contains(&format!("re-use: off, because {line}"));
    let said = match (says("a pass reads images of earlier frames"), says("a pass after the scene may read"))
    {
        (true, _) => History::Blended,
        (false, true) => History::Unknown,
        (false, false) => History::None,
    };
    assert_eq!(said, style.history, "{log}");
}

/// Asserts that an image is made of the application's images, given the newest first.
pub fn compare(style: &Style, eye: usize, on: &Picture, off: &[Picture]) {
    if style.history == History::Blended {
        return compare_tiles(eye, on, &off[0]);
    }
    let of_one_size = off.iter().all(|off| (off.width, off.height) == (on.width, on.height));
    if !style.direct || !of_one_size {
        // Auto-exposure spreads the effect of coarse shading over the image: only the mean brightness counts there.
        let is_alike = of_one_size && style.global.is_none();
        let by = if is_alike { difference(on, &off[0]) } else { (mean(on) - mean(&off[0])).abs() };
        // With dynamic resolution each frame differs from the next, and a picture of several frames from all of them.
        let own = off.iter().map(|other| difference(other, &off[0])).fold(0.0, f64::max);
        let limit = if is_alike { READ_LIMIT.max(own) } else { READ_LIMIT };
        println!("eye {eye}: {by:.2} code values off");
        assert!(by < limit, "eye {eye}: {by} off");
        return;
    }
    let mut older = 0;
    for (x, y, is) in on.enumerate() {
        let is_of = |off: &&Picture| is.iter().zip(off.at(x, y)).all(|(is, was)| is.abs_diff(was) <= 1);
        let age = off.iter().position(|off| is_of(&off));
        assert!(age.is_some(), "eye {eye}, {x}, {y}: {is:?} was never drawn there");
        older += usize::from(age > Some(0));
    }
    println!("eye {eye}: {older} pixels are not of this frame");
    assert!(older > 0, "eye {eye}: nothing was re-used");
}

/// Compares tile by tile with the application's image.
fn compare_tiles(eye: usize, on: &Picture, off: &Picture) {
    let [columns, rows] = [on.width, on.height].map(|side| side.div_ceil(TILE));
    let mut most = (0.0, [0; 2]);
    for tile in (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y])) {
        let [x, y] = tile.map(|at| at * TILE..(at + 1) * TILE);
        let (mut sum, mut count) = (0.0, 0.0);
        for (_, _, was, is) in off
            .enumerate()
            .filter(|(at_x, at_y, _)| x.contains(at_x) && y.contains(at_y))
            .map(|(x, y, was)| (x, y, was, on.at(x, y)))
        {
            sum += (0..3).map(|channel| f64::from(is[channel].abs_diff(was[channel]))).sum::<f64>() / 3.0;
            count += 1.0;
        }
        if sum / count > most.0 {
            most = (sum / count, tile);
        }
    }
    let (by, tile) = most;
    println!("eye {eye}: {by:.2} code values off in tile {tile:?}, {:.2} in the mean", difference(on, off));
    assert!(by <= TILE_LIMIT, "eye {eye}, tile {tile:?}: {by} off");
}

/// The mean over all pixels and colour channels, code values.
fn difference(a: &Picture, b: &Picture) -> f64 {
    let of_pixel = |(a, b): (&[u8; 4], &[u8; 4])| -> f64 {
        (0..3).map(|channel| f64::from(a[channel].abs_diff(b[channel]))).sum()
    };
    a.pixels.iter().zip(&b.pixels).map(of_pixel).sum::<f64>() / a.pixels.len() as f64 / 3.0
}

/// Over all pixels and colour channels.
pub fn mean(picture: &Picture) -> f64 {
    let sum: f64 = picture
        .pixels
        .iter()
        .map(|pixel| pixel[..3].iter().map(|&value| f64::from(value)).sum::<f64>())
        .sum();
    sum / picture.pixels.len() as f64 / 3.0
}
