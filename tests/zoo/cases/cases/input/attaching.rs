//! Creation and attachment of action sets, at several times.

use super::{LOADING, Outcome, PLAYED, show};
use crate::app::App;
use crate::controls::{Controls, LEFT_SELECT, SIMPLE};
use crate::session::Session;
use openxr_sys as xr;
use openxr_sys::Handle;

/// Before the session begins.
pub fn attaches_early(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let (set, button) = controls.button()?;
    let session = Session::create(app)?;
    controls.attach(&session, &[set]);
    session.begin()?;
    show(&session, PLAYED, |_| {
        controls.sync(&session, &[set]);
        controls.look(&session, button, xr::Path::NULL);
        controls.profile(&session, "/user/hand/left")
    })?;
    session.finish()
}

/// The sets exist from the start, and are attached when loading ends.
pub fn attaches_after_a_loading_screen(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let (set, button) = controls.button()?;
    let session = Session::start(app)?;
    show(&session, LOADING + PLAYED, |frame| {
        if frame.index < LOADING {
            return Ok(());
        }
        if frame.index == LOADING {
            controls.attach(&session, &[set]);
        }
        controls.sync(&session, &[set]);
        controls.look(&session, button, xr::Path::NULL);
        Ok(())
    })?;
    session.finish()
}

/// The first action set is made when all is loaded.
pub fn has_no_input_before_all_is_loaded(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let controls = Controls::new(app);
    let mut made = None;
    show(&session, LOADING + PLAYED, |frame| {
        if frame.index < LOADING {
            return Ok(());
        }
        let (set, button) = match made {
            Some(made) => made,
            None => {
                let (set, button) = controls.button()?;
                controls.attach(&session, &[set]);
                *made.insert((set, button))
            }
        };
        controls.sync(&session, &[set]);
        controls.look(&session, button, xr::Path::NULL);
        Ok(())
    })?;
    session.finish()
}

/// The paths of buttons are asked for, and nothing is done with them for long.
pub fn asks_for_paths_and_waits(app: &App) -> Outcome {
    let controls = Controls::new(app);
    controls.path(LEFT_SELECT)?;
    has_no_input_before_all_is_loaded(app)
}

/// Action sets are made and never attached.
pub fn never_attaches(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let (set, button) = controls.button()?;
    let session = Session::start(app)?;
    show(&session, LOADING, |frame| {
        if frame.index % 40 == 0 {
            controls.profile(&session, "/user/hand/left")?;
            controls.sync(&session, &[set]);
            controls.look(&session, button, xr::Path::NULL);
        }
        Ok(())
    })?;
    session.finish()
}

/// No input at all: a player of films.
pub fn has_no_input(app: &App) -> Outcome {
    let session = Session::start(app)?;
    show(&session, LOADING, |_| Ok(()))?;
    session.finish()
}

/// Attaching works once: the error has to reach the application.
pub fn attaches_twice(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let (set, button) = controls.button()?;
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    controls.attach(&session, &[set]);
    let late = controls.set(1)?;
    controls.attach(&session, &[late]);
    show(&session, PLAYED, |_| {
        controls.sync(&session, &[set]);
        controls.look(&session, button, xr::Path::NULL);
        controls.sync(&session, &[late]);
        Ok(())
    })?;
    session.finish()
}

/// Attaching nothing is an error, and does not count.
pub fn attaches_nothing_first(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let (set, button) = controls.button()?;
    let session = Session::start(app)?;
    controls.attach(&session, &[]);
    controls.attach(&session, &[xr::ActionSet::from_raw(0xdead)]);
    controls.attach(&session, &[set]);
    show(&session, PLAYED, |_| {
        controls.sync(&session, &[set]);
        controls.look(&session, button, xr::Path::NULL);
        Ok(())
    })?;
    session.finish()
}

/// Spaces of actions are made before these are attached.
pub fn makes_spaces_before_attaching(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let set = controls.set(0)?;
    let grip = controls.action(set, xr::ActionType::POSE_INPUT, &[])?;
    controls.suggest(SIMPLE, &[(grip, "/user/hand/right/input/grip/pose")])?;
    let session = Session::start(app)?;
    controls.space(&session, grip)?;
    controls.attach(&session, &[set]);
    let space = controls.space(&session, grip)?;
    show(&session, PLAYED, |frame| {
        controls.sync(&session, &[set]);
        if let Some(space) = space {
            controls.pose(&session, grip, space, frame);
        }
        Ok(())
    })?;
    session.finish()
}

/// Bindings and actions come too late for a set that is attached.
pub fn adds_to_an_attached_set(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let (set, button) = controls.button()?;
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    controls.suggest(SIMPLE, &[(button, LEFT_SELECT)])?;
    if controls.action(set, xr::ActionType::BOOLEAN_INPUT, &[]).is_ok() {
        controls.trace("an action was added");
    }
    show(&session, PLAYED, |_| {
        controls.sync(&session, &[set]);
        controls.look(&session, button, xr::Path::NULL);
        Ok(())
    })?;
    session.finish()
}
