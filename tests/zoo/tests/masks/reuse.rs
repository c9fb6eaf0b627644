//! The same styles with a periphery that is re-used as paper B does it, from one frame's pixels to the next one's: every
//! pixel is one that the application drew there, in this frame or in one of the last.

use crate::effort::Effort;
use crate::{Expected, masked, mean, run};
use libtest_mimic::Failed;
use parafovea_tests::picture::Picture;
use parafovea_tests::run::LayerMode;
use parafovea_tests::scenario::ScenarioExt;
use parafovea_zoo::Style;

/// What is run in every test: long enough that every image of a swapchain has a mask, of which there are as many as the
/// longest period and two more.
const SHARE: Effort = Effort { frames: 24, size: 96 };

/// Frames of the longest period.
const PERIOD: u64 = 3;

/// Every pixel is shaded when its turn comes, and all of a region has its turn in one frame.
const AS_PUBLISHED: &str = "[gaze]\nsource = \"centre\"\n[rates]\nmode = \"off\"\ngate = \"on\"\n[chroma]\nmode = \"off\"\n\
    [reuse]\nmode = \"paper\"\nperiods = \"11223\"\n";

/// How far pictures may be off on the whole that another pass reads before they are shown, code values: filters take what is
/// shaded coarsely over a tile's edge, and move what is re-used.
const READ_LIMIT: f64 = 1.5;

pub fn check(style: &Style, expected: &Expected) -> Result<(), Failed> {
    let effort = Effort::or_share(SHARE.frames, SHARE.size);
    // The plan counts frames from 1: neither 2 nor 3 divides this one's number.
    let last = effort.frames - 2;
    let saved: Vec<u64> = (last + 1 - PERIOD..=last).collect();
    let scenario = effort.scenario().saving(&saved);
    let Some((on, noted)) = masked(style, effort, scenario.clone(), AS_PUBLISHED)? else { return Ok(()) };
    let off = run(style, effort, scenario, LayerMode::Off, None)?.expect_frames(effort.frames)?;
    for eye in 0..2 {
        let on = on.submitted(eye, last)?;
        let off =
            saved.iter().rev().map(|frame| off.submitted(eye, *frame)).collect::<Result<Vec<_>, _>>()?;
        match expected {
            Expected::Refused(_) => assert!(on == off[0], "eye {eye} differs"),
            Expected::Engaged => compare(style, eye, &on, &off),
            Expected::NotRun => {}
        }
    }
    assert!(noted.iter().any(|pass| pass.frame == last));
    Ok(())
}

/// Whether a picture is made of those that the application drew, the newest first.
fn compare(style: &Style, eye: usize, on: &Picture, off: &[Picture]) {
    let of_one_size = off.iter().all(|off| (off.width, off.height) == (on.width, on.height));
    if !style.direct || !of_one_size {
        // Exposure and temporal filters carry what was coarse on, far and long: there only how light it is counts.
        let is_alike = of_one_size && style.global.is_none();
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
