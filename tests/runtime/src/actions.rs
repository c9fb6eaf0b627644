//! Action sets and actions.

pub(crate) mod bindings;
pub(crate) mod haptics;
pub(crate) mod pose;
mod profiles;
pub(crate) mod state;
pub(crate) mod sync;

use crate::abi::pointers::{In, Out};
use crate::abi::text;
use crate::fault::{Fault, section};
use crate::paths::is_component;
use crate::runtime::{Runtime, call};
use openxr_sys as xr;

/// An `XrActionSet`.
pub(crate) struct ActionSet {
    pub instance: xr::Instance,
    name: String,
    localized: String,
    priority: u32,
    /// Whether it is attached to a session, which it stays for good.
    attached: bool,
}

/// An `XrAction`.
pub(crate) struct Action {
    pub set: xr::ActionSet,
    pub name: String,
    localized: String,
    pub ty: xr::ActionType,
    subactions: Vec<xr::Path>,
}

/// Top level user paths, and the extension that a path needs.
const USERS: [(&str, Option<&str>); 6] = [
    ("/user/hand/left", None),
    ("/user/hand/right", None),
    ("/user/head", None),
    ("/user/gamepad", None),
    ("/user/treadmill", None),
    (profiles::EYES, Some("XR_EXT_eye_gaze_interaction")),
];

/// Checks a top level user path of an instance.
fn check_user(runtime: &Runtime, instance: xr::Instance, path: xr::Path) -> Result<&'static str, Fault> {
    let instance = runtime.instances.get(instance)?;
    let text = instance.paths.text(path)?;
    let known =
        USERS.into_iter().find(|(user, needs)| *user == text && needs.is_none_or(|name| instance.has(name)));
    known.map(|(user, _)| user).ok_or_else(|| {
        let message = format!("{text} is no top level user path of this runtime");
        Fault::new(xr::Result::ERROR_PATH_UNSUPPORTED, section::ACTIONS, message)
    })
}

/// Names of sets and actions: not empty, and characters of a path's component.
fn check_names(name: &str, localized: &str) -> Result<(), Fault> {
    if name.is_empty() {
        return Err(Fault::new(xr::Result::ERROR_NAME_INVALID, section::ACTIONS, "the name is empty"));
    }
    if localized.is_empty() {
        let message = format!("the localized name of {name} is empty");
        return Err(Fault::new(xr::Result::ERROR_LOCALIZED_NAME_INVALID, section::ACTIONS, message));
    }
    if !is_component(name) {
        let message = format!("{name:?} has other characters than a-z, 0-9, -, _ and .");
        return Err(Fault::new(xr::Result::ERROR_PATH_FORMAT_INVALID, section::ACTIONS, message));
    }
    Ok(())
}

/// Names are unique among siblings.
fn check_unique<'a>(
    name: &str,
    localized: &str,
    siblings: impl Iterator<Item = (&'a str, &'a str)>,
) -> Result<(), Fault> {
    for (other, other_localized) in siblings {
        if other == name {
            let message = format!("{name:?} is the name of another one");
            return Err(Fault::new(xr::Result::ERROR_NAME_DUPLICATED, section::ACTIONS, message));
        }
        if other_localized == localized {
            let message = format!("{localized:?} is the localized name of another one");
            return Err(Fault::new(xr::Result::ERROR_LOCALIZED_NAME_DUPLICATED, section::ACTIONS, message));
        }
    }
    Ok(())
}

/// `xrCreateActionSet`.
pub(crate) extern "system" fn create_set(
    instance: xr::Instance,
    info: In<xr::ActionSetCreateInfo>,
    set: Out<xr::ActionSet>,
) -> xr::Result {
    call("xrCreateActionSet", |runtime| {
        let info = runtime.read(&info)?;
        runtime.instances.get(instance)?;
        let name = text::array("actionSetName", &info.action_set_name)?;
        let localized = text::array("localizedActionSetName", &info.localized_action_set_name)?;
        check_names(name, localized)?;
        let siblings = runtime.action_sets.iter().filter(|(_, set)| set.instance == instance);
        check_unique(name, localized, siblings.map(|(_, set)| (set.name.as_str(), set.localized.as_str())))?;
        let created = ActionSet {
            instance,
            name: name.to_owned(),
            localized: localized.to_owned(),
            priority: info.priority,
            attached: false,
        };
        set.set("actionSet", runtime.action_sets.insert(&mut runtime.serial, created))?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrDestroyActionSet`, with its actions.
pub(crate) extern "system" fn destroy_set(set: xr::ActionSet) -> xr::Result {
    call("xrDestroyActionSet", |runtime| {
        remove_set(runtime, set)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// Destroys an action set.
pub(crate) fn remove_set(runtime: &mut Runtime, set: xr::ActionSet) -> Result<(), Fault> {
    runtime.action_sets.remove(set)?;
    runtime.actions.retain(|action| action.set != set);
    Ok(())
}

/// `xrCreateAction`.
pub(crate) extern "system" fn create(
    set: xr::ActionSet,
    info: In<xr::ActionCreateInfo>,
    action: Out<xr::Action>,
) -> xr::Result {
    call("xrCreateAction", |runtime| {
        let info = runtime.read(&info)?;
        let owner = runtime.action_sets.get(set)?;
        if owner.attached {
            let message = format!("the action set {} is attached: it takes no more actions", owner.name);
            return Err(Fault::new(xr::Result::ERROR_ACTIONSETS_ALREADY_ATTACHED, section::ACTIONS, message));
        }
        let instance = owner.instance;
        let name = text::array("actionName", &info.action_name)?;
        let localized = text::array("localizedActionName", &info.localized_action_name)?;
        check_names(name, localized)?;
        let siblings = runtime.actions.iter().filter(|(_, action)| action.set == set);
        check_unique(
            name,
            localized,
            siblings.map(|(_, other)| (other.name.as_str(), other.localized.as_str())),
        )?;
        if !matches!(info.action_type.into_raw(), 1..=4 | 100) {
            return Err(Fault::validation(section::ACTIONS, format!("actionType is {:?}", info.action_type)));
        }
        let subactions = info.subaction_paths()?.to_vec();
        for (index, path) in subactions.iter().enumerate() {
            let user = check_user(runtime, instance, *path)?;
            if subactions[..index].contains(path) {
                let message = format!("subactionPaths has {user} twice");
                return Err(Fault::new(xr::Result::ERROR_PATH_UNSUPPORTED, section::ACTIONS, message));
            }
        }
        let created = Action {
            set,
            name: name.to_owned(),
            localized: localized.to_owned(),
            ty: info.action_type,
            subactions,
        };
        action.set("action", runtime.actions.insert(&mut runtime.serial, created))?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrDestroyAction`.
pub(crate) extern "system" fn destroy(action: xr::Action) -> xr::Result {
    call("xrDestroyAction", |runtime| {
        runtime.actions.remove(action)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// Checks a subaction path: none, or one that the action was made with.
pub(crate) fn check_subaction(
    runtime: &Runtime,
    session: xr::Session,
    action: xr::Action,
    path: xr::Path,
) -> Result<(), Fault> {
    if path == xr::Path::NULL {
        return Ok(());
    }
    let (_, instance) = runtime.session_and_instance(session)?;
    let text = instance.paths.text(path)?;
    let action = runtime.actions.get(action)?;
    if action.subactions.contains(&path) {
        return Ok(());
    }
    let message = format!("the action {} was made without the subaction path {text}", action.name);
    Err(Fault::new(xr::Result::ERROR_PATH_UNSUPPORTED, section::ACTIONS, message))
}

/// Checks an action as `xrGetActionState*` and haptics take it: its set is attached to the session, its type is right.
fn check_action(
    runtime: &Runtime,
    session: xr::Session,
    handle: xr::Action,
    subaction: xr::Path,
    ty: xr::ActionType,
) -> Result<(), Fault> {
    let action = runtime.actions.get(handle)?;
    check_attached(runtime, session, action)?;
    if action.ty != ty {
        let message = format!("the action {} is of type {:?}, not {ty:?}", action.name, action.ty);
        return Err(Fault::new(xr::Result::ERROR_ACTION_TYPE_MISMATCH, section::ACTION_STATE, message));
    }
    check_subaction(runtime, session, handle, subaction)
}

pub(crate) fn check_attached(runtime: &Runtime, session: xr::Session, action: &Action) -> Result<(), Fault> {
    let session = runtime.sessions.get(session)?;
    if session.input.has_set(action.set) {
        return Ok(());
    }
    let message = format!("the set of the action {} is not attached to the session", action.name);
    Err(Fault::new(xr::Result::ERROR_ACTIONSET_NOT_ATTACHED, section::ACTION_SETS, message))
}
