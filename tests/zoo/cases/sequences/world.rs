//! Objects of a sequence, and the calls that are possible next.

mod frames;
mod sessions;
mod swapchains;

use super::{Manner, Numbers};
use crate::app::App;
use crate::failure::name;
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ffi::c_void;
use std::ptr::null;

/// Calls of a sequence.
const STEPS: usize = 40;

/// The longest chain of unknown structures: longer ones have a cycle in the runtime's eyes.
const LONGEST_CHAIN: usize = 64;

/// Numbers of structures that no extension has.
const UNKNOWN_TYPE: i32 = 1_999_000_000;

struct Session {
    handle: xr::Session,
    space: xr::Space,
    state: xr::SessionState,
    is_running: bool,
    waited: Option<xr::Time>,
    begun: Option<xr::Time>,
}

struct Swapchain {
    handle: xr::Swapchain,
    session: xr::Session,
    size: [u32; 2],
    is_color: bool,
    acquired: usize,
    is_waited: bool,
    is_released: bool,
    is_static: bool,
}

/// A sequence in progress.
pub struct World<'a> {
    app: &'a App,
    numbers: Numbers,
    manner: Manner,
    sessions: Vec<Session>,
    swapchains: Vec<Swapchain>,
    /// Handles that were destroyed.
    gone: Vec<u64>,
    trace: Vec<String>,
}

/// A structure of an unknown type.
#[repr(C)]
struct Unknown {
    ty: i32,
    next: *const c_void,
}

impl<'a> World<'a> {
    pub fn new(app: &'a App, numbers: Numbers, manner: Manner) -> Self {
        let (sessions, swapchains) = (Vec::new(), Vec::new());
        Self { app, numbers, manner, sessions, swapchains, gone: Vec::new(), trace: Vec::new() }
    }

    /// Makes the calls.
    pub fn run(&mut self) {
        for _ in 0..STEPS {
            match self.numbers.below(16) {
                0 => self.create_session(),
                1 => self.begin_session(),
                2 => self.create_swapchain(),
                3 => self.destroy_swapchain(),
                4 => self.end_session(),
                5 | 6 => self.frame_step(),
                7 => self.locate_views(),
                8 => self.enumerate_images(),
                9 | 10 => self.acquire(),
                11 => self.wait_image(),
                12 => self.release(),
                13 => self.end_frame(),
                14 => self.poll(),
                _ => self.whole_frame(),
            }
        }
    }

    /// Destroys all remaining objects, and returns the results of the calls.
    pub fn end(mut self) -> Vec<String> {
        while let Some(session) = self.sessions.pop() {
            self.destroy_session(session.handle);
        }
        self.poll();
        self.trace
    }

    fn is_hostile(&self) -> bool {
        self.manner == Manner::Hostile
    }

    /// Whether a call that is illegal now is made all the same.
    fn dares(&mut self) -> bool {
        self.is_hostile() && self.numbers.once_in(3)
    }

    fn told(&mut self, call: &str, result: xr::Result) -> bool {
        self.trace.push(format!("{call}: {}", name(result)));
        result.into_raw() >= 0
    }

    /// A handle, or in a hostile sequence perhaps another one.
    fn handle<H: Handle>(&mut self, handle: H) -> H {
        if !self.is_hostile() || !self.numbers.once_in(6) {
            return handle;
        }
        let others = [0, 0xdead_beef, u64::MAX, self.sessions.first().map_or(7, |one| one.handle.into_raw())];
        let gone = self.gone.get(self.numbers.below(self.gone.len())).copied();
        let other = others[self.numbers.below(others.len())];
        H::from_raw(if self.numbers.once_in(2) { gone.unwrap_or(other) } else { other })
    }

    /// A chain of an unknown structure, kept alive by the second value.
    fn chain(&mut self) -> (Vec<Unknown>, *const c_void) {
        let length = match self.numbers.below(4) {
            0 if self.is_hostile() => self.numbers.below(LONGEST_CHAIN),
            1 => self.numbers.below(3),
            _ => 0,
        };
        let mut chain: Vec<Unknown> =
            (0..length).map(|at| Unknown { ty: UNKNOWN_TYPE + at as i32, next: null() }).collect();
        for at in 1..length {
            chain[at - 1].next = (&raw const chain[at]).cast();
        }
        let first = if length == 0 { null() } else { chain.as_ptr().cast() };
        (chain, first)
    }

    fn session(&mut self) -> Option<usize> {
        let count = self.sessions.len();
        (count > 0).then(|| self.numbers.below(count))
    }

    fn swapchain(&mut self) -> Option<usize> {
        let count = self.swapchains.len();
        (count > 0).then(|| self.numbers.below(count))
    }
}
