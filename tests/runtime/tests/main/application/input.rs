//! Actions of the application.

use super::{Application, IDENTITY, call, name, structure};
use openxr_sys as xr;

impl Application {
    pub fn action_set(&self, set_name: &str) -> xr::ActionSet {
        let info = structure!(ActionSetCreateInfo {
            action_set_name: name(set_name),
            localized_action_set_name: name(set_name),
        });
        let mut set = xr::ActionSet::default();
        assert_eq!(call!(self, CreateActionSet(self.instance, &info, &mut set)), xr::Result::SUCCESS);
        set
    }

    pub fn action(&self, set: xr::ActionSet, action_name: &str, ty: xr::ActionType) -> xr::Action {
        self.try_action(set, action_name, ty, &[]).unwrap()
    }

    pub fn try_action(
        &self,
        set: xr::ActionSet,
        action_name: &str,
        ty: xr::ActionType,
        subactions: &[xr::Path],
    ) -> Result<xr::Action, xr::Result> {
        let info = structure!(ActionCreateInfo {
            action_name: name(action_name),
            localized_action_name: name(action_name),
            action_type: ty,
            count_subaction_paths: subactions.len() as u32,
            subaction_paths: subactions.as_ptr(),
        });
        let mut action = xr::Action::default();
        match call!(self, CreateAction(set, &info, &mut action)) {
            xr::Result::SUCCESS => Ok(action),
            error => Err(error),
        }
    }

    pub fn suggest(&self, profile: &str, bindings: &[(xr::Action, &str)]) -> xr::Result {
        let bind = |&(action, path): &(xr::Action, &str)| xr::ActionSuggestedBinding {
            action,
            binding: self.path(path),
        };
        let bindings: Vec<_> = bindings.iter().map(bind).collect();
        let info = structure!(InteractionProfileSuggestedBinding {
            interaction_profile: self.path(profile),
            count_suggested_bindings: bindings.len() as u32,
            suggested_bindings: bindings.as_ptr(),
        });
        call!(self, SuggestInteractionProfileBindings(self.instance, &info))
    }

    pub fn attach(&self, sets: &[xr::ActionSet]) -> xr::Result {
        let info = structure!(SessionActionSetsAttachInfo {
            count_action_sets: sets.len() as u32,
            action_sets: sets.as_ptr(),
        });
        call!(self, AttachSessionActionSets(self.session, &info))
    }

    pub fn sync(&self, sets: &[xr::ActionSet]) -> xr::Result {
        let active =
            |&action_set: &xr::ActionSet| xr::ActiveActionSet { action_set, subaction_path: xr::Path::NULL };
        let sets: Vec<_> = sets.iter().map(active).collect();
        let info = structure!(ActionsSyncInfo {
            count_active_action_sets: sets.len() as u32,
            active_action_sets: sets.as_ptr(),
        });
        call!(self, SyncActions(self.session, &info))
    }

    pub fn boolean(&self, action: xr::Action) -> Result<xr::ActionStateBoolean, xr::Result> {
        let info = structure!(ActionStateGetInfo { action: action });
        let mut state = structure!(ActionStateBoolean {});
        match call!(self, GetActionStateBoolean(self.session, &info, &mut state)) {
            xr::Result::SUCCESS => Ok(state),
            error => Err(error),
        }
    }

    pub fn action_space(&self, action: xr::Action) -> xr::Space {
        let info = structure!(ActionSpaceCreateInfo { action: action, pose_in_action_space: IDENTITY });
        let mut space = xr::Space::default();
        assert_eq!(call!(self, CreateActionSpace(self.session, &info, &mut space)), xr::Result::SUCCESS);
        space
    }
}
