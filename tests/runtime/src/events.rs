//! Events that the application has not polled yet.

use crate::abi::pointers::Out;
use crate::record::Line;
use crate::runtime::call;
use crate::scenario::Answer;
use openxr_sys as xr;

/// An event of an instance.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Event {
    SessionState { session: xr::Session, state: xr::SessionState, time: i64 },
    InteractionProfileChanged { session: xr::Session },
}

impl Event {
    /// The session it is about.
    pub fn session(&self) -> xr::Session {
        match self {
            Self::SessionState { session, .. } | Self::InteractionProfileChanged { session } => *session,
        }
    }
}

/// `xrPollEvent`.
pub(crate) extern "system" fn poll(
    instance: xr::Instance,
    mut buffer: Out<xr::EventDataBuffer>,
) -> xr::Result {
    call("xrPollEvent", |runtime| {
        let time = runtime.now();
        let session = runtime
            .sessions
            .iter()
            .find(|(_, session)| session.instance == instance)
            .map(|(handle, _)| handle);
        let instance = runtime.instances.get_mut(instance)?;
        buffer.get()?;
        match (runtime.answer, session) {
            (Answer::InstanceLossPending, _) => {
                buffer.set_event(xr::EventDataInstanceLossPending {
                    ty: xr::EventDataInstanceLossPending::TYPE,
                    next: std::ptr::null(),
                    loss_time: xr::Time::from_nanos(time),
                })?;
                return Ok(xr::Result::SUCCESS);
            }
            (Answer::SessionLossPending, Some(session)) => {
                let state = xr::SessionState::LOSS_PENDING;
                instance.events.push_front(Event::SessionState { session, state, time });
            }
            _ => {}
        }
        let Some(event) = instance.events.pop_front() else { return Ok(xr::Result::EVENT_UNAVAILABLE) };
        if runtime.scenario.output.input {
            let event = match event {
                Event::SessionState { state, .. } => format!("state {state:?}"),
                Event::InteractionProfileChanged { .. } => "interaction profile".to_owned(),
            };
            runtime.recorder.line(&Line::EventPolled { event });
        }
        match event {
            Event::SessionState { session, state, time } => {
                buffer.set_event(xr::EventDataSessionStateChanged {
                    ty: xr::EventDataSessionStateChanged::TYPE,
                    next: std::ptr::null(),
                    session,
                    state,
                    time: xr::Time::from_nanos(time),
                })?;
            }
            Event::InteractionProfileChanged { session } => {
                buffer.set_event(xr::EventDataInteractionProfileChanged {
                    ty: xr::EventDataInteractionProfileChanged::TYPE,
                    next: std::ptr::null(),
                    session,
                })?;
            }
        }
        Ok(xr::Result::SUCCESS)
    })
}
