//! Draws, counted by pass, and the attachments that they may read: the evidence that distinguishes the scene from full-screen passes and textures.
//!
//! Engines draw ten thousand times a frame, so the counts of the pass that a thread records are the thread's own: a draw adds to them
//! without a lock or a look-up. They go to the command buffer where the pass ends, and where the thread continues another.

mod cached_device;
mod hooks;
mod pushed;

pub use cached_device::{cached_device, device_ends, device_made};
pub use hooks::*;
pub use pushed::push;

use super::{Buffer, buffer, untracked};
use crate::pass_detection::{Draws, Reads};
use ash::vk;
use ash::vk::Handle;
use std::cell::Cell;
use std::ptr;

/// Draws of one pass, or of a part of it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// As [`Draws::quads`].
    pub quads: u32,
    /// As [`Draws::meshes`].
    pub meshes: u32,
    /// As [`Draws::vertices`].
    pub vertices: u32,
}

impl Counts {
    /// Of one draw.
    #[inline]
    const fn of(vertices: u32, instances: u32) -> Self {
        let is_quad = vertices <= Draws::QUAD_VERTICES && instances <= 2;
        Self { quads: is_quad as u32, meshes: !is_quad as u32, vertices: vertices.saturating_mul(instances) }
    }

    /// Of draws that only the GPU knows.
    pub const INDIRECT: Self = Self { quads: 0, meshes: 1, vertices: Draws::INDIRECT_VERTICES };

    /// Adds more draws.
    #[inline]
    pub fn add(&mut self, more: Self) {
        self.quads = self.quads.saturating_add(more.quads);
        self.meshes = self.meshes.saturating_add(more.meshes);
        self.vertices = self.vertices.saturating_add(more.vertices);
    }
}

/// The draws of the pass that is being recorded, as its command buffer keeps them.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    counts: Counts,
    /// Reads of quads, and of other draws.
    reads: [Reads; 2],
    /// The thread that counts; 0: none yet.
    thread: usize,
    /// The last thread that is known to have recorded the command buffer; 0: none.
    recorder: usize,
    /// Whether draws were counted on several threads, and some counts are lost.
    is_lost: bool,
}

impl Tally {
    /// Adds the draws of a secondary command buffer.
    pub fn execute(&mut self, secondary: &Self) {
        self.counts.add(secondary.counts);
        self.is_lost |= secondary.is_lost;
        for (reads, more) in self.reads.iter_mut().zip(&secondary.reads) {
            reads.add(more);
        }
    }

    /// The draws that were handed over so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// All of a pass that ends; `None` if some are lost.
    pub fn finish(&mut self) -> Option<Draws> {
        let next = Self { recorder: self.recorder, ..Self::default() };
        let Self { counts, reads, is_lost, .. } = std::mem::replace(self, next);
        let Counts { quads, meshes, vertices } = counts;
        let [read_by_quads, read_by_meshes] = reads;
        (!is_lost).then_some(Draws { quads, meshes, vertices, read_by_quads, read_by_meshes })
    }
}

/// Numbers of sets that are followed: the limit of common devices (maxBoundDescriptorSets).
const SETS: usize = 8;

/// The bound sets of a command buffer.
#[derive(Clone, Copy)]
struct Bound {
    /// The command buffer; 0: none.
    within: u64,
    /// As [`Open::sets`].
    sets: [u64; SETS],
    /// As [`Open::is_unknown`].
    is_unknown: bool,
}

impl Bound {
    const NOTHING: Self = Self { within: 0, sets: [0; SETS], is_unknown: false };
}

/// The counts of the thread, and its bound sets.
struct Open {
    /// The command buffer whose pass it is; 0: none.
    handle: Cell<u64>,
    counts: Cell<Counts>,
    /// The command buffer that the thread binds sets in; 0: none.
    bound_in: Cell<u64>,
    /// The bound sets that may have attachments; 0 for others.
    sets: [Cell<u64>; SETS],
    /// Whether something is bound that is not among `sets`.
    is_unknown: Cell<bool>,
    /// The bound sets of the command buffer before that one: uploads are often recorded beside a frame.
    kept: Cell<Bound>,
    /// Whether a set with attachments or unknown content is bound, or the bound sets differ from the sets of the pass.
    may_read: Cell<bool>,
    /// Whether the bound sets were noted as read by quads, and by other draws, but for unknown content.
    noted: [Cell<bool>; 2],
    /// Whether the reads of the pass by quads, and by other draws, have unknown ones.
    has_unknown: [Cell<bool>; 2],
}

thread_local! {
    static OPEN: Open = const {
        Open {
            handle: Cell::new(0),
            counts: Cell::new(Counts { quads: 0, meshes: 0, vertices: 0 }),
            bound_in: Cell::new(0),
            sets: [const { Cell::new(0) }; SETS],
            is_unknown: Cell::new(false),
            kept: Cell::new(Bound::NOTHING),
            may_read: Cell::new(false),
            noted: [const { Cell::new(false) }; 2],
            has_unknown: [const { Cell::new(false) }; 2],
        }
    };
}

impl Open {
    /// Names the thread: the address of its counts.
    fn thread(&self) -> usize {
        ptr::from_ref(self).addr()
    }

    /// Nothing is bound in a command buffer, or something unknown.
    fn forget_bound(&self, raw: u64, is_unknown: bool) {
        if self.bound_in.get() != raw {
            self.kept.set(self.bound());
        }
        self.take_bound(Bound { within: raw, is_unknown, ..Bound::NOTHING });
    }

    /// The thread goes on in a command buffer, with the sets that it bound there before.
    fn turn_to(&self, raw: u64) {
        if self.bound_in.get() != raw {
            let kept = self.kept.replace(self.bound());
            let unknown = Bound { within: raw, is_unknown: true, ..Bound::NOTHING };
            self.take_bound(if kept.within == raw { kept } else { unknown });
        }
    }

    /// Something is bound that is not followed.
    fn bind_unknown(&self) {
        if !self.is_unknown.get() {
            self.forget_bound(self.bound_in.get(), true);
        }
    }

    fn bound(&self) -> Bound {
        let sets = self.sets.each_ref().map(Cell::get);
        Bound { within: self.bound_in.get(), sets, is_unknown: self.is_unknown.get() }
    }

    fn take_bound(&self, bound: Bound) {
        self.bound_in.set(bound.within);
        self.sets.iter().zip(bound.sets).for_each(|(set, bound)| set.set(bound));
        self.is_unknown.set(bound.is_unknown);
        self.is_bound_anew(true);
    }

    /// Updates the flags after other sets were bound, with known attachments or without. A pass with noted unknown reads learns nothing from more
    /// of them: with sets of unknown content, as DXVK has, each draw would be noted.
    fn is_bound_anew(&self, names_attachments: bool) {
        let is_elsewhere = ![0, self.bound_in.get()].contains(&self.handle.get());
        let is_any_bound = self.is_unknown.get() || self.sets.iter().any(|set| set.get() != 0);
        self.may_read.set(is_elsewhere || is_any_bound);
        for (noted, has_unknown) in self.noted.iter().zip(&self.has_unknown) {
            noted.set(noted.get() && has_unknown.get() && !names_attachments && !is_elsewhere);
        }
    }

    /// The thread draws in a pass of a command buffer, with the sets that it bound there before. Returns the command buffer of its last pass, and
    /// the counts of that.
    fn draws_in(&self, raw: u64) -> (u64, Counts) {
        let before = (self.handle.replace(raw), self.counts.replace(Counts::default()));
        self.turn_to(raw);
        self.has_unknown.iter().for_each(|flag| flag.set(false));
        self.is_bound_anew(true);
        before
    }
}

/// The outcome of counting a draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Counted {
    /// The draw is counted, or is not to be.
    Done,
    /// The reads of the bound sets have to be noted first.
    ReadsNotNoted,
    /// The thread records no pass of that command buffer.
    Elsewhere,
}

/// Counts a draw of the pass that this thread records.
#[inline]
fn count(handle: vk::CommandBuffer, more: Counts) -> Counted {
    let raw = handle.as_raw();
    let add = |open: &Open| {
        if open.handle.get() != raw {
            return if untracked::is_here(handle) { Counted::Done } else { Counted::Elsewhere };
        }
        if open.may_read.get() && !open.noted[usize::from(more.meshes > 0)].get() {
            return Counted::ReadsNotNoted;
        }
        let mut counts = open.counts.get();
        counts.add(more);
        open.counts.set(counts);
        Counted::Done
    };
    OPEN.try_with(add).unwrap_or(Counted::Elsewhere)
}

/// Notes the bound sets as read by a kind of draws.
fn add_reads(of: &Buffer, handle: vk::CommandBuffer, more: Counts) {
    let _ = OPEN.try_with(|open| {
        open.turn_to(handle.as_raw());
        let kind = usize::from(more.meshes > 0);
        open.noted[kind].set(true);
        let reads = &mut of.recorded().tally.reads[kind];
        reads.may_read_more |= open.is_unknown.get();
        for set in open.sets.iter().map(Cell::get).filter(|set| *set != 0) {
            of.armed.objects.descriptors.read(vk::DescriptorSet::from_raw(set), reads);
        }
        open.has_unknown[kind].set(reads.may_read_more);
    });
}

/// Recording of a command buffer begins, or goes on after secondaries: nothing is bound.
pub fn recording_begins(of: &Buffer, handle: vk::CommandBuffer) {
    // SAFETY: a live command buffer, as it is recorded.
    let is_followed = unsafe { cached_device(handle) }.is_some();
    let thread = OPEN.try_with(|open| {
        open.forget_bound(handle.as_raw(), !is_followed);
        open.thread()
    });
    of.recorded().tally.recorder = thread.unwrap_or(0);
}

/// Begins the recording of a command buffer whose commands are not tracked: its draws count for no pass.
pub fn untracked_begins(handle: vk::CommandBuffer) {
    let raw = handle.as_raw();
    let took = OPEN.try_with(|open| {
        let before = (open.handle.replace(raw), open.counts.replace(Counts::default()));
        open.forget_bound(raw, false);
        before
    });
    if let Ok((before, counts)) = took {
        hand_over(before, counts, raw);
    }
}

/// The thread leaves the pass of a command buffer, 0 if none, with these counts, for that of another one.
fn hand_over(before: u64, counts: Counts, next: u64) {
    if before != 0
        && before != next
        && let Some(other) = buffer(vk::CommandBuffer::from_raw(before))
    {
        other.recorded().tally.counts.add(counts);
    }
}

/// Sets are bound for drawing from number `first` on.
///
/// # Safety
///
/// `handle` is a live command buffer.
#[inline]
pub unsafe fn bind(handle: vk::CommandBuffer, first: u32, sets: &[vk::DescriptorSet]) {
    // SAFETY: the handle is live, as `# Safety` demands.
    let Some(armed) = (unsafe { cached_device(handle) }) else { return };
    if untracked::is_here(handle) {
        return;
    }
    let descriptors = &armed.objects.descriptors;
    let raw = handle.as_raw();
    let _ = OPEN.try_with(|open| {
        open.turn_to(raw);
        let (mut is_changed, mut names_attachments) = (false, false);
        for (number, set) in (first as usize..).zip(sets) {
            let may_read = descriptors.may_read(*set);
            match open.sets.get(number) {
                Some(bound) => {
                    let now = if may_read { set.as_raw() } else { 0 };
                    is_changed |= bound.replace(now) != now;
                    names_attachments |= may_read && descriptors.may_name(*set);
                }
                None if may_read && !open.is_unknown.replace(true) => is_changed = true,
                None => {}
            }
        }
        if is_changed {
            open.is_bound_anew(names_attachments);
        }
    });
}

/// Something is bound for drawing that is not followed.
pub fn bind_unknown(handle: vk::CommandBuffer) {
    let raw = handle.as_raw();
    let _ = OPEN.try_with(|open| {
        open.turn_to(raw);
        open.bind_unknown();
    });
}

/// Continues the pass of a command buffer on this thread, or begins it.
fn take_up(of: &Buffer, handle: vk::CommandBuffer, begins: bool) {
    let raw = handle.as_raw();
    let took = OPEN.try_with(|open| (open.draws_in(raw), open.thread()));
    let Ok(((before, counts), thread)) = took else { return };
    hand_over(before, counts, raw);
    let tally = &mut of.recorded().tally;
    if ![0, thread].contains(&tally.recorder) {
        // That thread may have bound others.
        let _ = OPEN.try_with(|open| open.forget_bound(raw, true));
    }
    tally.recorder = thread;
    if begins {
        *tally = Tally { thread, recorder: thread, ..Tally::default() };
    } else {
        tally.is_lost |= tally.thread != 0 && tally.thread != thread;
        tally.thread = thread;
    }
}

/// A pass begins.
pub fn pass_begins(of: &Buffer, handle: vk::CommandBuffer) {
    if of.armed.follows_passes() {
        take_up(of, handle, true);
    }
}

/// A pass has ended, or a secondary command buffer: the thread's counts go to it.
pub fn settle(of: &Buffer, handle: vk::CommandBuffer) {
    if !of.armed.follows_passes() {
        return;
    }
    let raw = handle.as_raw();
    let took = OPEN.try_with(|open| {
        let is_this = open.handle.get() == raw;
        let counts = open.counts.get();
        if is_this {
            open.handle.set(0);
            open.counts.set(Counts::default());
        }
        (is_this, counts, open.thread())
    });
    let tally = &mut of.recorded().tally;
    match took {
        Ok((true, counts, _)) => tally.counts.add(counts),
        Ok((false, _, thread)) => tally.is_lost |= tally.thread != 0 && tally.thread != thread,
        Err(_) => tally.is_lost = true,
    }
}

/// Number of draws so far of the pass that is being recorded, or of a secondary that continues one.
pub fn counted(of: &Buffer, handle: vk::CommandBuffer) -> u32 {
    let counts = counts(of, handle);
    counts.quads.wrapping_add(counts.meshes)
}

/// Draws so far of the pass that is being recorded, or of a secondary that continues one.
pub fn counts(of: &Buffer, handle: vk::CommandBuffer) -> Counts {
    let of_thread = OPEN.try_with(|open| {
        let is_this = open.handle.get() == handle.as_raw();
        is_this.then(|| open.counts.get())
    });
    let mut counts = of.recorded().tally.counts;
    counts.add(of_thread.ok().flatten().unwrap_or_default());
    counts
}

/// Counts a draw that needs more than the thread's counts.
pub fn count_tracked(of: &Buffer, handle: vk::CommandBuffer, more: Counts) {
    let mut counted = count(handle, more);
    if counted == Counted::Elsewhere && of.may_draw() {
        take_up(of, handle, false);
        counted = count(handle, more);
    }
    if counted == Counted::ReadsNotNoted {
        add_reads(of, handle, more);
        count(handle, more);
    }
}

#[cfg(test)]
mod tests;
