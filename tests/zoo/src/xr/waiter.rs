//! xrWaitFrame, on the thread that renders or on one of its own.

use crate::style::Threads;
use anyhow::{Context, Result};
use openxr as xr;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

/// The `xrWaitFrame` caller: the rendering thread, or one of its own.
pub enum Waiter {
    Here(xr::FrameWaiter),
    Apart(Apart),
}

/// The waiting thread, and the channels to it.
pub struct Apart {
    /// None once it is to end.
    ask: Option<SyncSender<()>>,
    answers: Receiver<xr::Result<xr::FrameState>>,
    thread: Option<JoinHandle<()>>,
}

impl Waiter {
    pub fn new(mut waiter: xr::FrameWaiter, threads: Threads) -> Self {
        if threads == Threads::One {
            return Self::Here(waiter);
        }
        let (ask, asked) = sync_channel(0);
        let (answer, answers) = sync_channel(1);
        let thread = std::thread::spawn(move || {
            // Ends when the renderer hangs up.
            while asked.recv().is_ok() && answer.send(waiter.wait()).is_ok() {}
        });
        Self::Apart(Apart { ask: Some(ask), answers, thread: Some(thread) })
    }

    /// Waits for the next frame.
    ///
    /// # Errors
    /// Errors of xrWaitFrame.
    pub fn wait(&mut self) -> Result<xr::FrameState> {
        match self {
            Self::Here(waiter) => Ok(waiter.wait()?),
            Self::Apart(apart) => {
                const GONE: &str = "the thread that waits for frames is gone";
                apart.ask.as_ref().and_then(|ask| ask.send(()).ok()).context(GONE)?;
                Ok(apart.answers.recv().context(GONE)??)
            }
        }
    }
}

impl Drop for Apart {
    /// The thread holds the session: it ends before the device goes.
    fn drop(&mut self) {
        self.ask = None;
        // A thread that panicked has said so.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}
