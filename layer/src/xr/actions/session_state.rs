//! What is known of a session's actions, and ours.

use super::gaze_action::GazeAction;
use crate::config::GazeSource;
use crate::inputs::gaze::{FORWARD, believable};
use crate::planning::Look;
use crate::xr::session::Session;
use crate::xr::spaces;
use openxr_sys as xr;
use std::ptr;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// An application without action sets gets ours after this many frames: about a second, in which one that
/// sets its input up late has done so (peers: Quad-Views-Foveated and VectorXR wait as long).
const GRACE_FRAMES: u32 = 100;

/// The actions of a session.
#[derive(Debug)]
pub struct SessionActions {
    has_tracker: bool,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    frames: u32,
    attachment: Attachment,
}

/// Whether our action set is attached.
#[derive(Debug, Clone, Copy, Default)]
enum Attachment {
    #[default]
    Not,
    /// With the application's; its synchronisation includes ours.
    WithApplication { gaze: GazeAction, space: xr::Space },
    /// By us, for an application without action sets.
    Alone { gaze: GazeAction, space: xr::Space },
    /// Something failed, or the application attached its sets without ours.
    Never,
}

impl SessionActions {
    /// Of a session with or without an eye tracker.
    pub fn new(has_tracker: bool) -> Self {
        Self { has_tracker, state: Mutex::default() }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether there is an eye tracker, and nothing has failed so far.
    pub fn may_have_gaze(&self) -> bool {
        self.has_tracker && !matches!(self.state().attachment, Attachment::Never)
    }

    /// Our action set, if this session wants it attached now.
    pub fn prepare(&self, session: &Session) -> Option<GazeAction> {
        let is_wanted = session.active.is_some()
            && self.has_tracker
            && session.instance.config.get().gaze.source != GazeSource::Centre
            && matches!(self.state().attachment, Attachment::Not);
        if is_wanted { session.instance.actions.gaze_action(&session.instance) } else { None }
    }

    /// Our action set was attached with the application's.
    pub fn attached_with_application(&self, session: &Session, gaze: GazeAction) {
        self.state().attachment = match space(session, gaze) {
            Some(space) => Attachment::WithApplication { gaze, space },
            None => Attachment::Never,
        };
    }

    /// Our action set, if it is to be synchronised with the application's.
    pub fn attached(&self) -> Option<GazeAction> {
        match self.state().attachment {
            Attachment::WithApplication { gaze, .. } => Some(gaze),
            _ => None,
        }
    }

    /// Whether nothing but our action set is attached.
    pub fn is_attached_alone(&self) -> bool {
        matches!(self.state().attachment, Attachment::Alone { .. })
    }

    /// Does without eye gaze from now on.
    pub fn give_up(&self) {
        self.state().attachment = Attachment::Never;
    }

    /// A frame ends: for an application without action sets, ours is attached when the time has come, and
    /// synchronised from then on.
    pub fn frame_ended(&self, session: &Session) {
        let (frames, attachment) = {
            let mut state = self.state();
            state.frames = state.frames.saturating_add(1);
            (state.frames, state.attachment)
        };
        match attachment {
            Attachment::Not if frames == GRACE_FRAMES && !session.instance.actions.application_has_set() => {
                self.attach_alone(session);
            }
            Attachment::Alone { gaze, .. } => self.sync_alone(session, gaze),
            _ => {}
        }
    }

    fn attach_alone(&self, session: &Session) {
        let Some(gaze) = self.prepare(session) else { return };
        let info = xr::SessionActionSetsAttachInfo {
            ty: xr::SessionActionSetsAttachInfo::TYPE,
            next: ptr::null(),
            count_action_sets: 1,
            action_sets: &gaze.set,
        };
        // SAFETY: the next layer's function, a live session and a valid structure.
        let result = unsafe { (session.instance.next.attach_session_action_sets)(session.handle, &info) };
        let space = if result.into_raw() < 0 { None } else { space(session, gaze) };
        tracing::info!("the application has no action sets; attaching ours returned {result:?}");
        self.state().attachment = match space {
            Some(space) => Attachment::Alone { gaze, space },
            None => Attachment::Never,
        };
    }

    fn sync_alone(&self, session: &Session, gaze: GazeAction) {
        let active = gaze.active();
        let info = xr::ActionsSyncInfo {
            ty: xr::ActionsSyncInfo::TYPE,
            next: ptr::null(),
            count_active_action_sets: 1,
            active_action_sets: &active,
        };
        // SAFETY: the next layer's function, a live session and a valid structure.
        let result = unsafe { (session.instance.next.sync_actions)(session.handle, &info) };
        if result.into_raw() < 0 {
            tracing::warn!("eye gaze is off: xrSyncActions returned {result:?}");
            self.give_up();
        }
    }

    /// Where the eyes look at `time`, as a direction in the space of the head.
    pub fn look(&self, session: &Session, time: xr::Time) -> Look {
        if !self.may_have_gaze() {
            return Look::NoTracker;
        }
        let attachment = self.state().attachment;
        let gaze = match attachment {
            Attachment::WithApplication { space, .. } | Attachment::Alone { space, .. } => space,
            Attachment::Not | Attachment::Never => return Look::Unseen,
        };
        let Some(spaces) = session.spaces else { return Look::NoTracker };
        let tracked = xr::SpaceLocationFlags::ORIENTATION_TRACKED;
        let turned = spaces::orientation(&session.instance.next, gaze, spaces.head, time, tracked);
        turned.and_then(|turned| believable(turned * FORWARD)).map_or(Look::Unseen, Look::At)
    }
}

fn space(session: &Session, gaze: GazeAction) -> Option<xr::Space> {
    gaze.space(&session.instance.next, session.handle)
        .inspect_err(|result| tracing::info!("no eye gaze: xrCreateActionSpace returned {result:?}"))
        .ok()
}
