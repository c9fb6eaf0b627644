//! Actions of an application, and the trace of all that it does with them and sees of them.

use crate::app::App;
use crate::failure::{Failure, name, succeeded};
use crate::functions::{characters, extension_function};
use crate::session::{Frame, IDENTITY, Session};
use openxr_sys as xr;
use openxr_sys::Handle;
use std::cell::Cell;
use std::ffi::CString;
use std::ptr::{null, null_mut};

/// The profile of a simple controller.
pub const SIMPLE: &str = "/interaction_profiles/khr/simple_controller";

/// The profile of an eye tracker.
pub const GAZE: &str = "/interaction_profiles/ext/eye_gaze_interaction";

/// Its pose.
pub const GAZE_POSE: &str = "/user/eyes_ext/input/gaze_ext/pose";

/// The button of the left simple controller.
pub const LEFT_SELECT: &str = "/user/hand/left/input/select/click";

/// The button of the right one.
pub const RIGHT_SELECT: &str = "/user/hand/right/input/select/click";

/// Creates action sets and uses them; the results of the calls go to the report's trace.
pub struct Controls<'a> {
    app: &'a App,
    made: Cell<u32>,
}

impl<'a> Controls<'a> {
    /// Nothing is made yet.
    pub fn new(app: &'a App) -> Self {
        Self { app, made: Cell::new(0) }
    }

    /// Records an observation.
    pub fn trace(&self, what: impl Into<String>) {
        self.app.report().trace.push(what.into());
    }

    fn traced(&self, what: &str, result: xr::Result) -> xr::Result {
        self.trace(format!("{what}: {}", name(result)));
        result
    }

    /// A new name: no two things have the same.
    fn unique(&self, stem: &str) -> Result<CString, Failure> {
        self.made.set(self.made.get() + 1);
        CString::new(format!("{stem}_{}", self.made.get())).map_err(|error| unusable(&error))
    }

    /// The atom of a path.
    pub fn path(&self, text: &str) -> Result<xr::Path, Failure> {
        self.app.xr.path(&CString::new(text).map_err(|error| unusable(&error))?)
    }

    /// An action set.
    pub fn set(&self, priority: u32) -> Result<xr::ActionSet, Failure> {
        let name = self.unique("set")?;
        let info = xr::ActionSetCreateInfo {
            ty: xr::ActionSetCreateInfo::TYPE,
            next: null(),
            action_set_name: characters(&name),
            localized_action_set_name: characters(&name),
            priority,
        };
        let mut set = xr::ActionSet::NULL;
        let xr = &self.app.xr;
        // SAFETY: the instance is live; the structures outlive the call.
        let result = unsafe { (xr.functions.create_action_set)(xr.instance, &info, &mut set) };
        succeeded("xrCreateActionSet", self.traced("create an action set", result))?;
        Ok(set)
    }

    /// An action of a set, with these subaction paths.
    pub fn action(
        &self,
        set: xr::ActionSet,
        action_type: xr::ActionType,
        users: &[xr::Path],
    ) -> Result<xr::Action, Failure> {
        let name = self.unique("action")?;
        let info = xr::ActionCreateInfo {
            ty: xr::ActionCreateInfo::TYPE,
            next: null(),
            action_name: characters(&name),
            action_type,
            count_subaction_paths: users.len() as u32,
            subaction_paths: users.as_ptr(),
            localized_action_name: characters(&name),
        };
        let mut action = xr::Action::NULL;
        // SAFETY: the action set is live; the structures outlive the call.
        let result = unsafe { (self.app.xr.functions.create_action)(set, &info, &mut action) };
        succeeded("xrCreateAction", self.traced("create an action", result))?;
        Ok(action)
    }

    /// A set with one button, bound to the left controller's, and the button.
    pub fn button(&self) -> Result<(xr::ActionSet, xr::Action), Failure> {
        let set = self.set(0)?;
        let action = self.action(set, xr::ActionType::BOOLEAN_INPUT, &[])?;
        self.suggest(SIMPLE, &[(action, LEFT_SELECT)])?;
        Ok((set, action))
    }

    /// Suggests bindings.
    pub fn suggest(&self, profile: &str, bindings: &[(xr::Action, &str)]) -> Result<xr::Result, Failure> {
        let bindings = bindings
            .iter()
            .map(|(action, path)| {
                Ok(xr::ActionSuggestedBinding { action: *action, binding: self.path(path)? })
            })
            .collect::<Result<Vec<_>, Failure>>()?;
        let suggestion = xr::InteractionProfileSuggestedBinding {
            ty: xr::InteractionProfileSuggestedBinding::TYPE,
            next: null(),
            interaction_profile: self.path(profile)?,
            count_suggested_bindings: bindings.len() as u32,
            suggested_bindings: bindings.as_ptr(),
        };
        let xr = &self.app.xr;
        // SAFETY: the instance and the actions are live; the structures outlive the call.
        let result = unsafe { (xr.functions.suggest_bindings)(xr.instance, &suggestion) };
        Ok(self.traced("suggest bindings", result))
    }

    /// Attaches sets.
    pub fn attach(&self, session: &Session, sets: &[xr::ActionSet]) -> xr::Result {
        let info = xr::SessionActionSetsAttachInfo {
            ty: xr::SessionActionSetsAttachInfo::TYPE,
            next: null(),
            count_action_sets: sets.len() as u32,
            action_sets: sets.as_ptr(),
        };
        // SAFETY: the session and the action sets are live; the structure outlives the call.
        let result = unsafe { (self.app.xr.functions.attach_action_sets)(session.handle, &info) };
        self.traced("attach", result)
    }

    /// Synchronises these sets.
    pub fn sync(&self, session: &Session, sets: &[xr::ActionSet]) -> xr::Result {
        let active: Vec<_> = sets
            .iter()
            .map(|set| xr::ActiveActionSet { action_set: *set, subaction_path: xr::Path::NULL })
            .collect();
        let result = sync(self.app, session.handle, &active);
        self.traced("sync", result)
    }

    /// Notes the state of a button.
    pub fn look(&self, session: &Session, action: xr::Action, user: xr::Path) {
        let info = get_info(action, user);
        let mut state = xr::ActionStateBoolean::out(null_mut());
        let get = self.app.xr.functions.get_boolean;
        // SAFETY: the session and the action are live; the structures outlive the call.
        let result = unsafe { get(session.handle, &info, state.as_mut_ptr()) };
        if result.into_raw() < 0 {
            self.traced("button", result);
            return;
        }
        // SAFETY: the call succeeded, so it filled the structure.
        let state = unsafe { state.assume_init() };
        self.trace(format!(
            "button: active {} down {} changed {} at {}",
            state.is_active,
            state.current_state,
            state.changed_since_last_sync,
            state.last_change_time.as_nanos(),
        ));
    }

    /// Synchronises a set for these subaction paths.
    pub fn sync_paths(&self, session: &Session, set: xr::ActionSet, users: &[xr::Path]) {
        let active: Vec<_> =
            users.iter().map(|user| xr::ActiveActionSet { action_set: set, subaction_path: *user }).collect();
        let result = sync(self.app, session.handle, &active);
        self.traced("sync", result);
    }

    /// Notes the sources of an action.
    pub fn sources(&self, session: &Session, action: xr::Action) -> Result<(), Failure> {
        let info = xr::BoundSourcesForActionEnumerateInfo {
            ty: xr::BoundSourcesForActionEnumerateInfo::TYPE,
            next: null(),
            action,
        };
        let (mut count, mut sources) = (0, [xr::Path::NULL; 4]);
        let enumerate = self.app.xr.functions.enumerate_bound_sources;
        // SAFETY: the session and the action are live; the array has the capacity that is passed.
        let result = unsafe { enumerate(session.handle, &info, 4, &mut count, sources.as_mut_ptr()) };
        let gaze = self.path(GAZE_POSE)?;
        let has_gaze = result.into_raw() >= 0 && sources[..count as usize].contains(&gaze);
        self.trace(format!("sources: {} {count} gaze {has_gaze}", name(result)));
        Ok(())
    }

    /// Notes whether the source of the gaze has a name, of any text, with the length that an earlier call returned.
    pub fn name_of_gaze(&self, session: &Session) -> Result<(), Failure> {
        let info = xr::InputSourceLocalizedNameGetInfo {
            ty: xr::InputSourceLocalizedNameGetInfo::TYPE,
            next: null(),
            source_path: self.path(GAZE_POSE)?,
            which_components: xr::InputSourceLocalizedNameFlags::USER_PATH
                | xr::InputSourceLocalizedNameFlags::COMPONENT,
        };
        let get = self.app.xr.functions.get_localized_name;
        let (mut count, mut filled, mut text) = (0, 0, [0; 64]);
        // SAFETY: the session is live; the array has the capacity that is passed.
        let (length, name_result) = unsafe {
            let length = get(session.handle, &info, 0, &mut count, null_mut());
            (length, get(session.handle, &info, 64, &mut filled, text.as_mut_ptr()))
        };
        let end = text.iter().position(|character| *character == 0).unwrap_or(0);
        let is_whole = end > 0 && count == filled && filled as usize == end + 1;
        self.trace(format!("name: {} {} whole {is_whole}", name(length), name(name_result)));
        Ok(())
    }

    /// Notes where spaces are in another, by one call of OpenXR 1.1, and which velocities are valid.
    pub fn locations(
        &self,
        session: &Session,
        spaces: &[xr::Space],
        base: xr::Space,
        frame: &Frame,
    ) -> Result<(), Failure> {
        let locate = extension_function!(self.app.xr, LocateSpaces)?;
        let info = xr::SpacesLocateInfo {
            ty: xr::SpacesLocateInfo::TYPE,
            next: null(),
            base_space: base,
            time: frame.display_time,
            space_count: spaces.len() as u32,
            spaces: spaces.as_ptr(),
        };
        let nowhere = xr::SpaceLocationData { location_flags: xr::SpaceLocationFlags::EMPTY, pose: IDENTITY };
        let unknown = xr::SpaceVelocityData {
            velocity_flags: xr::SpaceVelocityFlags::LINEAR_VALID,
            linear_velocity: xr::Vector3f::default(),
            angular_velocity: xr::Vector3f::default(),
        };
        let (mut found, mut moving) = (vec![nowhere; spaces.len()], vec![unknown; spaces.len()]);
        let mut velocities = xr::SpaceVelocities {
            ty: xr::SpaceVelocities::TYPE,
            next: null_mut(),
            velocity_count: moving.len() as u32,
            velocities: moving.as_mut_ptr(),
        };
        let mut locations = xr::SpaceLocations {
            ty: xr::SpaceLocations::TYPE,
            next: (&raw mut velocities).cast(),
            location_count: found.len() as u32,
            locations: found.as_mut_ptr(),
        };
        // SAFETY: the session and the spaces are live; the structures outlive the call.
        let result = unsafe { locate(session.handle, &info, &mut locations) };
        for (location, velocity) in found.iter().zip(&moving) {
            let (flags, moves) = (location.location_flags, velocity.velocity_flags);
            self.trace(format!(
                "one of many: {} {flags:?} {moves:?}{}",
                name(result),
                numbers(&location.pose)
            ));
        }
        Ok(())
    }

    /// Notes where a space is in another, and whether the time of its sample is known and not later than asked for.
    pub fn location(&self, what: &str, space: xr::Space, base: xr::Space, frame: &Frame) {
        let mut sample = xr::EyeGazeSampleTimeEXT::out(null_mut());
        let mut location = xr::SpaceLocation::out(sample.as_mut_ptr().cast());
        let locate = self.app.xr.functions.locate_space;
        // SAFETY: the spaces are live; the structures outlive the call.
        let (result, sample, location) = unsafe {
            (*sample.as_mut_ptr()).time = xr::Time::from_nanos(0);
            (*location.as_mut_ptr()).pose = IDENTITY;
            let result = locate(space, base, frame.display_time, location.as_mut_ptr());
            (result, sample.assume_init(), location.assume_init())
        };
        let sampled = sample.time.as_nanos();
        let is_sampled = (1..=frame.display_time.as_nanos()).contains(&sampled);
        let flags = location.location_flags;
        self.trace(format!(
            "{what}: {} {flags:?} sampled {is_sampled}{}",
            name(result),
            numbers(&location.pose)
        ));
    }

    /// Notes where the views are in a space.
    pub fn views(&self, session: &Session, space: xr::Space, frame: &Frame) {
        let info = xr::ViewLocateInfo {
            ty: xr::ViewLocateInfo::TYPE,
            next: null(),
            view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
            display_time: frame.display_time,
            space,
        };
        let mut state = xr::ViewState::out(null_mut());
        let view =
            xr::View { ty: xr::View::TYPE, next: null_mut(), pose: IDENTITY, fov: xr::Fovf::default() };
        let (mut views, mut count) = ([view; 2], 0);
        let locate = self.app.xr.functions.locate_views;
        // SAFETY: the session and the space are live; the array has the capacity that is passed.
        let (result, state) = unsafe {
            (*state.as_mut_ptr()).view_state_flags = xr::ViewStateFlags::EMPTY;
            let result = locate(session.handle, &info, state.as_mut_ptr(), 2, &mut count, views.as_mut_ptr());
            (result, state.assume_init())
        };
        let poses: String = views.iter().map(|view| numbers(&view.pose)).collect();
        self.trace(format!("views: {} {:?}{poses}", name(result), state.view_state_flags));
    }

    /// Whether a pose is active.
    pub fn is_active(&self, session: &Session, action: xr::Action) -> bool {
        let info = get_info(action, xr::Path::NULL);
        let mut state = xr::ActionStatePose::out(null_mut());
        let get = self.app.xr.functions.get_pose;
        // SAFETY: the session and the action are live; the structures outlive the call, which fills the state where it succeeds.
        unsafe {
            get(session.handle, &info, state.as_mut_ptr()).into_raw() >= 0
                && state.assume_init().is_active.into()
        }
    }

    /// Notes whether a pose is active, and where it is in LOCAL.
    pub fn pose(&self, session: &Session, action: xr::Action, space: xr::Space, frame: &Frame) {
        self.pose_of(session, (action, xr::Path::NULL), space, frame);
    }

    /// The same for a subaction path.
    pub fn pose_of(
        &self,
        session: &Session,
        (action, user): (xr::Action, xr::Path),
        space: xr::Space,
        frame: &Frame,
    ) {
        let mut state = xr::ActionStatePose::out(null_mut());
        let functions = &self.app.xr.functions;
        // SAFETY: the session, the action and the spaces are live; the structures outlive the calls.
        let (active, located, location) = unsafe {
            let info = get_info(action, user);
            let active = (functions.get_pose)(session.handle, &info, state.as_mut_ptr());
            let mut location = xr::SpaceLocation::out(null_mut());
            (*location.as_mut_ptr()).pose = IDENTITY;
            let located =
                (functions.locate_space)(space, session.space, frame.display_time, location.as_mut_ptr());
            (active, located, location)
        };
        let mut seen = format!("pose: {} {}", name(active), name(located));
        if active.into_raw() >= 0 && located.into_raw() >= 0 {
            // SAFETY: the calls succeeded, so they filled the structures.
            let (state, location) = unsafe { (state.assume_init(), location.assume_init()) };
            let xr::Quaternionf { x, y, z, w } = location.pose.orientation;
            let flags = location.location_flags;
            seen += &format!(" active {} {flags:?} {x} {y} {z} {w}", state.is_active);
        }
        self.trace(seen);
    }

    /// A space that an action moves.
    pub fn space(&self, session: &Session, action: xr::Action) -> Result<Option<xr::Space>, Failure> {
        self.space_of(session, action, xr::Path::NULL)
    }

    /// The same for a subaction path.
    pub fn space_of(
        &self,
        session: &Session,
        action: xr::Action,
        subaction_path: xr::Path,
    ) -> Result<Option<xr::Space>, Failure> {
        let info = xr::ActionSpaceCreateInfo {
            ty: xr::ActionSpaceCreateInfo::TYPE,
            next: null(),
            action,
            subaction_path,
            pose_in_action_space: IDENTITY,
        };
        let mut space = xr::Space::NULL;
        let create = self.app.xr.functions.create_action_space;
        // SAFETY: the session and the action are live; the structures outlive the call.
        let result = unsafe { create(session.handle, &info, &mut space) };
        self.traced("create a space", result);
        Ok((result.into_raw() >= 0).then_some(space))
    }

    /// Notes the current profile of a user path.
    pub fn profile(&self, session: &Session, user: &str) -> Result<(), Failure> {
        let mut state = xr::InteractionProfileState::out(null_mut());
        let user_path = self.path(user)?;
        let xr = &self.app.xr;
        // SAFETY: the session is live; the structure outlives the call.
        let result =
            unsafe { (xr.functions.get_current_profile)(session.handle, user_path, state.as_mut_ptr()) };
        let mut seen = format!("profile of {user}: {}", name(result));
        if result.into_raw() >= 0 {
            // SAFETY: the call succeeded, so it filled the structure.
            let profile = unsafe { state.assume_init() }.interaction_profile;
            seen += if profile == xr::Path::NULL {
                " none"
            } else if profile == self.path(SIMPLE)? {
                " simple"
            } else if profile == self.path(GAZE)? {
                " gaze"
            } else {
                " another"
            };
        }
        self.trace(seen);
        Ok(())
    }
}

/// xrSyncActions.
pub fn sync(app: &App, session: xr::Session, active: &[xr::ActiveActionSet]) -> xr::Result {
    let info = xr::ActionsSyncInfo {
        ty: xr::ActionsSyncInfo::TYPE,
        next: null(),
        count_active_action_sets: active.len() as u32,
        active_action_sets: active.as_ptr(),
    };
    // SAFETY: the session and the action sets are live; the structures outlive the call.
    unsafe { (app.xr.functions.sync_actions)(session, &info) }
}

/// A pose in numbers: orientation, and position.
fn numbers(pose: &xr::Posef) -> String {
    let (xr::Quaternionf { x, y, z, w }, position) = (pose.orientation, pose.position);
    format!(" {x} {y} {z} {w} {} {} {}", position.x, position.y, position.z)
}

fn get_info(action: xr::Action, subaction_path: xr::Path) -> xr::ActionStateGetInfo {
    xr::ActionStateGetInfo { ty: xr::ActionStateGetInfo::TYPE, next: null(), action, subaction_path }
}

fn unusable(error: &std::ffi::NulError) -> Failure {
    Failure::Unsupported(error.to_string())
}
