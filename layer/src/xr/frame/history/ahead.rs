//! Sorting the tiles of eye images ahead of xrEndFrame. A planned frame has known stale tiles, and views that applications rarely change. A
//! thread of ours sorts the tiles while the application draws; xrEndFrame takes its lists if stale tiles, views and earlier images are as
//! expected, and sorts the tiles itself if not: the result is the same. The application's thread copies one set of tiles for each eye,
//! wakes the thread, and may wait for it.

use super::lists::EyeLists;
use super::{Completing, Kept};
use crate::planning::{self, Watched};
use glam::{Quat, Vec2};
use parafovea_core::geometry::{ImagePlane, View};
use parafovea_core::reuse::{Picture, StaleTiles, Viewpoint};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// The expected next picture of an eye.
pub struct Expected<'a> {
    /// Settings of its completion.
    pub how: Completing,
    /// The directions to compare with earlier pictures.
    pub watched: Option<Watched>,
    /// Pose and field of view; the image has the size of the last one.
    pub view: planning::View,
    /// Writes its stale tiles.
    pub stale: &'a dyn Fn(&mut StaleTiles),
}

/// The work for a frame.
#[derive(Debug, Default)]
pub struct Job {
    eyes: [EyeJob; 2],
}

/// The work for a picture of an eye.
#[derive(Debug, Default)]
struct EyeJob {
    how: Option<Completing>,
    watched: Option<Watched>,
    /// The newest first; entries from `len` on are spare memory.
    pictures: Vec<Input>,
    len: usize,
    lists: EyeLists,
}

/// The properties of a picture that tiles are sorted by.
#[derive(Clone, Debug)]
struct Input {
    /// [`Kept::number`]; 0 of the expected one.
    number: u64,
    view: View,
    extent: [u32; 2],
    stale: StaleTiles,
    viewpoint: Option<Viewpoint>,
}

impl Job {
    /// Forgets what was expected of both eyes.
    fn clear(&mut self) {
        self.eyes.iter_mut().for_each(|eye| eye.how = None);
    }

    fn run(&mut self) {
        for eye in &mut self.eyes {
            if let Some(how) = eye.how {
                let pictures = eye.pictures[..eye.len].iter().map(Input::picture);
                eye.lists.update(pictures, how, eye.watched.as_ref());
            }
        }
    }

    /// Expects another picture of an eye after `pictures`, of which as many will be given up as `lost` were with the last one.
    pub(super) fn expect(&mut self, eye: usize, pictures: &[Kept], lost: usize, expected: Expected) {
        let Some(last) = pictures.first() else { return };
        let eye = &mut self.eyes[eye];
        let Expected { how, watched, view: planning::View { orientation, position, fov }, stale } = expected;
        let earlier = &pictures[..pictures.len().saturating_sub(lost)];
        (eye.how, eye.watched, eye.len) = (Some(how), watched, 1 + earlier.len());
        // What was the newest comes second now, with all others after it: those that are there already need no copy.
        eye.pictures.resize_with(eye.pictures.len().max(eye.len), Input::default);
        eye.pictures.rotate_right(1);
        for (input, kept) in eye.pictures[1..eye.len].iter_mut().zip(earlier) {
            input.viewpoint = kept.viewpoint();
            if input.number != kept.number {
                (input.number, input.view, input.extent) = (kept.number, kept.view, kept.extent);
                input.stale.clone_from(&kept.stale);
            }
        }
        let newest = &mut eye.pictures[0];
        stale(&mut newest.stale);
        (newest.number, newest.extent) = (0, last.extent);
        newest.view = View { orientation, plane: fov.tangents().plane(last.extent) };
        newest.viewpoint = last.viewpoint().map(|last| Viewpoint { position_m: position, ..last });
    }

    /// Puts the lists of an eye that were worked out into `lists` if they are those of `pictures`. Whether they are; each is there once.
    pub(super) fn take(
        &mut self,
        eye: usize,
        pictures: &[Kept],
        how: Completing,
        watched: Option<&Watched>,
        lists: &mut EyeLists,
    ) -> bool {
        let eye = &mut self.eyes[eye];
        let inputs = &eye.pictures[..eye.len];
        let is_same = |(index, (input, kept)): (usize, (&Input, &Kept))| {
            input.viewpoint == kept.viewpoint()
                && match index {
                    0 => (input.view, input.extent) == (kept.view, kept.extent) && input.stale == kept.stale,
                    _ => input.number == kept.number,
                }
        };
        let is_known = eye.how == Some(how)
            && eye.watched.as_ref() == watched
            && inputs.len() == pictures.len()
            && inputs.iter().zip(pictures).enumerate().all(is_same);
        if is_known {
            eye.how = None;
            std::mem::swap(lists, &mut eye.lists);
        }
        is_known
    }
}

impl Input {
    fn picture(&self) -> Picture<'_> {
        Picture { view: self.view, extent: self.extent, stale: &self.stale, viewpoint: self.viewpoint }
    }
}

impl Default for Input {
    fn default() -> Self {
        let plane = ImagePlane { origin: Vec2::ZERO, step: Vec2::ONE };
        Self {
            number: 0,
            view: View { orientation: Quat::IDENTITY, plane },
            extent: [0; 2],
            stale: StaleTiles::default(),
            viewpoint: None,
        }
    }
}

/// The thread that works ahead, for one session: from the first frame on that it is asked for, until this is dropped.
#[derive(Debug, Default)]
pub struct Ahead {
    shared: Arc<Shared>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

/// A thread takes about so long to wake up. Frames that end that soon after they were planned wait for it: to sort the tiles takes as long,
/// and the time of the application's thread.
const LONGEST_WAKE: Duration = Duration::from_micros(150);

/// Who has the work.
#[derive(Debug, Default)]
enum State {
    /// A call of the application.
    #[default]
    Lent,
    /// Nobody, and it is not wanted.
    Idle(Box<Job>),
    /// The thread shall take it.
    Waiting(Box<Job>),
    /// The thread does it.
    UnderWay,
    /// Nobody, and it is done.
    Done(Box<Job>),
    /// The thread ends.
    Ended,
}

impl Ahead {
    /// Hands work over that `expect` fills in, whatever became of the last; it is left out where it would have to be waited for, or where
    /// there is no thread.
    pub fn begin(&self, expect: impl FnOnce(&mut Job)) {
        if !self.has_thread() {
            return;
        }
        let mut state = self.shared.lock();
        let mut job = match std::mem::take(&mut *state) {
            State::Idle(job) | State::Waiting(job) | State::Done(job) => job,
            // Before the first frame.
            State::Lent => Box::default(),
            other @ (State::UnderWay | State::Ended) => {
                *state = other;
                return;
            }
        };
        drop(state);
        job.clear();
        expect(&mut job);
        *self.shared.lock() = State::Waiting(job);
        self.shared.changed.notify_all();
    }

    /// Calls `act` with the work of this frame, after waiting for its end; with `None` if it has not begun within [`LONGEST_WAKE`].
    pub fn finish<T>(&self, act: impl FnOnce(Option<&mut Job>) -> T) -> T {
        let Shared { changed, .. } = &*self.shared;
        let is_open = |state: &mut State| matches!(state, State::Waiting(_));
        let waited = changed.wait_timeout_while(self.shared.lock(), LONGEST_WAKE, is_open);
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        while matches!(*state, State::UnderWay) {
            state = changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        let (mut job, is_done) = match std::mem::take(&mut *state) {
            State::Done(job) => (job, true),
            // The machine is busy: here it is done as fast.
            State::Idle(job) | State::Waiting(job) => (job, false),
            other => {
                *state = other;
                drop(state);
                return act(None);
            }
        };
        drop(state);
        let result = act(Some(&mut *job).filter(|_| is_done));
        *self.shared.lock() = State::Idle(job);
        result
    }

    fn has_thread(&self) -> bool {
        let mut thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner);
        if thread.is_none() {
            let shared = Arc::clone(&self.shared);
            let built = std::thread::Builder::new().name("parafovea-tiles".to_owned());
            *thread = built.spawn(move || shared.work()).ok();
        }
        thread.is_some()
    }
}

impl Drop for Ahead {
    fn drop(&mut self) {
        *self.shared.lock() = State::Ended;
        self.shared.changed.notify_all();
        let thread = self.thread.get_mut().unwrap_or_else(PoisonError::into_inner).take();
        // A thread that panicked has said so in its own words.
        _ = thread.map(JoinHandle::join);
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Works until the end.
    fn work(&self) {
        let mut state = self.lock();
        loop {
            match std::mem::replace(&mut *state, State::UnderWay) {
                State::Waiting(mut job) => {
                    drop(state);
                    let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(move || {
                        job.run();
                        job
                    }));
                    state = self.lock();
                    if !matches!(*state, State::Ended) {
                        *state = done.map_or(State::Ended, State::Done);
                    }
                    self.changed.notify_all();
                }
                State::Ended => {
                    *state = State::Ended;
                    return;
                }
                other => {
                    *state = other;
                    state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
