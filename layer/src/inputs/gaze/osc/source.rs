//! The listener of a session, as its configuration wants it.

use super::assembly::OscCounts;
use super::listener::{Listener, NewestGaze};
use super::message::Format;
use crate::inputs::gaze::Look;
use crate::inputs::gaze::auto::{PacketDelay, SampleTimes};
use std::io::ErrorKind;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

/// After this long without a direction there is no sender any more: longer than the eyes stay closed in a blink, and than a gaze is
/// held.
const ENDED: Duration = Duration::from_secs(1);

/// Time after which a port that was taken is tried again: the process that has it may end.
const RETRY: Duration = Duration::from_secs(5);

/// Packets as a source of the gaze.
#[derive(Debug, Default)]
pub struct OscSource {
    wanted: Option<SocketAddr>,
    listener: Option<Listener>,
    /// Reason why there is no listener, and its time.
    failure: Option<(ErrorKind, Instant)>,
    newest: Option<NewestGaze>,
    times: SampleTimes,
    /// Sample times for the application, which asks for other display times than the plans of frames.
    application_times: SampleTimes,
}

/// Its status: no direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OscStatus {
    /// Address at which it receives, or should; `None` if it should not.
    pub address: Option<SocketAddr>,
    /// Reason why it does not receive.
    pub failure: Option<ErrorKind>,
    /// Of the sender's messages.
    pub format: Option<Format>,
    /// Directions a second, Hz; 0: not known, or there are none.
    pub rate_hz: f32,
    /// Packets.
    pub counts: OscCounts,
}

impl OscSource {
    /// Takes the address to listen at, if any. Returns whether a listener is to be begun, by [`Listener::begin`] and
    /// [`OscSource::opened`], and a listener to drop, which may wait.
    pub fn want(
        &mut self,
        wanted: Option<SocketAddr>,
        scale_deg: f32,
        now: Instant,
    ) -> (bool, Option<Listener>) {
        let mut ended = None;
        if self.wanted != wanted {
            ended = self.close();
            self.wanted = wanted;
        }
        if let Some(listener) = &self.listener {
            listener.set_scale(scale_deg);
        }
        let may_try = self.failure.is_none_or(|(_, since)| now.saturating_duration_since(since) >= RETRY);
        (wanted.is_some() && self.listener.is_none() && may_try, ended)
    }

    /// Takes the result of opening a listener at `address`. Returns whether it is a new failure.
    pub fn opened(&mut self, address: SocketAddr, listener: std::io::Result<Listener>, now: Instant) -> bool {
        if self.wanted != Some(address) {
            return false;
        }
        match listener {
            Ok(listener) => {
                self.listener = Some(listener);
                self.failure = None;
                false
            }
            Err(error) => {
                let is_news = self.failure.is_none_or(|(kind, _)| kind != error.kind());
                self.failure = Some((error.kind(), now));
                is_news
            }
        }
    }

    /// Ends it; the caller drops the listener.
    pub fn close(&mut self) -> Option<Listener> {
        let listener = self.listener.take();
        *self = Self::default();
        listener
    }

    /// Whether it receives.
    pub fn is_open(&self) -> bool {
        self.listener.is_some()
    }

    /// The gaze for a frame that is shown at `time_ns`.
    pub fn look(&mut self, time_ns: i64, delay: PacketDelay) -> Look {
        match self.newest() {
            Some(newest) => newest.look(&mut self.times, time_ns, delay),
            None => Look::NoTracker,
        }
    }

    /// The same for the application, at times of its own.
    pub fn application_look(&mut self, time_ns: i64, delay: PacketDelay) -> Look {
        match self.newest() {
            Some(newest) => newest.look(&mut self.application_times, time_ns, delay),
            None => Look::NoTracker,
        }
    }

    /// Whether a sender is active.
    pub fn has_sender(&mut self) -> bool {
        self.newest().is_some_and(NewestGaze::is_fresh)
    }

    fn newest(&mut self) -> Option<NewestGaze> {
        self.newest = self.listener.as_ref().and_then(Listener::newest).or(self.newest);
        self.newest.filter(|_| self.is_open())
    }

    /// Its status.
    pub fn status(&self) -> OscStatus {
        let look = self.newest.map(|newest| newest.look).unwrap_or_default();
        let is_there = self.newest.is_some_and(NewestGaze::is_fresh);
        OscStatus {
            address: self.wanted,
            failure: self.failure.map(|(kind, _)| kind),
            format: look.format.filter(|_| is_there),
            rate_hz: if is_there { look.rate_hz } else { 0.0 },
            counts: look.counts,
        }
    }
}

impl NewestGaze {
    /// Whether its sender has not ended.
    fn is_fresh(self) -> bool {
        self.age.is_some_and(|age| age < ENDED)
    }

    /// The gaze by this state, for a frame that is shown at `time_ns`.
    pub fn look(self, times: &mut SampleTimes, time_ns: i64, delay: PacketDelay) -> Look {
        let Some(age) = self.age.filter(|age| *age < ENDED) else { return Look::NoTracker };
        let PacketDelay { delay_ns, uncertainty_ns } = delay;
        let sampled_ns = times.of(self.look.serial, age.as_nanos() as i64, time_ns, delay_ns);
        let at = |direction| Look::At { direction, sampled_ns, uncertainty_ns };
        self.look.direction.map_or(Look::Unseen, at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_that_is_taken_is_tried_again_and_told_once() {
        let (address, now) = (SocketAddr::from(([127, 0, 0, 1], 9)), Instant::now());
        let mut source = OscSource::default();
        let fails = || Err(ErrorKind::AddrInUse.into());
        assert!(source.want(Some(address), 45.0, now).0);
        assert!(source.opened(address, fails(), now));
        assert_eq!(source.status().failure, Some(ErrorKind::AddrInUse));
        assert!(!source.want(Some(address), 45.0, now + RETRY / 2).0);
        assert!(source.want(Some(address), 45.0, now + RETRY).0);
        assert!(!source.opened(address, fails(), now + RETRY), "known already");
        assert_eq!(source.look(0, PacketDelay::ASSUMED), Look::NoTracker);
        // Another address is tried at once; nowhere, nothing is.
        let other = SocketAddr::from(([127, 0, 0, 1], 10));
        assert!(source.want(Some(other), 45.0, now + RETRY).0);
        assert!(!source.want(None, 45.0, now + 9 * RETRY).0);
        assert_eq!(source.status(), OscStatus::default());
    }

    #[test]
    fn a_listener_ends_where_none_is_wanted() {
        let (now, any) = (Instant::now(), SocketAddr::from(([127, 0, 0, 1], 0)));
        let mut source = OscSource::default();
        assert!(source.want(Some(any), 45.0, now).0);
        assert!(!source.opened(any, Listener::begin(any, 45.0), now));
        assert!(source.is_open() && !source.want(Some(any), 30.0, now).0);
        assert!(source.want(None, 45.0, now).1.is_some() && !source.is_open());
    }
}
