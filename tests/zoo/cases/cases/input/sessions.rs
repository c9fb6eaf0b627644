//! More than one session.

use super::{Outcome, PLAYED, show};
use crate::app::App;
use crate::controls::Controls;
use crate::session::Session;
use openxr_sys as xr;

/// The same action sets in one session after the other.
pub fn attaches_the_same_sets_to_each_session(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let (set, button) = controls.button()?;
    for _ in 0..3 {
        let session = Session::start(app)?;
        controls.attach(&session, &[set]);
        show(&session, PLAYED, |_| {
            controls.sync(&session, &[set]);
            controls.look(&session, button, xr::Path::NULL);
            controls.profile(&session, "/user/hand/left")
        })?;
        session.finish()?;
    }
    Ok(())
}

/// Action sets of its own for each session, and one session without any.
pub fn makes_new_sets_for_each_session(app: &App) -> Outcome {
    let controls = Controls::new(app);
    for turn in 0..3 {
        let session = Session::start(app)?;
        if turn == 1 {
            show(&session, PLAYED, |_| Ok(()))?;
        } else {
            let (set, button) = controls.button()?;
            controls.attach(&session, &[set]);
            show(&session, PLAYED, |_| {
                controls.sync(&session, &[set]);
                controls.look(&session, button, xr::Path::NULL);
                Ok(())
            })?;
        }
        session.finish()?;
    }
    Ok(())
}

/// Sessions that come to nothing before the one that is used.
pub fn drops_sessions_unused(app: &App) -> Outcome {
    let controls = Controls::new(app);
    let (set, button) = controls.button()?;
    for attached in [false, true] {
        let session = Session::create(app)?;
        if attached {
            controls.attach(&session, &[set]);
        }
    }
    let session = Session::start(app)?;
    controls.attach(&session, &[set]);
    show(&session, PLAYED, |_| {
        controls.sync(&session, &[set]);
        controls.look(&session, button, xr::Path::NULL);
        Ok(())
    })?;
    session.finish()
}
