//! State of a session's actions and ours.

use super::gaze_action::GazeAction;
use super::profiles::Profiles;
use crate::config::{Config, GazeSource};
use crate::inputs::gaze::{FORWARD, Look};
use crate::xr::session::Session;
use crate::xr::spaces;
use openxr_sys as xr;
use std::ptr;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// An application that has attached its action sets, but does not synchronise them, gets ours synchronised after this many
/// frames: about a second, in which one that begins late has begun (peers: Quad-Views-Foveated and VectorXR wait as long).
const PATIENCE_FRAMES: u32 = 100;

/// Largest contribution of a frame to the time for which an application was visible: during a longer gap nothing is shown.
const LONGEST_FRAME_NS: i64 = 100_000_000;

/// The actions of a session.
#[derive(Debug)]
pub struct SessionActions {
    /// Interaction profiles as the application sees them.
    pub profiles: Profiles,
    has_tracker: bool,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    attachment: Attachment,
    /// Display time of the newest frame, and the total time for which frames were shown.
    newest_ns: Option<i64>,
    shown_ns: i64,
    /// Whether the application has synchronised its actions.
    is_synchronised: bool,
    /// Whether the application's synchronisation has succeeded with ours in it.
    has_ours_worked: bool,
    /// Whether any synchronisation of ours has succeeded, in the application's or alone.
    has_synchronised: bool,
    /// Whether the gaze was seen before that: then it needs none.
    needs_no_sync: bool,
    /// Whether the runtime takes the gaze away in a synchronisation without action sets, as the specification has it.
    ends_without_sets: bool,
    /// Frames since the application attached its action sets without synchronising them.
    waited_frames: u32,
    /// Whether the application attached its action sets while the configuration asked for no eye tracker.
    is_tracker_left_out: bool,
}

/// Whether our action set is attached.
#[derive(Debug, Clone, Copy, Default)]
enum Attachment {
    #[default]
    Not,
    /// With the application's.
    WithApplication { gaze: GazeAction, space: xr::Space },
    /// By us, for an application without action sets.
    Alone { gaze: GazeAction, space: xr::Space },
    /// Something failed, or the application attached its sets without ours.
    Never,
}

impl Attachment {
    fn ours(&self) -> Option<(GazeAction, xr::Space)> {
        match *self {
            Self::WithApplication { gaze, space } | Self::Alone { gaze, space } => Some((gaze, space)),
            Self::Not | Self::Never => None,
        }
    }
}

/// Work that is due at the end of a frame.
enum Due {
    Nothing,
    AttachAlone,
    Sync(GazeAction),
    /// For an application that does not.
    SyncAhead {
        gaze: GazeAction,
        is_first: bool,
    },
}

impl SessionActions {
    /// Of a session with or without an eye tracker.
    pub fn new(has_tracker: bool) -> Self {
        Self { profiles: Profiles::default(), has_tracker, state: Mutex::default() }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether there is an eye tracker, and nothing has failed so far.
    pub fn may_have_gaze(&self) -> bool {
        self.has_tracker && !matches!(self.state().attachment, Attachment::Never)
    }

    /// Whether a configuration follows the eye tracker, which was left out when the application attached its action sets.
    pub fn is_tracker_left_out(&self, config: &Config) -> bool {
        follows_tracker(config) && self.state().is_tracker_left_out
    }

    /// Our action set, if this session wants it attached now.
    pub fn prepare(&self, session: &Session, config: &Config) -> Option<GazeAction> {
        let is_wanted = session.active.is_some()
            && self.has_tracker
            && follows_tracker(config)
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

    /// The application attached its action sets without ours, or could not.
    pub fn attached_without(&self, session: &Session, result: xr::Result) {
        let mut state = self.state();
        match state.attachment {
            Attachment::Not if result.into_raw() >= 0 => {
                state.attachment = Attachment::Never;
                let is_followed = follows_tracker(&session.instance.config.snapshot());
                state.is_tracker_left_out = self.has_tracker && !is_followed;
                if self.has_tracker && is_followed {
                    tracing::info!(
                        "no eye tracker in this session: the application attached its action sets before the layer could add one"
                    );
                }
            }
            Attachment::Alone { .. } => tracing::error!(
                "the application set up its OpenXR input after the layer attached the eye tracker, so its controllers do not work: {result:?}; \
                 set gaze.attach_alone_after_s = 0 for this application, and restart it"
            ),
            _ => {}
        }
    }

    /// Our action set, if it is attached.
    pub fn attached(&self) -> Option<GazeAction> {
        Some(self.state().attachment.ours()?.0)
    }

    /// The application is about to synchronise its actions.
    pub fn application_synchronises(&self) {
        self.state().is_synchronised = true;
    }

    /// Whether a synchronisation of the application's has succeeded with ours in it.
    pub fn has_synchronised_ours(&self) -> bool {
        self.state().has_ours_worked
    }

    /// The application's synchronisation was made with ours in it. One without the focus has changed nothing, and proves nothing.
    pub fn synchronised_ours(&self, result: xr::Result) {
        let mut state = self.state();
        state.has_ours_worked |= result == xr::Result::SUCCESS;
        state.has_synchronised |= result == xr::Result::SUCCESS;
    }

    /// Whether the application's synchronisation without any action set passes unchanged. Monado then leaves all actions alone; with ours as the
    /// only active set, the application would lose its poses.
    pub fn may_sync_nothing(&self) -> bool {
        !self.state().ends_without_sets
    }

    /// The application's synchronisation without any action set was made. Whether the runtime still has the gaze.
    pub fn keeps_gaze(&self, session: &Session, gaze: GazeAction) -> bool {
        let keeps = gaze.is_active(&session.instance.next, session.handle);
        self.state().ends_without_sets = !keeps;
        keeps
    }

    /// Does without eye gaze from now on.
    pub fn give_up(&self, session: &Session) {
        self.state().attachment = Attachment::Never;
        self.profiles.show(session);
    }

    /// A frame that is shown at `time` ends. For an application without action sets ours is attached when the time has come,
    /// and synchronised from then on; for one that does not synchronise its own, too, until it does, unless the gaze needs none.
    pub fn frame_ended(&self, session: &Session, config: &Config, time: xr::Time) {
        match self.due(session, config, time) {
            Due::Nothing => {}
            Due::AttachAlone => self.attach_alone(session, config),
            Due::Sync(gaze) => self.sync_ours(session, gaze),
            Due::SyncAhead { gaze, is_first } => self.sync_ahead(session, gaze, is_first),
        }
    }

    /// Synchronises our action set ahead of the application's. On Monado all actions are active from their attachment, and a synchronisation of
    /// ours alone would end the application's: there the gaze needs none. By the specification, actions are inactive until the application
    /// synchronises them, which one of ours alone does not change.
    fn sync_ahead(&self, session: &Session, gaze: GazeAction, is_first: bool) {
        let is_decided = self.state().has_synchronised;
        if !is_decided && gaze.is_active(&session.instance.next, session.handle) {
            self.state().needs_no_sync = true;
            return;
        }
        if is_first {
            tracing::info!(
                "the application does not synchronise its actions: the layer synchronises those of the eye tracker"
            );
            self.profiles.synchronised_ahead(session);
        }
        self.sync_ours(session, gaze);
    }

    /// Whether [`Self::frame_ended`] need not be called for a while: nothing of ours has still to be attached.
    pub fn is_settled(&self, session: &Session) -> bool {
        let state = self.state();
        match state.attachment {
            Attachment::Not => session.instance.actions.application().has_input(),
            Attachment::WithApplication { .. } => {
                state.is_synchronised || state.needs_no_sync || state.waited_frames > PATIENCE_FRAMES
            }
            Attachment::Alone { .. } | Attachment::Never => true,
        }
    }

    fn due(&self, session: &Session, config: &Config, time: xr::Time) -> Due {
        let after_ns = i64::from(config.gaze.attach_alone_after_s) * 1_000_000_000;
        let mut state = self.state();
        let last = state.newest_ns.replace(time.as_nanos()).unwrap_or(time.as_nanos());
        state.shown_ns += time.as_nanos().saturating_sub(last).clamp(0, LONGEST_FRAME_NS);
        match state.attachment {
            Attachment::Not => {
                let is_time = after_ns > 0 && state.shown_ns >= after_ns;
                drop(state);
                let is_alone = is_time && !session.instance.actions.application().has_input();
                if is_alone { Due::AttachAlone } else { Due::Nothing }
            }
            Attachment::WithApplication { gaze, .. } if !state.is_synchronised && !state.needs_no_sync => {
                state.waited_frames = state.waited_frames.saturating_add(1);
                match state.waited_frames {
                    ..PATIENCE_FRAMES => Due::Nothing,
                    frames => Due::SyncAhead { gaze, is_first: frames == PATIENCE_FRAMES },
                }
            }
            Attachment::Alone { gaze, .. } => Due::Sync(gaze),
            Attachment::WithApplication { .. } | Attachment::Never => Due::Nothing,
        }
    }

    fn attach_alone(&self, session: &Session, config: &Config) {
        let Some(gaze) = self.prepare(session, config) else { return };
        let info = xr::SessionActionSetsAttachInfo {
            ty: xr::SessionActionSetsAttachInfo::TYPE,
            next: ptr::null(),
            count_action_sets: 1,
            action_sets: &gaze.set,
        };
        // SAFETY: the next layer's function, a live session and a valid structure.
        let result = unsafe { (session.instance.next.attach_session_action_sets)(session.handle, &info) };
        let space = if result.into_raw() < 0 {
            None
        } else {
            self.profiles.attached_alone();
            space(session, gaze)
        };
        tracing::info!(
            "the application set up no OpenXR input within gaze.attach_alone_after_s: attaching the eye tracker alone returned {result:?}"
        );
        self.state().attachment = match space {
            Some(space) => Attachment::Alone { gaze, space },
            None => Attachment::Never,
        };
    }

    fn sync_ours(&self, session: &Session, gaze: GazeAction) {
        let active = gaze.active();
        let info = xr::ActionsSyncInfo {
            ty: xr::ActionsSyncInfo::TYPE,
            next: ptr::null(),
            count_active_action_sets: 1,
            active_action_sets: &active,
        };
        // SAFETY: the next layer's function, a live session and a valid structure.
        let result = unsafe { (session.instance.next.sync_actions)(session.handle, &info) };
        self.state().has_synchronised |= result == xr::Result::SUCCESS;
        if result.into_raw() < 0 {
            tracing::warn!("eye tracker off: xrSyncActions returned {result:?}");
            self.give_up(session);
        }
    }

    /// Gaze at `time`, as a direction in the space of the head.
    pub fn look(&self, session: &Session, time: xr::Time) -> Look {
        if !self.may_have_gaze() {
            return Look::NoTracker;
        }
        let Some((_, space)) = self.state().attachment.ours() else { return Look::Unseen };
        let Some(spaces) = session.spaces else { return Look::NoTracker };
        match spaces::gaze(&session.instance.next, space, spaces.head, time) {
            Some((turned, sampled_ns)) => {
                let mut state = self.state();
                state.needs_no_sync |= !state.has_synchronised;
                Look::At { direction: turned * FORWARD, sampled_ns, uncertainty_ns: 0 }
            }
            None => Look::Unseen,
        }
    }
}

/// Whether the gaze may come from the runtime's eye tracker.
fn follows_tracker(config: &Config) -> bool {
    matches!(config.gaze.source, GazeSource::Auto | GazeSource::Eyes)
}

fn space(session: &Session, gaze: GazeAction) -> Option<xr::Space> {
    gaze.space(&session.instance.next, session.handle)
        .inspect_err(|result| tracing::info!("no eye tracker: xrCreateActionSpace returned {result:?}"))
        .ok()
}
