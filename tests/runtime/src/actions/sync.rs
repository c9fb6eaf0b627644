//! `xrSyncActions`: active sets, and the values of their actions.

use super::bindings::{Attachment, Binding};
use super::profiles::EYES;
use crate::abi::pointers::In;
use crate::events::Event;
use crate::fault::{Fault, result_name, section};
use crate::record::{ActionState, Line};
use crate::runtime::{Runtime, call};
use crate::script;
use openxr_sys as xr;
use openxr_sys::{Handle, SessionState};
use std::collections::BTreeMap;

/// Input of a session.
#[derive(Debug, Default)]
pub(crate) struct InputState {
    pub(super) attachment: Option<Attachment>,
    /// Whether the event of the interaction profiles was sent.
    pub(super) announced: bool,
    /// Values of the newest `xrSyncActions`, by action and subaction path.
    pub(super) states: BTreeMap<(u64, xr::Path), State>,
    /// Bindings that the newest `xrSyncActions` left active.
    pub(super) active: Vec<Binding>,
}

/// Value of an action.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct State {
    pub active: bool,
    pub value: [f32; 2],
    pub changed: bool,
    pub last_change: i64,
}

impl InputState {
    /// Whether an action set is attached.
    pub fn has_set(&self, set: xr::ActionSet) -> bool {
        self.attachment.as_ref().is_some_and(|attachment| attachment.sets.contains(&set))
    }
}

/// `xrSyncActions`.
pub(crate) extern "system" fn sync(session: xr::Session, info: In<xr::ActionsSyncInfo>) -> xr::Result {
    call("xrSyncActions", |runtime| {
        let info = runtime.read(&info)?;
        let sets = info.active_action_sets()?;
        for set in sets {
            check(runtime, session, set)?;
        }
        let focused = runtime.sessions.get(session)?.state == SessionState::FOCUSED;
        let is_kept = runtime.scenario.quirks.active_from_attachment && (sets.is_empty() || !focused);
        if !is_kept {
            let active = if focused { active_bindings(runtime, session, sets)? } else { Vec::new() };
            activate(runtime, session, active)?;
        }
        let result = if focused { xr::Result::SUCCESS } else { xr::Result::SESSION_NOT_FOCUSED };
        record(runtime, session, sets, result)?;
        if focused {
            announce(runtime, session)?;
        }
        Ok(result)
    })
}

/// Makes bindings of a session the active ones.
pub(super) fn activate(
    runtime: &mut Runtime,
    session: xr::Session,
    active: Vec<Binding>,
) -> Result<(), Fault> {
    let states = states(runtime, session, &active)?;
    let input = &mut runtime.sessions.get_mut(session)?.input;
    (input.active, input.states) = (active, states);
    Ok(())
}

fn record(
    runtime: &mut Runtime,
    session: xr::Session,
    sets: &[xr::ActiveActionSet],
    result: xr::Result,
) -> Result<(), Fault> {
    if !runtime.scenario.output.input {
        return Ok(());
    }
    let input = &runtime.sessions.get(session)?.input;
    let mut states = Vec::new();
    for ((action, subaction), state) in &input.states {
        let Ok(action) = runtime.actions.get(xr::Action::from_raw(*action)) else { continue };
        if *subaction == xr::Path::NULL {
            let set = &runtime.action_sets.get(action.set)?.name;
            states.push(ActionState {
                action: format!("{set}/{}", action.name),
                active: state.active,
                value: state.value,
                changed: state.changed,
            });
        }
    }
    let name = |set: &xr::ActiveActionSet| Ok(runtime.action_sets.get(set.action_set)?.name.clone());
    let sets = sets.iter().map(name).collect::<Result<_, Fault>>()?;
    let line = Line::ActionsSynced { session: session.into_raw(), result: result_name(result), sets, states };
    runtime.recorder.line(&line);
    Ok(())
}

fn check(runtime: &Runtime, session: xr::Session, active: &xr::ActiveActionSet) -> Result<(), Fault> {
    let set = runtime.action_sets.get(active.action_set)?;
    let (owner, instance) = runtime.session_and_instance(session)?;
    if !owner.input.has_set(active.action_set) {
        let message = format!("the action set {} is not attached to the session", set.name);
        return Err(Fault::new(xr::Result::ERROR_ACTIONSET_NOT_ATTACHED, section::SYNC, message));
    }
    let path = active.subaction_path;
    if path == xr::Path::NULL {
        return Ok(());
    }
    let text = instance.paths.text(path)?;
    let mut actions = runtime.actions.iter().filter(|(_, action)| action.set == active.action_set);
    if actions.any(|(_, action)| action.subactions.contains(&path)) {
        return Ok(());
    }
    let message = format!("no action of {} was made with the subaction path {text}", set.name);
    Err(Fault::new(xr::Result::ERROR_PATH_UNSUPPORTED, section::SYNC, message))
}

/// Bindings of the active sets, without bindings whose source a set of higher priority takes (OpenXR, "Action Sets").
fn active_bindings(
    runtime: &Runtime,
    session: xr::Session,
    sets: &[xr::ActiveActionSet],
) -> Result<Vec<Binding>, Fault> {
    let (owner, instance) = runtime.session_and_instance(session)?;
    let mut found = Vec::new();
    for binding in owner.input.attachment.iter().flat_map(|attachment| &attachment.bindings) {
        let Ok(priority) = runtime.action_sets.get(binding.set).map(|set| set.priority) else { continue };
        let covers = |set: &&xr::ActiveActionSet| {
            let path = set.subaction_path;
            let user_fits = path == xr::Path::NULL || instance.paths.text(path) == Ok(binding.user);
            set.action_set == binding.set && user_fits
        };
        // Pose actions of a tracker that does not work are bound, and follow nothing.
        if binding.user == EYES && !runtime.scenario.tracker.active {
            continue;
        }
        if sets.iter().any(|set| covers(&set)) {
            found.push((priority, binding));
        }
    }
    let highest =
        |source: &str| found.iter().filter(|(_, other)| other.source == source).map(|(p, _)| *p).max();
    let kept = found.iter().filter(|(priority, binding)| highest(&binding.source) == Some(*priority));
    Ok(kept.map(|(_, binding)| (*binding).clone()).collect())
}

fn states(
    runtime: &Runtime,
    session: xr::Session,
    active: &[Binding],
) -> Result<BTreeMap<(u64, xr::Path), State>, Fault> {
    let (owner, instance) = runtime.session_and_instance(session)?;
    let now = runtime.now();
    let mut states = BTreeMap::new();
    for (handle, action) in runtime.actions.iter().filter(|(_, action)| owner.input.has_set(action.set)) {
        for subaction in action.subactions.iter().copied().chain([xr::Path::NULL]) {
            let user = (subaction != xr::Path::NULL).then(|| instance.paths.text(subaction)).transpose()?;
            let sources = active
                .iter()
                .filter(|binding| binding.action == handle && user.is_none_or(|user| user == binding.user))
                .filter_map(|binding| reading(runtime, &binding.source, now));
            let key = (handle.into_raw(), subaction);
            let before = owner.input.states.get(&key).copied().unwrap_or_default();
            states.insert(key, state(before, sources, now));
        }
    }
    Ok(states)
}

/// The strongest of the sources, and whether it changed.
fn state(before: State, sources: impl Iterator<Item = [f32; 2]>, now: i64) -> State {
    let strength = |value: &[f32; 2]| value[0].hypot(value[1]);
    match sources.max_by(|a, b| strength(a).total_cmp(&strength(b))) {
        Some(value) => {
            let changed = before.active && before.value != value;
            let last_change = if changed { now } else { before.last_change };
            State { active: true, value, changed, last_change }
        }
        None => State::default(),
    }
}

/// Value of a source now; `None` from a tracker that does not see the eyes.
fn reading(runtime: &Runtime, source: &str, now: i64) -> Option<[f32; 2]> {
    let seconds = runtime.clock.scenario_seconds(now);
    if source.starts_with(EYES) {
        if !runtime.scenario.tracker.active {
            return None;
        }
        if runtime.scenario.quirks.active_from_attachment {
            return Some([0.0; 2]);
        }
        return script::gaze_at(&runtime.scenario.gaze, seconds).map(|_| [0.0; 2]);
    }
    // A binding may leave the last name to the runtime.
    let candidates = ["", "/value", "/click", "/force"].map(|end| format!("{source}{end}"));
    let scripted =
        candidates.iter().find_map(|path| script::input_at(&runtime.scenario.input, path, seconds));
    Some(scripted.unwrap_or_default())
}

/// Sends the event of the interaction profiles to the application, once.
fn announce(runtime: &mut Runtime, handle: xr::Session) -> Result<(), Fault> {
    let session = runtime.sessions.get_mut(handle)?;
    let has_profiles =
        session.input.attachment.as_ref().is_some_and(|attachment| !attachment.profiles.is_empty());
    if has_profiles && !std::mem::replace(&mut session.input.announced, true) {
        let events = &mut runtime.instances.get_mut(session.instance)?.events;
        events.push_back(Event::InteractionProfileChanged { session: handle });
    }
    Ok(())
}
