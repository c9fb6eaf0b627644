//! The application's input, as far as ours has to fit in.

use super::gaze_action::{self, Wanted};
use crate::abi::copies::slice;
use crate::xr::instance::Instance;
use openxr_sys as xr;
use std::ffi::{CStr, CString, c_char};

/// The input of an application, of one instance.
#[derive(Debug, Default)]
pub struct ApplicationInput {
    /// Whether it has asked for anything that leads to actions.
    has_input: bool,
    /// Its action sets, with their priorities.
    sets: Vec<(xr::ActionSet, u32)>,
    /// Its actions, with their sets.
    actions: Vec<(xr::Action, xr::ActionSet)>,
    gaze: GazeSuggestion,
    /// Number of its suggestions of bindings for eye gaze.
    gaze_suggestions: u32,
    /// The user paths, such as `/user/hand/left`, that it has suggested bindings for.
    users: Vec<xr::Path>,
}

/// The application's suggestion for the profile of eye gaze.
#[derive(Debug, Clone, Default)]
enum GazeSuggestion {
    #[default]
    Nothing,
    Bindings(Vec<xr::ActionSuggestedBinding>),
    /// With extending structures, which cannot be kept.
    Extended,
}

/// A suggestion that succeeded, read.
#[derive(Debug)]
pub struct Suggested {
    users: Vec<xr::Path>,
    gaze: Option<GazeSuggestion>,
}

impl Suggested {
    /// Reads it.
    ///
    /// # Safety
    ///
    /// `suggestion` is valid.
    pub unsafe fn read(instance: &Instance, suggestion: &xr::InteractionProfileSuggestedBinding) -> Self {
        // SAFETY: the structure is valid, as `# Safety` demands: an array of that many bindings.
        let bindings = unsafe { slice(suggestion.suggested_bindings, suggestion.count_suggested_bindings) };
        let mut users: Vec<_> =
            bindings.iter().filter_map(|binding| user_of(instance, binding.binding)).collect();
        users.sort_unstable();
        users.dedup();
        let is_gaze = instance.eye_gaze
            && gaze_action::profile(&instance.next, instance.handle) == Ok(suggestion.interaction_profile);
        let gaze = is_gaze.then(|| match suggestion.next.is_null() {
            true => GazeSuggestion::Bindings(bindings.to_vec()),
            false => GazeSuggestion::Extended,
        });
        Self { users, gaze }
    }
}

/// The user path that a binding path begins with: the part before `/input` or `/output`.
fn user_of(instance: &Instance, binding: xr::Path) -> Option<xr::Path> {
    let mut text = [0 as c_char; xr::MAX_PATH_LENGTH];
    let mut length = 0;
    // SAFETY: the next layer's function, a live instance, and a buffer of the capacity that is passed.
    let result = unsafe {
        let to_string = instance.next.path_to_string;
        to_string(instance.handle, binding, text.len() as u32, &mut length, text.as_mut_ptr())
    };
    if result.into_raw() < 0 {
        return None;
    }
    *text.last_mut()? = 0;
    // SAFETY: the buffer ends with a zero.
    let text = unsafe { CStr::from_ptr(text.as_ptr()) }.to_str().ok()?;
    let end = text.find("/input").or_else(|| text.find("/output"))?;
    gaze_action::path(&instance.next, instance.handle, &CString::new(&text[..end]).ok()?).ok()
}

impl ApplicationInput {
    /// It asked for something that leads to actions.
    pub fn note_input(&mut self) {
        self.has_input = true;
    }

    /// Whether it has input, or will.
    pub fn has_input(&self) -> bool {
        self.has_input
    }

    /// It made an action set. A handle may be that of one that was destroyed.
    pub fn note_set(&mut self, set: xr::ActionSet, priority: u32) {
        self.sets.retain(|(known, _)| *known != set);
        self.sets.push((set, priority));
    }

    /// It made an action. As for sets, the handle may be a former one.
    pub fn note_action(&mut self, action: xr::Action, set: xr::ActionSet) {
        self.actions.retain(|(known, _)| *known != action);
        self.actions.push((action, set));
    }

    /// Whether a set is one of its sets.
    pub fn has_set(&self, set: xr::ActionSet) -> bool {
        self.sets.iter().any(|(known, _)| *known == set)
    }

    /// Whether an action is one of its actions.
    pub fn has_action(&self, action: xr::Action) -> bool {
        self.actions.iter().any(|(known, _)| *known == action)
    }

    /// It destroys an action: a suggestion with the handle would be invalid usage.
    pub fn forget_action(&mut self, action: xr::Action) {
        self.actions.retain(|(known, _)| *known != action);
        if let GazeSuggestion::Bindings(bindings) = &mut self.gaze {
            bindings.retain(|binding| binding.action != action);
        }
    }

    /// It destroys a set, with its actions.
    pub fn forget_set(&mut self, set: xr::ActionSet) {
        self.sets.retain(|(known, _)| *known != set);
        let of_set = self.actions.iter().filter(|(_, of)| *of == set);
        let actions: Vec<_> = of_set.map(|(action, _)| *action).collect();
        actions.into_iter().for_each(|action| self.forget_action(action));
    }

    /// A suggestion of its own succeeded.
    pub fn note_suggestion(&mut self, suggested: Suggested) {
        for user in suggested.users {
            if !self.users.contains(&user) {
                self.users.push(user);
            }
        }
        if let Some(gaze) = suggested.gaze {
            self.gaze = gaze;
            self.gaze_suggestions += 1;
        }
    }

    /// The user paths that it has suggested bindings for.
    pub fn users(&self) -> &[xr::Path] {
        &self.users
    }

    /// Whether it uses the gaze itself.
    pub fn has_gaze(&self) -> bool {
        self.gaze_suggestions > 0
    }

    /// Number of its suggestions of bindings for eye gaze.
    pub fn gaze_suggestions(&self) -> u32 {
        self.gaze_suggestions
    }

    /// Wanted properties of our action set beside its own sets. `None` if its suggestion for eye gaze has extending structures.
    pub fn wanted(&self, number: u32) -> Option<Wanted> {
        let applications = match &self.gaze {
            GazeSuggestion::Nothing => Vec::new(),
            GazeSuggestion::Bindings(bindings) => bindings.clone(),
            GazeSuggestion::Extended => return None,
        };
        let set_of =
            |action: xr::Action| self.actions.iter().find(|(known, _)| *known == action).map(|(_, set)| *set);
        let priority_of = |set: xr::ActionSet| {
            self.sets.iter().find(|(known, _)| *known == set).map(|(_, priority)| *priority)
        };
        // Of several the lowest: no set of the application's ever loses the gaze to ours.
        let priorities = applications.iter().filter_map(|binding| priority_of(set_of(binding.action)?));
        let priority = priorities.min().unwrap_or_default();
        Some(Wanted { number, priority, applications, suggestion: self.gaze_suggestions })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use openxr_sys::Handle;

    /// Runtimes hand out addresses, which come again when an application destroys its sets and makes others.
    #[test]
    fn a_handle_that_comes_again_is_the_newer_object() {
        let [old, new] = [1, 2].map(xr::ActionSet::from_raw);
        let action = xr::Action::from_raw(7);
        let binding = xr::ActionSuggestedBinding { action, binding: xr::Path::from_raw(3) };
        let mut input = ApplicationInput::default();
        let suggested =
            || Suggested { users: Vec::new(), gaze: Some(GazeSuggestion::Bindings(vec![binding])) };
        input.note_set(old, 9);
        input.note_action(action, old);
        input.note_suggestion(suggested());
        assert_eq!(input.wanted(1).unwrap().priority, 9);
        input.note_set(old, 4);
        assert_eq!(input.wanted(1).unwrap().priority, 4);
        input.note_set(new, 2);
        input.note_action(action, new);
        input.note_suggestion(suggested());
        assert_eq!(input.wanted(1).unwrap().priority, 2);
    }

    #[test]
    fn destroyed_actions_are_not_suggested_again() {
        let [kept, emptied] = [1, 2].map(xr::ActionSet::from_raw);
        let actions = [7, 8, 9].map(xr::Action::from_raw);
        let binding = |action| xr::ActionSuggestedBinding { action, binding: xr::Path::from_raw(3) };
        let mut input = ApplicationInput::default();
        input.note_set(kept, 4);
        input.note_set(emptied, 1);
        for (action, set) in actions.into_iter().zip([kept, kept, emptied]) {
            input.note_action(action, set);
        }
        let gaze = Some(GazeSuggestion::Bindings(actions.map(binding).to_vec()));
        input.note_suggestion(Suggested { users: Vec::new(), gaze });
        input.forget_action(actions[0]);
        input.forget_set(emptied);
        let wanted = input.wanted(1).unwrap();
        let left: Vec<_> = wanted.applications.iter().map(|binding| binding.action).collect();
        assert_eq!((left, wanted.priority), (vec![actions[1]], 4));
    }
}
