//! Suggested bindings, attaching, and the interaction profiles that follow from both.

use super::profiles::{EYES, PROFILES, Profile};
use super::sync::activate;
use super::{check_attached, check_user};
use crate::abi::pointers::{In, List, Out};
use crate::abi::text;
use crate::fault::{Fault, section};
use crate::instance::Instance;
use crate::record::Line;
use crate::runtime::{Runtime, call};
use crate::scenario::Hand;
use openxr_sys as xr;
use openxr_sys::Handle;
use std::collections::BTreeMap;
use std::ffi::c_char;

/// The newest suggestion for each profile: actions and binding paths.
pub(crate) type Suggestions = BTreeMap<&'static str, Vec<(xr::Action, String)>>;

/// A source that drives an action.
#[derive(Clone, Debug)]
pub(super) struct Binding {
    /// It drives spaces of the action also after that is destroyed.
    pub action: xr::Action,
    pub set: xr::ActionSet,
    pub user: &'static str,
    pub source: String,
}

/// Attached action sets of a session.
#[derive(Clone, Debug)]
pub(super) struct Attachment {
    pub sets: Vec<xr::ActionSet>,
    pub bindings: Vec<Binding>,
    /// The profile of each user path that has one.
    pub profiles: BTreeMap<&'static str, &'static str>,
}

/// `xrSuggestInteractionProfileBindings`.
pub(crate) extern "system" fn suggest(
    instance: xr::Instance,
    info: In<xr::InteractionProfileSuggestedBinding>,
) -> xr::Result {
    call("xrSuggestInteractionProfileBindings", |runtime| {
        let info = runtime.read(&info)?;
        let owner = runtime.instances.get(instance)?;
        let profile = find_profile(owner, owner.paths.text(info.interaction_profile)?)?;
        let suggested = info.suggested_bindings()?;
        if suggested.is_empty() {
            return Err(Fault::validation(section::BINDINGS, "countSuggestedBindings is 0"));
        }
        let read = |binding: &xr::ActionSuggestedBinding| read_binding(runtime, instance, profile, binding);
        let bindings = suggested.iter().map(read).collect::<Result<Vec<_>, _>>()?;
        runtime.instances.get_mut(instance)?.suggestions.insert(profile.path, bindings);
        Ok(xr::Result::SUCCESS)
    })
}

fn find_profile(instance: &Instance, path: &str) -> Result<&'static Profile, Fault> {
    let known = PROFILES.iter().find(|profile| profile.path == path);
    let usable = known.filter(|profile| profile.needs.is_none_or(|extension| instance.has(extension)));
    usable.ok_or_else(|| {
        let message = format!("{path} is no interaction profile of this runtime with these extensions");
        Fault::new(xr::Result::ERROR_PATH_UNSUPPORTED, section::BINDINGS, message)
    })
}

fn read_binding(
    runtime: &Runtime,
    instance: xr::Instance,
    profile: &Profile,
    binding: &xr::ActionSuggestedBinding,
) -> Result<(xr::Action, String), Fault> {
    let action = runtime.actions.get(binding.action)?;
    let set = runtime.action_sets.get(action.set)?;
    if set.instance != instance {
        let message = format!("the action {} is of another instance", action.name);
        return Err(Fault::validation(section::BINDINGS, message));
    }
    if set.attached {
        let message = format!("the action set {} is attached: its bindings are fixed", set.name);
        return Err(Fault::new(xr::Result::ERROR_ACTIONSETS_ALREADY_ATTACHED, section::BINDINGS, message));
    }
    let path = runtime.instances.get(instance)?.paths.text(binding.binding)?;
    if profile.user_of(path).is_none() {
        let message = format!("{path} is no binding path of {}", profile.path);
        return Err(Fault::new(xr::Result::ERROR_PATH_UNSUPPORTED, section::BINDINGS, message));
    }
    Ok((binding.action, path.to_owned()))
}

/// `xrAttachSessionActionSets`.
pub(crate) extern "system" fn attach(
    session: xr::Session,
    info: In<xr::SessionActionSetsAttachInfo>,
) -> xr::Result {
    call("xrAttachSessionActionSets", |runtime| {
        let info = runtime.read(&info)?;
        let (owner, _) = runtime.session_and_instance(session)?;
        let instance = owner.instance;
        if owner.input.attachment.is_some() {
            let message = "the session has action sets attached: that happens once";
            let result = xr::Result::ERROR_ACTIONSETS_ALREADY_ATTACHED;
            return Err(Fault::new(result, section::ACTION_SETS, message));
        }
        let sets = info.action_sets()?.to_vec();
        if sets.is_empty() {
            return Err(Fault::validation(section::ACTION_SETS, "countActionSets is 0"));
        }
        for set in &sets {
            let set = runtime.action_sets.get(*set)?;
            if set.instance != instance {
                let message = format!("the action set {} is of another instance", set.name);
                return Err(Fault::validation(section::ACTION_SETS, message));
            }
        }
        let attachment = attachment(runtime, instance, sets)?;
        if runtime.scenario.output.input {
            let name = |set: &xr::ActionSet| Ok(runtime.action_sets.get(*set)?.name.clone());
            let sets = attachment.sets.iter().map(name).collect::<Result<_, Fault>>()?;
            runtime.recorder.line(&Line::ActionsAttached { session: session.into_raw(), sets });
        }
        for set in &attachment.sets {
            runtime.action_sets.get_mut(*set)?.attached = true;
        }
        let bindings = attachment.bindings.clone();
        runtime.sessions.get_mut(session)?.input.attachment = Some(attachment);
        if runtime.scenario.quirks.active_from_attachment {
            activate(runtime, session, bindings)?;
        }
        Ok(xr::Result::SUCCESS)
    })
}

/// Chooses a profile for each user path that this system has, and the bindings that follow.
fn attachment(
    runtime: &Runtime,
    instance: xr::Instance,
    sets: Vec<xr::ActionSet>,
) -> Result<Attachment, Fault> {
    let suggestions = &runtime.instances.get(instance)?.suggestions;
    let in_sets =
        |action: &xr::Action| runtime.actions.get(*action).is_ok_and(|action| sets.contains(&action.set));
    let system = &runtime.scenario.system;
    let hand = |hand: &Hand| match hand {
        Hand::Left => "/user/hand/left",
        Hand::Right => "/user/hand/right",
    };
    let users = system.hands.iter().map(hand).chain(system.eye_gaze.then_some(EYES));
    let (mut bindings, mut profiles) = (Vec::new(), BTreeMap::new());
    for user in users {
        let chosen = PROFILES
            .iter()
            .filter(|profile| profile.has_user(user))
            .find_map(|profile| suggestions.get(profile.path).map(|suggested| (profile, suggested)));
        let Some((profile, suggested)) = chosen else { continue };
        let of_user =
            suggested.iter().filter(|(action, path)| in_sets(action) && profile.user_of(path) == Some(user));
        profiles.insert(user, profile.path);
        let works = |(action, _): &&(xr::Action, String)| {
            let is_last =
                || runtime.actions.get(*action).is_ok_and(|action| sets.last() == Some(&action.set));
            !runtime.scenario.quirks.only_last_set || is_last()
        };
        let set_of = |action: &xr::Action| Some(runtime.actions.get(*action).ok()?.set);
        bindings.extend(of_user.filter(works).filter_map(|(action, path)| {
            Some(Binding { action: *action, set: set_of(action)?, user, source: path.clone() })
        }));
    }
    Ok(Attachment { sets, bindings, profiles })
}

/// `xrGetCurrentInteractionProfile`. There is none before the first `xrSyncActions` with focus.
pub(crate) extern "system" fn get_current_profile(
    session: xr::Session,
    user: xr::Path,
    mut profile: Out<xr::InteractionProfileState>,
) -> xr::Result {
    call("xrGetCurrentInteractionProfile", |runtime| {
        let (owner, _) = runtime.session_and_instance(session)?;
        let instance = owner.instance;
        let user = check_user(runtime, instance, user)?;
        let input = &runtime.sessions.get(session)?.input;
        let attachment = input.attachment.as_ref().ok_or_else(|| {
            let message = "no action sets are attached to the session";
            Fault::new(xr::Result::ERROR_ACTIONSET_NOT_ATTACHED, section::PROFILES, message)
        })?;
        let current = attachment.profiles.get(user).filter(|_| input.announced).copied();
        let paths = &mut runtime.instances.get_mut(instance)?.paths;
        profile.get()?.interaction_profile = current.map_or(xr::Path::NULL, |path| paths.intern(path));
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrEnumerateBoundSourcesForAction`.
pub(crate) extern "system" fn enumerate_bound_sources(
    session: xr::Session,
    info: In<xr::BoundSourcesForActionEnumerateInfo>,
    capacity: u32,
    count: Out<u32>,
    items: Out<xr::Path>,
) -> xr::Result {
    call("xrEnumerateBoundSourcesForAction", |runtime| {
        let handle = runtime.read(&info)?.action;
        check_attached(runtime, session, runtime.actions.get(handle)?)?;
        let owner = runtime.sessions.get(session)?;
        let bindings = owner.input.attachment.iter().flat_map(|attachment| &attachment.bindings);
        let bound = bindings.filter(|binding| binding.action == handle);
        let paths = &mut runtime.instances.get_mut(owner.instance)?.paths;
        let sources: Vec<_> = bound.map(|binding| paths.intern(&binding.source)).collect();
        List { capacity, count, items }.fill("sources", &sources)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrGetInputSourceLocalizedName`: the names of the path, in plain words.
pub(crate) extern "system" fn get_localized_name(
    session: xr::Session,
    info: In<xr::InputSourceLocalizedNameGetInfo>,
    capacity: u32,
    count: Out<u32>,
    items: Out<c_char>,
) -> xr::Result {
    call("xrGetInputSourceLocalizedName", |runtime| {
        let info = runtime.read(&info)?;
        let (owner, instance) = runtime.session_and_instance(session)?;
        if owner.input.attachment.is_none() {
            let message = "no action sets are attached to the session";
            return Err(Fault::new(xr::Result::ERROR_ACTIONSET_NOT_ATTACHED, section::PROFILES, message));
        }
        if !matches!(info.which_components.into_raw(), 1..=7) {
            let message = format!("whichComponents is {:#x}", info.which_components.into_raw());
            return Err(Fault::validation(section::PROFILES, message));
        }
        let path = instance.paths.text(info.source_path)?;
        let name = path.trim_start_matches("/user/").replace("/input", "").replace(['/', '_'], " ");
        List { capacity, count, items }.fill("buffer", &text::terminated(&name))?;
        Ok(xr::Result::SUCCESS)
    })
}
