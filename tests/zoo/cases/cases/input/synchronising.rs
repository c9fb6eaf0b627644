//! Synchronisation of actions: its time, and its action sets.

use super::{LOADING, Outcome, PLAYED, show};
use crate::app::App;
use crate::cases::stereo::Stereo;
use crate::controls::{self, Controls, LEFT_SELECT, RIGHT_SELECT, SIMPLE};
use crate::failure::{Failure, name};
use crate::session::{Layer, Session};
use openxr_sys as xr;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU32, Ordering};

const LEFT_GRIP: &str = "/user/hand/left/input/grip/pose";

/// Attached, and never synchronised.
pub fn never_synchronises(app: &App) -> Outcome {
    synchronises_from(app, u32::MAX)
}

/// Attached, and synchronised when all is loaded.
pub fn synchronises_late(app: &App) -> Outcome {
    synchronises_from(app, LOADING)
}

/// A set with the left hand: its button, and its pose.
fn hand(controls: &Controls) -> Result<(xr::ActionSet, [xr::Action; 2]), Failure> {
    let set = controls.set(0)?;
    let button = controls.action(set, xr::ActionType::BOOLEAN_INPUT, &[])?;
    let grip = controls.action(set, xr::ActionType::POSE_INPUT, &[])?;
    controls.suggest(SIMPLE, &[(button, LEFT_SELECT), (grip, LEFT_GRIP)])?;
    Ok((set, [button, grip]))
}

fn synchronises_from(app: &App, first: u32) -> Outcome {
    let controls = Controls::new(app);
    let (set, [button, grip]) = hand(&controls)?;
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    let space = controls.space(&session, grip)?;
    show(&session, LOADING + PLAYED, |frame| {
        if frame.index % 20 == 0 || frame.index >= LOADING {
            controls.profile(&session, "/user/hand/left")?;
            controls.look(&session, button, xr::Path::NULL);
            if let Some(space) = space {
                controls.pose(&session, grip, space, frame);
            }
        }
        if frame.index >= first {
            controls.sync(&session, &[set]);
        }
        Ok(())
    })?;
    session.finish()
}

/// Before anything is attached.
pub fn synchronises_before_attaching(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let (set, button) = controls.button()?;
    let session = Session::start(app)?;
    show(&session, PLAYED, |frame| {
        if frame.index == 4 {
            controls.attach(&session, &[set]);
        }
        controls.sync(&session, &[set]);
        controls.look(&session, button, xr::Path::NULL);
        Ok(())
    })?;
    session.finish()
}

/// No set at all is active in some frames.
pub fn synchronises_nothing(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let (set, [button, grip]) = hand(&controls)?;
    let session = Session::start(app)?;
    let sets = [set];
    controls.attach(&session, &sets);
    let space = controls.space(&session, grip)?;
    show(&session, PLAYED, |frame| {
        controls.sync(&session, if frame.index % 3 == 2 { &[] } else { &sets });
        controls.look(&session, button, xr::Path::NULL);
        if let Some(space) = space {
            controls.pose(&session, grip, space, frame);
        }
        Ok(())
    })?;
    session.finish()
}

/// Two sets want one button: the one with the higher priority has it while it is active.
pub fn has_sets_of_different_priority(app: &App) -> Outcome {
    two_sets(app, [1, 7])
}

/// Two sets of one priority share it.
pub fn has_sets_of_the_same_priority(app: &App) -> Outcome {
    two_sets(app, [0, 0])
}

fn two_sets(app: &App, priorities: [u32; 2]) -> Outcome {
    let controls = Controls::new(app);
    let sets = [controls.set(priorities[0])?, controls.set(priorities[1])?];
    let action = |set| controls.action(set, xr::ActionType::BOOLEAN_INPUT, &[]);
    let buttons = [action(sets[0])?, action(sets[1])?];
    controls.suggest(SIMPLE, &buttons.map(|button| (button, LEFT_SELECT)))?;
    let session = Session::start(app)?;
    controls.attach(&session, &sets);
    show(&session, PLAYED, |frame| {
        controls.sync(
            &session,
            match frame.index % 3 {
                0 => &sets,
                1 => &sets[..1],
                _ => &sets[1..],
            },
        );
        buttons.iter().for_each(|button| controls.look(&session, *button, xr::Path::NULL));
        Ok(())
    })?;
    session.finish()
}

/// One action for both hands, read for each.
pub fn tells_hands_apart(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let hands = [controls.path("/user/hand/left")?, controls.path("/user/hand/right")?];
    let set = controls.set(0)?;
    let button = controls.action(set, xr::ActionType::BOOLEAN_INPUT, &hands)?;
    controls.suggest(SIMPLE, &[(button, LEFT_SELECT), (button, RIGHT_SELECT)])?;
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    show(&session, PLAYED, |frame| {
        let user = if frame.index % 2 == 0 { xr::Path::NULL } else { hands[1] };
        let active = [xr::ActiveActionSet { action_set: set, subaction_path: user }];
        controls.trace(format!("sync: {}", name(controls::sync(app, session.handle, &active))));
        for user in hands.into_iter().chain([xr::Path::NULL]) {
            controls.look(&session, button, user);
        }
        Ok(())
    })?;
    session.finish()
}

/// A thread of its own synchronises all the time, while another one shows frames.
pub fn synchronises_on_another_thread(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let (set, button) = controls.button()?;
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    let functions = app.xr.functions.sync_actions;
    let (handle, ended, count) = (session.handle, AtomicBool::new(false), AtomicU32::new(0));
    std::thread::scope(|threads| {
        let worker = threads.spawn(|| {
            let active = xr::ActiveActionSet { action_set: set, subaction_path: xr::Path::NULL };
            let info = xr::ActionsSyncInfo {
                ty: xr::ActionsSyncInfo::TYPE,
                next: std::ptr::null(),
                count_active_action_sets: 1,
                active_action_sets: &active,
            };
            let mut wrong = None;
            while !ended.load(Ordering::Relaxed) {
                // SAFETY: the session lives longer than this thread; the structures outlive the call.
                let result = unsafe { functions(handle, &info) };
                if result != xr::Result::SUCCESS && result != xr::Result::SESSION_NOT_FOCUSED {
                    wrong = Some(result);
                }
                count.fetch_add(1, Ordering::Relaxed);
                std::thread::yield_now();
            }
            wrong
        });
        let shown = show(&session, 40, |_| {
            // The first that ends from here on may have begun in the frame before; the second has not. So each frame's input
            // is synchronised in it, in every run.
            let before = count.load(Ordering::Relaxed);
            while count.load(Ordering::Relaxed) < before + 2 && !worker.is_finished() {
                std::thread::yield_now();
            }
            Ok(())
        });
        ended.store(true, Ordering::Relaxed);
        let wrong = worker.join().map_err(|_| Failure::Unsupported("the thread panicked".to_owned()))?;
        controls.trace(format!("the thread: {wrong:?}"));
        shown
    })?;
    controls.sync(&session, &[set]);
    controls.look(&session, button, xr::Path::NULL);
    session.finish()
}

/// A thread of its own locates the views all the time, while another one draws and submits.
pub fn locates_views_on_another_thread(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let (set, button) = controls.button()?;
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    let stereo = Stereo::create(&session)?;
    let views = session.locator();
    let (shown_at, ended) = (AtomicI64::new(0), AtomicBool::new(false));
    std::thread::scope(|threads| {
        let worker = threads.spawn(|| {
            let mut wrong = None;
            let mut count = 0;
            while !ended.load(Ordering::Relaxed) {
                count += 1;
                let time = shown_at.load(Ordering::Relaxed);
                if time > 0 {
                    // Each time another one, as an application has it that predicts for itself.
                    wrong = views(xr::Time::from_nanos(time + count % 1000)).err().or(wrong);
                }
                std::thread::yield_now();
            }
            wrong
        });
        let shown = session.frames(40, |frame| {
            shown_at.store(frame.display_time.as_nanos(), Ordering::Relaxed);
            controls.sync(&session, &[set]);
            controls.look(&session, button, xr::Path::NULL);
            stereo.paint(frame.index)?;
            session.submit(frame, &[Layer::Projection(stereo.images())])
        });
        ended.store(true, Ordering::Relaxed);
        let wrong = worker.join().map_err(|_| Failure::Unsupported("the thread panicked".to_owned()))?;
        controls.trace(format!("the thread: {wrong:?}"));
        shown
    })?;
    drop(stereo);
    session.finish()
}
