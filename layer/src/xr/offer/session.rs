//! The gaze in the actions of one session.

use super::input::GazeBinding;
use super::{GazePaths, Offer};
use crate::xr::session::Session;
use openxr_sys as xr;
use smallvec::SmallVec;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The actions of a session that have the gaze.
#[derive(Debug, Default)]
pub struct SessionOffer(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    gazes: Vec<GazeBinding>,
    /// The actions that the newest synchronisation made active.
    active: SmallVec<[xr::Action; 2]>,
    /// Actions of `active` that a source of the runtime's could drive, but none drove at that synchronisation.
    undriven: SmallVec<[xr::Action; 2]>,
    /// Whether the newest state that the application received has the focus.
    was_focused: bool,
    /// Whether the profile of eye gaze is the current one.
    is_current: bool,
    /// An event about the profile is owed.
    owes_event: bool,
}

impl SessionOffer {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sets of the application were attached.
    pub fn attached(&self, gazes: Vec<GazeBinding>) {
        self.state().gazes = gazes;
    }

    /// Takes a synchronisation of these sets by the application. `has_focus`: the call changed states; `has_gaze`: a source is present;
    /// `is_driven`: a source of the runtime's drives an action, which is asked without a lock.
    pub fn synchronised(
        &self,
        sets: &[xr::ActiveActionSet],
        paths: &GazePaths,
        (has_focus, has_gaze): (bool, bool),
        is_driven: impl Fn(xr::Action) -> bool,
    ) {
        let mut undriven = self.activate(sets, paths, (has_focus, has_gaze));
        if undriven.is_empty() {
            return;
        }
        undriven.retain(|action| !is_driven(*action));
        let mut state = self.state();
        undriven.retain(|action| state.active.contains(action));
        state.undriven = undriven;
    }

    /// Activates the gaze actions of these sets, and returns the ones among them that the runtime's own sources could drive, too.
    fn activate(
        &self,
        sets: &[xr::ActiveActionSet],
        paths: &GazePaths,
        (has_focus, has_gaze): (bool, bool),
    ) -> SmallVec<[xr::Action; 2]> {
        let mut state = self.state();
        state.active.clear();
        state.undriven.clear();
        if has_focus && !state.gazes.is_empty() && !state.is_current {
            (state.is_current, state.owes_event) = (true, true);
        }
        if has_focus && has_gaze {
            state.active = active(&state.gazes, sets, paths);
        }
        let is_shared =
            |action: &xr::Action| state.gazes.iter().any(|gaze| gaze.action == *action && !gaze.is_alone);
        state.active.iter().copied().filter(is_shared).collect()
    }

    /// Takes a state of the session that the application receives: without the focus, no input is active. States on the way to the focus may
    /// arrive after a synchronisation that had it already; they take nothing away.
    pub fn has_focus(&self, has_focus: bool) {
        let mut state = self.state();
        if std::mem::replace(&mut state.was_focused, has_focus) && !has_focus {
            state.active.clear();
            state.undriven.clear();
        }
    }

    /// Takes the event about the profile that is owed.
    pub fn take_owed(&self) -> bool {
        std::mem::take(&mut self.state().owes_event)
    }

    /// Whether the profile of eye gaze is the current one.
    pub fn is_current(&self) -> bool {
        self.state().is_current
    }

    /// Whether an action, limited to a subaction path, has the gaze as its source.
    pub fn follows(&self, action: xr::Action, subaction: xr::Path, paths: &GazePaths) -> bool {
        let state = self.state();
        state.gazes.iter().any(|gaze| {
            let has_no_other = || gaze.is_alone || state.undriven.contains(&action);
            let is_asked =
                (subaction == xr::Path::NULL && has_no_other()) || (subaction == paths.eyes && gaze.has_eyes);
            gaze.action == action && is_asked
        })
    }

    /// Whether an action is bound to the gaze, beside other sources or alone.
    pub fn is_bound(&self, action: xr::Action) -> bool {
        self.state().gazes.iter().any(|gaze| gaze.action == action)
    }

    /// Whether the gaze of an action was active at the newest synchronisation.
    pub fn is_active(&self, action: xr::Action) -> bool {
        self.state().active.contains(&action)
    }

    /// Whether the application gets the gaze at this moment.
    pub fn is_given(&self) -> bool {
        !self.state().active.is_empty()
    }
}

/// The actions of highest priority in active sets: they take the gaze from all others.
fn active(
    gazes: &[GazeBinding],
    sets: &[xr::ActiveActionSet],
    paths: &GazePaths,
) -> SmallVec<[xr::Action; 2]> {
    let is_active = |gaze: &&GazeBinding| {
        sets.iter().any(|active| {
            let is_path = active.subaction_path == xr::Path::NULL
                || (active.subaction_path == paths.eyes && gaze.has_eyes);
            active.action_set == gaze.set && is_path
        })
    };
    let highest = gazes.iter().filter(is_active).map(|gaze| gaze.priority).max();
    let has_source = |gaze: &&GazeBinding| is_active(gaze) && Some(gaze.priority) == highest;
    gazes.iter().filter(has_source).map(|gaze| gaze.action).collect()
}

impl Session {
    /// The offered gaze, where the session has one: its part and that of its instance.
    pub fn offered(&self) -> Option<(&Offer, &SessionOffer)> {
        Some((self.instance.offer.as_ref()?, self.offer.as_ref()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xr::offer::tests::paths;
    use xr::Handle;

    fn gaze(number: u64, priority: u32, is_alone: bool) -> GazeBinding {
        let (action, set) = (xr::Action::from_raw(10 * number), xr::ActionSet::from_raw(number));
        GazeBinding { action, set, priority, has_eyes: !is_alone, is_alone }
    }

    fn sets(numbers: &[u64], subaction_path: xr::Path) -> Vec<xr::ActiveActionSet> {
        let active = |number: &u64| {
            let action_set = xr::ActionSet::from_raw(*number);
            xr::ActiveActionSet { action_set, subaction_path }
        };
        numbers.iter().map(active).collect()
    }

    #[test]
    fn the_highest_active_set_has_the_gaze_while_there_is_focus_and_a_source() {
        let offer = SessionOffer::default();
        let [low, high] = [gaze(1, 2, true), gaze(2, 9, true)];
        offer.attached(vec![low, high]);
        let active = |numbers: &[u64], subaction, state| {
            offer.synchronised(&sets(numbers, subaction), &paths(), state, |_| true);
            [low, high].map(|gaze| offer.is_active(gaze.action))
        };
        let any = xr::Path::NULL;
        assert_eq!(active(&[1, 2], any, (false, true)), [false, false]);
        assert!(!offer.is_current() && !offer.take_owed());
        assert_eq!(active(&[1, 2], any, (true, false)), [false, false]);
        assert!(offer.is_current() && offer.take_owed() && !offer.take_owed());
        assert_eq!(active(&[1, 2], any, (true, true)), [false, true]);
        assert_eq!(active(&[1], any, (true, true)), [true, false]);
        assert_eq!(active(&[1], paths().eyes, (true, true)), [false, false]);
        assert!(!offer.is_given());
        assert_eq!(active(&[1], any, (true, true)), [true, false]);
        offer.has_focus(false);
        assert!(offer.is_given(), "a state from before the focus");
        offer.has_focus(true);
        assert!(offer.is_given());
        offer.has_focus(false);
        assert!(!offer.is_given() && !offer.take_owed());
    }

    #[test]
    fn an_action_that_hands_drive_too_has_the_gaze_by_the_path_of_the_eyes_alone() {
        let offer = SessionOffer::default();
        offer.attached(vec![gaze(1, 0, true), gaze(2, 0, false)]);
        let follows = |number: u64, path| offer.follows(xr::Action::from_raw(10 * number), path, &paths());
        assert_eq!([1, 2].map(|number| follows(number, xr::Path::NULL)), [true, false]);
        assert_eq!([1, 2].map(|number| follows(number, paths().eyes)), [false, true]);
        assert!(!follows(1, paths().pose) && !follows(3, xr::Path::NULL));
        let synchronise = |is_driven: bool| {
            offer.synchronised(&sets(&[2], xr::Path::NULL), &paths(), (true, true), |_| is_driven);
            follows(2, xr::Path::NULL)
        };
        assert_eq!([true, false, true].map(synchronise), [false, true, false], "while no hand drives it");
    }

    /// The runtime's answer may wait for another thread of the application.
    #[test]
    fn the_runtime_is_asked_without_a_lock() {
        let offer = SessionOffer::default();
        offer.attached(vec![gaze(1, 0, false)]);
        let is_asked = std::cell::Cell::new(false);
        offer.synchronised(&sets(&[1], xr::Path::NULL), &paths(), (true, true), |_| {
            is_asked.set(true);
            assert!(offer.0.try_lock().is_ok(), "a lock of the layer is held");
            // The focus is lost meanwhile.
            offer.has_focus(true);
            offer.has_focus(false);
            false
        });
        assert!(is_asked.get());
        assert!(!offer.follows(xr::Action::from_raw(10), xr::Path::NULL, &paths()), "not active any more");
    }
}
