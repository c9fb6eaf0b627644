//! Applications that look at the gaze themselves.

use super::{Outcome, PLAYED, show};
use crate::app::App;
use crate::controls::{Controls, GAZE, GAZE_POSE, LEFT_SELECT, SIMPLE};
use crate::session::Session;
use openxr_sys as xr;

/// In a set of the lowest priority.
pub fn looks_at_the_gaze_itself(app: &App) -> Outcome {
    looks(app, &[0])
}

/// In a set that takes the gaze from every set below.
pub fn looks_at_the_gaze_with_priority(app: &App) -> Outcome {
    looks(app, &[6])
}

/// In two sets, of which the upper one takes it from the lower one while it is active.
pub fn looks_at_the_gaze_in_two_sets(app: &App) -> Outcome {
    looks(app, &[2, 9])
}

fn looks(app: &App, priorities: &[u32]) -> Outcome {
    let controls = Controls::new(app);
    let (mut sets, mut gazes) = (Vec::new(), Vec::new());
    for priority in priorities {
        let set = controls.set(*priority)?;
        sets.push(set);
        gazes.push(controls.action(set, xr::ActionType::POSE_INPUT, &[])?);
    }
    let bindings: Vec<_> = gazes.iter().map(|gaze| (*gaze, GAZE_POSE)).collect();
    controls.suggest(GAZE, &bindings)?;
    let session = Session::start(app)?;
    controls.attach(&session, &sets);
    let mut spaces = Vec::new();
    for gaze in &gazes {
        spaces.push(controls.space(&session, *gaze)?);
    }
    show(&session, PLAYED, |frame| {
        controls.sync(&session, if frame.index % 4 == 3 { &sets[..1] } else { &sets });
        controls.profile(&session, "/user/eyes_ext")?;
        for (gaze, space) in gazes.iter().zip(&spaces) {
            if let Some(space) = space {
                controls.pose(&session, *gaze, *space, frame);
            }
        }
        Ok(())
    })?;
    session.finish()
}

/// The profile of eye gaze without its extension: the suggestion is refused.
pub fn suggests_gaze_without_its_extension(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let set = controls.set(0)?;
    let gaze = controls.action(set, xr::ActionType::POSE_INPUT, &[])?;
    let button = controls.action(set, xr::ActionType::BOOLEAN_INPUT, &[])?;
    controls.suggest(GAZE, &[(gaze, GAZE_POSE)])?;
    controls.suggest(SIMPLE, &[(button, LEFT_SELECT)])?;
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    let space = controls.space(&session, gaze)?;
    show(&session, PLAYED, |frame| {
        controls.sync(&session, &[set]);
        controls.look(&session, button, xr::Path::NULL);
        if let Some(space) = space {
            controls.pose(&session, gaze, space, frame);
        }
        Ok(())
    })?;
    session.finish()
}

/// New bindings for eye gaze in each session, each of which replaces those before.
pub fn suggests_gaze_in_each_session(app: &App) -> Outcome {
    let controls = Controls::new(app);
    for _ in 0..3 {
        let set = controls.set(3)?;
        let gaze = controls.action(set, xr::ActionType::POSE_INPUT, &[])?;
        controls.suggest(GAZE, &[(gaze, GAZE_POSE)])?;
        let session = Session::start(app)?;
        controls.attach(&session, &[set]);
        let space = controls.space(&session, gaze)?;
        show(&session, PLAYED, |frame| {
            controls.sync(&session, &[set]);
            if let Some(space) = space {
                controls.pose(&session, gaze, space, frame);
            }
            Ok(())
        })?;
        session.finish()?;
    }
    Ok(())
}
