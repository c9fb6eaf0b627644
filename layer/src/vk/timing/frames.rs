//! What the passes of frames took, as it becomes known.

use smallvec::SmallVec;

/// Frames that are kept; what an older one took is not waited for any longer.
const MOST: usize = 8;

/// What the timed passes of a frame, and our own work ahead of them, took together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameTime {
    /// Number of the frame.
    pub frame: u64,
    /// Nanoseconds on the GPU.
    pub ns: u64,
}

/// Frames whose passes were submitted, in their order. Allocates nothing.
#[derive(Debug, Default)]
pub struct FrameTimes {
    frames: SmallVec<[Frame; MOST]>,
}

#[derive(Debug, Clone, Copy)]
struct Frame {
    frame: u64,
    ns: u64,
    /// Submits whose timestamps were not read yet.
    pending: u32,
    /// Whether some will never be.
    is_incomplete: bool,
    /// Whether a pass of the application was among them: our own work alone is no frame.
    has_passes: bool,
}

impl FrameTimes {
    /// Timestamps of a frame were submitted, around passes of the application or around our own work.
    pub fn submitted(&mut self, frame: u64, has_passes: bool) {
        if let Some(known) = self.known(frame) {
            known.pending += 1;
            known.has_passes |= has_passes;
            return;
        }
        if self.frames.len() == MOST {
            self.frames.remove(0);
        }
        self.frames.push(Frame { frame, ns: 0, pending: 1, is_incomplete: false, has_passes });
    }

    /// Those of one submit were read; nothing where they cannot be.
    pub fn read(&mut self, frame: u64, ns: Option<u64>) {
        if let Some(known) = self.known(frame) {
            known.pending = known.pending.saturating_sub(1);
            known.ns = known.ns.saturating_add(ns.unwrap_or(0));
            known.is_incomplete |= ns.is_none();
        }
    }

    /// The next frame of which all is known, if there is one: those before `under_way`, to which nothing is added any more.
    pub fn take(&mut self, under_way: u64) -> Option<FrameTime> {
        loop {
            let done = self.frames.iter().position(|known| known.frame < under_way && known.pending == 0)?;
            let Frame { frame, ns, is_incomplete, has_passes, .. } = self.frames[done];
            // What is still waited for of earlier ones would come too late.
            self.frames.drain(..=done);
            if !is_incomplete && has_passes {
                return Some(FrameTime { frame, ns });
            }
        }
    }

    fn known(&mut self, frame: u64) -> Option<&mut Frame> {
        self.frames.iter_mut().find(|known| known.frame == frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_known_when_all_of_it_is_read_and_it_has_ended() {
        let mut times = FrameTimes::default();
        times.submitted(3, false);
        times.submitted(3, true);
        times.read(3, Some(10));
        assert_eq!(times.take(4), None);
        times.submitted(4, true);
        times.read(4, Some(7));
        times.read(3, Some(20));
        assert_eq!(times.take(4), Some(FrameTime { frame: 3, ns: 30 }));
        assert_eq!(times.take(4), None, "frame 4 may submit more");
        assert_eq!(times.take(5), Some(FrameTime { frame: 4, ns: 7 }));
    }

    #[test]
    fn what_cannot_be_read_leaves_the_frame_out() {
        let mut times = FrameTimes::default();
        (0..3).for_each(|frame| times.submitted(frame, true));
        times.read(0, None);
        times.read(2, Some(5));
        assert_eq!(times.take(3), Some(FrameTime { frame: 2, ns: 5 }), "1 is not waited for");
        times.read(1, Some(9));
        assert_eq!(times.take(3), None);
    }

    #[test]
    fn our_own_work_alone_is_no_frame() {
        let mut times = FrameTimes::default();
        times.submitted(0, false);
        times.read(0, Some(3));
        assert_eq!(times.take(1), None);
    }

    #[test]
    fn what_never_comes_is_forgotten() {
        let mut times = FrameTimes::default();
        for frame in 0..100 {
            times.submitted(frame, true);
            assert_eq!(times.take(frame), None);
        }
        assert_eq!(times.frames.len(), MOST);
        assert!(!times.frames.spilled());
    }
}
