//! The application's actions, as far as they can have the gaze.

use super::GazePaths;
use openxr_sys as xr;

/// Input of an application that asked for eye gaze, of one instance.
#[derive(Debug, Default)]
pub struct OfferedInput {
    sets: Vec<OfferedSet>,
    actions: Vec<OfferedAction>,
    /// The actions of its newest suggestion for the profile of eye gaze.
    suggested: Vec<xr::Action>,
    /// The actions of its suggestions for other profiles.
    others: Vec<xr::Action>,
}

#[derive(Clone, Copy, Debug)]
struct OfferedSet {
    set: xr::ActionSet,
    priority: u32,
    /// Attached to a session: it takes no more suggestions.
    is_attached: bool,
}

#[derive(Clone, Copy, Debug)]
struct OfferedAction {
    action: xr::Action,
    set: xr::ActionSet,
    is_pose: bool,
    has_eyes: bool,
}

/// An action that has the gaze in a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GazeBinding {
    /// The action.
    pub action: xr::Action,
    /// Its set.
    pub set: xr::ActionSet,
    /// Priority of its set.
    pub priority: u32,
    /// Whether the eyes are among its subaction paths.
    pub has_eyes: bool,
    /// Whether no other profile can drive it: then the gaze is its source where no subaction path is asked for.
    pub is_alone: bool,
}

impl OfferedInput {
    /// A set was made.
    pub fn note_set(&mut self, set: xr::ActionSet, priority: u32) {
        self.sets.retain(|known| known.set != set);
        self.sets.push(OfferedSet { set, priority, is_attached: false });
    }

    /// An action was made; `has_eyes` as in [`GazeBinding`].
    pub fn note_action(
        &mut self,
        action: xr::Action,
        set: xr::ActionSet,
        ty: xr::ActionType,
        has_eyes: bool,
    ) {
        self.forget_action(action);
        let is_pose = ty == xr::ActionType::POSE_INPUT;
        self.actions.push(OfferedAction { action, set, is_pose, has_eyes });
    }

    /// An action is destroyed: its handle may be another's.
    pub fn forget_action(&mut self, action: xr::Action) {
        self.actions.retain(|known| known.action != action);
        self.suggested.retain(|known| *known != action);
        self.others.retain(|known| *known != action);
    }

    /// A set is destroyed, with its actions.
    pub fn forget_set(&mut self, set: xr::ActionSet) {
        self.sets.retain(|known| known.set != set);
        let of_set = self.actions.iter().filter(|known| known.set == set);
        let actions: Vec<_> = of_set.map(|known| known.action).collect();
        actions.into_iter().for_each(|action| self.forget_action(action));
    }

    /// Bindings of another profile were suggested.
    pub fn note_others(&mut self, bindings: &[xr::ActionSuggestedBinding]) {
        for binding in bindings {
            if !self.others.contains(&binding.action) {
                self.others.push(binding.action);
            }
        }
    }

    /// Takes suggested bindings of the profile of eye gaze, which replace the earlier ones.
    ///
    /// # Errors
    ///
    /// The errors of `xrSuggestInteractionProfileBindings`.
    pub fn suggest(
        &mut self,
        paths: &GazePaths,
        bindings: &[xr::ActionSuggestedBinding],
    ) -> Result<(), xr::Result> {
        if bindings.is_empty() {
            return Err(xr::Result::ERROR_VALIDATION_FAILURE);
        }
        for binding in bindings {
            let action = self.find(binding.action).ok_or(xr::Result::ERROR_HANDLE_INVALID)?;
            if self.sets.iter().any(|set| set.set == action.set && set.is_attached) {
                return Err(xr::Result::ERROR_ACTIONSETS_ALREADY_ATTACHED);
            }
            if ![paths.pose, paths.source].contains(&binding.binding) {
                return Err(xr::Result::ERROR_PATH_UNSUPPORTED);
            }
        }
        self.suggested = bindings.iter().map(|binding| binding.action).collect();
        Ok(())
    }

    /// Sets were attached to a session: the actions that have the gaze there.
    pub fn attach(&mut self, sets: &[xr::ActionSet]) -> Vec<GazeBinding> {
        for set in &mut self.sets {
            set.is_attached |= sets.contains(&set.set);
        }
        let mut gazes: Vec<GazeBinding> = Vec::new();
        for action in self.suggested.iter().filter_map(|action| self.find(*action)) {
            let set = self.sets.iter().find(|set| set.set == action.set && sets.contains(&set.set));
            let Some(set) = set.filter(|_| action.is_pose) else { continue };
            let binding = GazeBinding {
                action: action.action,
                set: set.set,
                priority: set.priority,
                has_eyes: action.has_eyes,
                is_alone: !self.others.contains(&action.action),
            };
            if !gazes.contains(&binding) {
                gazes.push(binding);
            }
        }
        gazes
    }

    /// Whether the eyes are among the subaction paths of an action.
    pub fn has_eyes(&self, action: xr::Action) -> bool {
        self.find(action).is_some_and(|action| action.has_eyes)
    }

    fn find(&self, action: xr::Action) -> Option<OfferedAction> {
        self.actions.iter().copied().find(|known| known.action == action)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xr::offer::tests::paths;
    use xr::Handle;

    fn set(number: u64) -> xr::ActionSet {
        xr::ActionSet::from_raw(number)
    }

    fn action(number: u64) -> xr::Action {
        xr::Action::from_raw(number)
    }

    fn binding(number: u64, path: xr::Path) -> xr::ActionSuggestedBinding {
        xr::ActionSuggestedBinding { action: action(number), binding: path }
    }

    fn input() -> OfferedInput {
        let mut input = OfferedInput::default();
        input.note_set(set(1), 4);
        input.note_set(set(2), 0);
        input.note_action(action(10), set(1), xr::ActionType::POSE_INPUT, true);
        input.note_action(action(11), set(1), xr::ActionType::BOOLEAN_INPUT, false);
        input.note_action(action(20), set(2), xr::ActionType::POSE_INPUT, false);
        input
    }

    #[test]
    fn the_newest_suggestion_counts_for_poses_of_attached_sets() {
        let mut input = input();
        let bindings = [binding(10, paths().pose), binding(10, paths().source), binding(11, paths().pose)];
        input.suggest(&paths(), &[binding(20, paths().pose)]).unwrap();
        input.suggest(&paths(), &bindings).unwrap();
        input.note_others(&[binding(20, xr::Path::from_raw(9))]);
        let expected =
            GazeBinding { action: action(10), set: set(1), priority: 4, has_eyes: true, is_alone: true };
        assert_eq!(input.attach(&[set(1), set(2)]), [expected]);
        assert_eq!(input.attach(&[set(2)]), []);
        input.note_others(&[binding(10, xr::Path::from_raw(9))]);
        assert_eq!(input.attach(&[set(1)]), [GazeBinding { is_alone: false, ..expected }]);
    }

    #[test]
    fn wrong_suggestions_get_the_errors_of_a_runtime() {
        let mut input = input();
        let mut refused = |bindings: &[_]| input.suggest(&paths(), bindings).unwrap_err();
        assert_eq!(refused(&[]), xr::Result::ERROR_VALIDATION_FAILURE);
        assert_eq!(refused(&[binding(99, paths().pose)]), xr::Result::ERROR_HANDLE_INVALID);
        assert_eq!(refused(&[binding(10, paths().eyes)]), xr::Result::ERROR_PATH_UNSUPPORTED);
        input.attach(&[set(1)]);
        let late = input.suggest(&paths(), &[binding(10, paths().pose)]);
        assert_eq!(late, Err(xr::Result::ERROR_ACTIONSETS_ALREADY_ATTACHED));
        input.suggest(&paths(), &[binding(20, paths().pose)]).unwrap();
    }

    #[test]
    fn a_handle_that_is_used_again_is_another_action() {
        let mut input = input();
        input.suggest(&paths(), &[binding(10, paths().pose), binding(20, paths().pose)]).unwrap();
        input.forget_set(set(1));
        input.note_set(set(1), 0);
        input.note_action(action(10), set(1), xr::ActionType::POSE_INPUT, false);
        assert!(!input.has_eyes(action(10)));
        let gazes = input.attach(&[set(1), set(2)]);
        assert_eq!(gazes.iter().map(|gaze| gaze.action).collect::<Vec<_>>(), [action(20)]);
    }
}
