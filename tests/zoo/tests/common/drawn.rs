//! Pictures whose periphery is re-used as paper B does it, against those that the application draws.

use parafovea_tests::picture::Picture;
use parafovea_zoo::Style;

/// Frames of the longest period.
pub const PERIOD: u64 = 3;

/// Every pixel is shaded when its turn comes, and all of a region has its turn in one frame.
pub const AS_PUBLISHED: &str = "[gaze]\nsource = \"centre\"\n[rates]\nmode = \"off\"\ngate = \"on\"\n[chroma]\nmode = \"off\"\n\
    [reuse]\nmode = \"paper\"\nperiods = \"11223\"\n";

/// Allowed mean difference of images that another pass reads before they are shown, code values: filters spread coarsely shaded texels over
/// a tile's edge, and move re-used ones.
const READ_LIMIT: f64 = 1.5;

/// Whether a picture is made of those that the application drew, the newest first.
pub fn compare(style: &Style, eye: usize, on: &Picture, off: &[Picture]) {
    let of_one_size = off.iter().all(|off| (off.width, off.height) == (on.width, on.height));
    if !style.direct || !of_one_size {
        // Exposure and temporal filters carry what was coarse on, far and long: there only how light it is counts.
        let is_alike = of_one_size && style.global.is_none() && !style.keeps_history;
        let by = if is_alike { difference(on, &off[0]) } else { (mean(on) - mean(&off[0])).abs() };
        println!("eye {eye}: {by:.2} code values off");
        assert!(by < READ_LIMIT, "eye {eye}: {by} off");
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
