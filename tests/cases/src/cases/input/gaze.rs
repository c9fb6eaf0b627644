//! Applications that look at the gaze themselves.

use super::{Outcome, PLAYED, show};
use crate::app::App;
use crate::controls::{Controls, GAZE, GAZE_POSE, LEFT_SELECT, SIMPLE};
use crate::failure::{Failure, succeeded};
use crate::session::{IDENTITY, Session};
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ptr::{null, null_mut};

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

/// The gaze as space and as base, in the spaces of the head and of the world, and the views in it; with all that the extension tells.
pub fn finds_the_gaze_in_every_space(app: &App) -> Outcome {
    let controls = Controls::new(app);
    controls.trace(format!("the system has eye gaze: {}", has_eye_gaze(app)?));
    let set = controls.set(0)?;
    let gaze = controls.action(set, xr::ActionType::POSE_INPUT, &[])?;
    controls.suggest(GAZE, &[(gaze, GAZE_POSE)])?;
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    let Some(space) = controls.space(&session, gaze)? else { return session.finish() };
    let head = reference(&session, xr::ReferenceSpaceType::VIEW)?;
    show(&session, PLAYED, |frame| {
        controls.sync(&session, &[set]);
        controls.pose(&session, gaze, space, frame);
        controls.sources(&session, gaze)?;
        for (name, space, base) in [
            ("gaze in VIEW", space, head),
            ("gaze in LOCAL", space, session.space),
            ("VIEW in gaze", head, space),
            ("LOCAL in gaze", session.space, space),
            ("gaze in gaze", space, space),
        ] {
            controls.location(name, space, base, frame);
        }
        controls.views(&session, space, frame);
        Ok(())
    })?;
    // SAFETY: the space is live, and used no more.
    let result = unsafe { (app.xr.functions.destroy_space)(space) };
    controls.trace(format!("destroy the space: {result:?}"));
    session.finish()
}

/// One action that the left hand and the eyes drive, told apart by subaction paths.
pub fn tells_eyes_from_hands(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let users = [controls.path("/user/hand/left")?, controls.path("/user/eyes_ext")?];
    let set = controls.set(0)?;
    let aim = controls.action(set, xr::ActionType::POSE_INPUT, &users)?;
    controls.suggest(SIMPLE, &[(aim, "/user/hand/left/input/aim/pose")])?;
    controls.suggest(GAZE, &[(aim, GAZE_POSE)])?;
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    let spaces = users.map(|user| controls.space_of(&session, aim, user));
    show(&session, PLAYED, |frame| {
        // Now the one, then the other, then both.
        let active: &[xr::Path] = match frame.index % 3 {
            0 => &users[..1],
            1 => &users[1..],
            _ => &users,
        };
        controls.sync_paths(&session, set, active);
        for (user, space) in users.iter().zip(&spaces) {
            if let Ok(Some(space)) = space {
                controls.pose_of(&session, (aim, *user), *space, frame);
            }
        }
        Ok(())
    })?;
    session.finish()
}

/// What the system says of eye gaze.
fn has_eye_gaze(app: &App) -> Result<bool, Failure> {
    let mut gaze = xr::SystemEyeGazeInteractionPropertiesEXT::out(null_mut());
    let mut properties = xr::SystemProperties::out(gaze.as_mut_ptr().cast());
    let xr = &app.xr;
    // SAFETY: the instance is live; the structures outlive the call.
    unsafe {
        (*gaze.as_mut_ptr()).supports_eye_gaze_interaction = xr::FALSE;
        let get = xr.functions.get_system_properties;
        succeeded("xrGetSystemProperties", get(xr.instance, xr.system, properties.as_mut_ptr()))?;
        Ok(gaze.assume_init().supports_eye_gaze_interaction.into())
    }
}

fn reference(session: &Session, kind: xr::ReferenceSpaceType) -> Result<xr::Space, Failure> {
    let info = xr::ReferenceSpaceCreateInfo {
        ty: xr::ReferenceSpaceCreateInfo::TYPE,
        next: null(),
        reference_space_type: kind,
        pose_in_reference_space: IDENTITY,
    };
    let mut space = xr::Space::NULL;
    let create = session.app.xr.functions.create_reference_space;
    // SAFETY: the session is live; the structures outlive the call.
    succeeded("xrCreateReferenceSpace", unsafe { create(session.handle, &info, &mut space) })?;
    Ok(space)
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
