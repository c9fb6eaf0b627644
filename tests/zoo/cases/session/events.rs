//! Events, as they reach the application.

use super::Session;
use crate::failure::{Failure, succeeded};
use openxr_sys as xr;
use std::ptr::{from_ref, null_mut};

impl Session<'_> {
    /// Takes all waiting events: notes their names, and follows the state of the session.
    pub fn poll(&self) -> Result<(), Failure> {
        loop {
            let mut event =
                xr::EventDataBuffer { ty: xr::EventDataBuffer::TYPE, next: null_mut(), varying: [0; 4000] };
            let poll = self.app.xr.functions.poll_event;
            // SAFETY: the instance is live and the output outlives the call.
            let result = unsafe { poll(self.app.xr.instance, &mut event) };
            if succeeded("xrPollEvent", result)? == xr::Result::EVENT_UNAVAILABLE {
                return Ok(());
            }
            self.note(&event);
        }
    }

    fn note(&self, event: &xr::EventDataBuffer) {
        if event.ty != xr::EventDataSessionStateChanged::TYPE {
            self.app.report().event(format!("{:?}", event.ty));
            return;
        }
        // SAFETY: the type identifies the structure at the start of the buffer; the buffer is larger and equally aligned.
        let changed = unsafe { *from_ref(event).cast::<xr::EventDataSessionStateChanged>() };
        if changed.session == self.handle {
            self.app.report().event(format!("state {:?}", changed.state));
            self.state.set(changed.state);
        }
    }
}
