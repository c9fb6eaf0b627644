//! The line about a missing effect.

use super::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// More frames than recognition needs to settle: other tests of this process decide meanwhile.
const MOST_FRAMES: usize = 5000;

/// A frame without layers, as in a loading screen.
fn empty_frame(application: &Application) {
    application.begin();
    let info = xr::FrameEndInfo {
        ty: xr::FrameEndInfo::TYPE,
        next: ptr::null(),
        display_time: xr::Time::from_nanos(DISPLAY_TIME.get()),
        environment_blend_mode: xr::EnvironmentBlendMode::OPAQUE,
        layer_count: 0,
        layers: ptr::null(),
    };
    // SAFETY: a live session and a valid structure. The stand-in answers with an error.
    unsafe { frame::end(application.session, &info) };
}

#[test]
fn a_missing_effect_is_reported_after_frames_with_a_scene() {
    let lines = Arc::new(AtomicUsize::new(0));
    let count = Arc::clone(&lines);
    let take = move |line: &str| {
        count.fetch_add(
            usize::from(line.starts_with("active, but without visible effect")),
            Ordering::Relaxed,
        );
    };
    let told = || lines.load(Ordering::Relaxed);
    fake::log::with(take, || {
        let application = Application::new();
        (0..MOST_FRAMES).for_each(|_| empty_frame(&application));
        assert_eq!(told(), 0, "nothing was shown yet");
        let frames = (0..MOST_FRAMES).take_while(|_| {
            application.frame();
            told() == 0
        });
        assert!((150..MOST_FRAMES).contains(&frames.count()), "two seconds");
        (0..300).for_each(|_| application.frame());
        assert_eq!(told(), 1);
    });
}
