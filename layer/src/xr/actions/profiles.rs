//! Interaction profiles as the application sees them: as without the layer.
//!
//! Our action set brings the profile of eye gaze, and an event about it. And where the application has nothing
//! attached, or has not synchronised yet, it is too early for any profile.

use super::gaze_action;
use crate::xr::session::Session;
use openxr_sys as xr;
use smallvec::SmallVec;
use std::ptr;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Current profile of each user path.
type Current = SmallVec<[(xr::Path, xr::Path); 4]>;

/// The profiles of one session, as the application knows them.
#[derive(Debug, Default)]
pub struct Profiles(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    view: Visibility,
    /// An event was kept back that the application gets with its first synchronisation.
    owed: bool,
    /// Profiles of the eyes and of the paths that the application uses, as the application last learnt them.
    known: Current,
}

/// Visibility of the current profiles to the application.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Visibility {
    /// All, except profiles of the eyes only.
    #[default]
    Own,
    /// Nothing yet: its action sets are attached, and we synchronise ahead of it.
    TooEarly,
    /// Nothing: only our action set is attached.
    Nothing,
}

impl Profiles {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Only our action set is attached.
    pub fn attached_alone(&self) {
        self.state().view = Visibility::Nothing;
    }

    /// We begin to synchronise, which the application has not done so far. Some runtimes choose profiles without that: then
    /// the application knows them already.
    pub fn synchronised_ahead(&self, session: &Session) {
        let chosen = current(session, users(session)).is_none_or(|current| has_any(&current));
        if !chosen {
            self.state().view = Visibility::TooEarly;
        }
    }

    /// Shows the application the current profiles, from now on: it has synchronised with the focus, or the layer no longer synchronises ahead.
    pub fn show(&self, session: &Session) {
        if self.state().view != Visibility::TooEarly {
            return;
        }
        let known = current(session, users(session)).unwrap_or_default();
        let mut state = self.state();
        state.view = Visibility::Own;
        // Without a profile of the application's there was no change to report to it; and the runtime's reports from now on are new to it.
        state.owed &= has_any(&known);
        state.known = if state.owed { known } else { Current::new() };
    }

    /// Whether an event about the session's profiles must be hidden from the application.
    pub fn hides_event(&self, session: &Session) -> bool {
        {
            let mut state = self.state();
            match state.view {
                Visibility::Nothing => return true,
                Visibility::TooEarly => {
                    state.owed = true;
                    return true;
                }
                Visibility::Own => {}
            }
        }
        if session.instance.actions.application().has_gaze() {
            return false;
        }
        let Ok(eyes) = gaze_action::eyes(&session.instance.next, session.instance.handle) else {
            return false;
        };
        let Some(now) = current(session, users(session).into_iter().chain([eyes])) else { return false };
        let mut state = self.state();
        let before = |user| {
            state
                .known
                .iter()
                .find(|(known, _)| *known == user)
                .map_or(xr::Path::NULL, |(_, profile)| *profile)
        };
        let (ours, theirs): (Current, Current) = now.iter().copied().partition(|(user, _)| *user == eyes);
        let has_changed =
            |profiles: &Current| profiles.iter().any(|(user, profile)| before(*user) != *profile);
        let hides = has_changed(&ours) && !has_changed(&theirs);
        state.known = now;
        hides
    }

    /// Takes the event that was kept back, if there is one.
    pub fn take_owed(&self) -> bool {
        let mut state = self.state();
        state.view == Visibility::Own && std::mem::take(&mut state.owed)
    }

    /// The answer to the application for the runtime's current profile.
    ///
    /// # Errors
    ///
    /// `XR_ERROR_ACTIONSET_NOT_ATTACHED` where it has attached nothing.
    pub fn answer(&self, profile: xr::Path) -> Result<xr::Path, xr::Result> {
        match self.state().view {
            Visibility::Own => Ok(profile),
            Visibility::TooEarly => Ok(xr::Path::NULL),
            Visibility::Nothing => Err(xr::Result::ERROR_ACTIONSET_NOT_ATTACHED),
        }
    }
}

fn users(session: &Session) -> SmallVec<[xr::Path; 4]> {
    SmallVec::from_slice(session.instance.actions.application().users())
}

fn has_any(current: &Current) -> bool {
    current.iter().any(|(_, profile)| *profile != xr::Path::NULL)
}

/// The current profiles of user paths; `None` if the runtime refuses one.
fn current(session: &Session, users: impl IntoIterator<Item = xr::Path>) -> Option<Current> {
    let profile = |user| {
        let mut state = xr::InteractionProfileState {
            ty: xr::InteractionProfileState::TYPE,
            next: ptr::null_mut(),
            interaction_profile: xr::Path::NULL,
        };
        let get = session.instance.next.get_current_interaction_profile;
        // SAFETY: the next layer's function, a live session and a valid structure to write to.
        let result = unsafe { get(session.handle, user, &mut state) };
        (result.into_raw() >= 0).then_some((user, state.interaction_profile))
    };
    users.into_iter().map(profile).collect()
}
