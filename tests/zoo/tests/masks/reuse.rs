//! The same styles with a periphery that is re-used as paper B does it, from one frame's pixels to the next one's: every
//! pixel is one that the application drew there, in this frame or in one of the last.

use crate::drawn::{AS_PUBLISHED, PERIOD, check_history, compare};
use crate::effort::Effort;
use crate::{Expected, masked, run};
use libtest_mimic::Failed;
use parafovea_tests::run::LayerMode;
use parafovea_tests::scenario::ScenarioExt;
use parafovea_zoo::Style;

/// Arguments of every test: long enough that every image of a swapchain has a mask, of which there are as many as the longest period and
/// two or three more.
const SHARE: Effort = Effort { frames: 24, size: 96 };

pub fn check(style: &Style, expected: &Expected) -> Result<(), Failed> {
    let effort = Effort::or_share(SHARE.frames, SHARE.size);
    // The plan counts frames from 1: neither 2 nor 3 divides this one's number.
    let last = effort.frames - 2;
    let saved: Vec<u64> = (last + 1 - PERIOD..=last).collect();
    let scenario = effort.scenario().saving(&saved);
    let (on, noted) = masked(style, effort, scenario.clone(), AS_PUBLISHED)?;
    if matches!(expected, Expected::Engaged) {
        check_history(style, &on.log);
    }
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
