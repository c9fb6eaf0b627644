//! Selection of the frames whose passes are followed while the gates rest: no technique is on, and no trial is near.

/// Frames from one sample to the next, of a device that rests: about three seconds. The gate takes ten to detect another scene.
const PERIOD: u64 = 270;

/// Followed frames of a sample: as many as recognition needs for a new graph of passes, and one more, the first, some of whose passes may
/// have been submitted before it.
const SAMPLE: u64 = 12;

/// Followed frames of a device at the least, from its first on: recognition has settled, and has listed the passes.
const SETTLING: u64 = 240;

/// Selection of the followed frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rest {
    /// The frame since which the gates rest. None while they do not.
    since: Option<u64>,
}

impl Rest {
    /// Takes whether the gates rest, from `frame` on.
    pub fn set(&mut self, rests: bool, frame: u64) {
        self.since = if rests { self.since.or(Some(frame)) } else { None };
    }

    /// Whether the passes of a frame are noted.
    pub fn follows(self, frame: u64) -> bool {
        self.in_sample(frame).is_none_or(|place| place < SAMPLE)
    }

    /// Frames from `frame` on that are not followed.
    pub fn untracked_frames(self, frame: u64) -> u64 {
        let place = self.in_sample(frame).filter(|place| *place >= SAMPLE);
        place.map_or(0, |place| PERIOD - place)
    }

    /// Whether recognition learns from a frame: all of its passes were noted.
    pub fn learns(self, frame: u64) -> bool {
        self.in_sample(frame).is_none_or(|place| (1..SAMPLE).contains(&place))
    }

    /// Frames since the last sample began. None for frames outside of samples that are still followed.
    fn in_sample(self, frame: u64) -> Option<u64> {
        let rested = frame.saturating_sub(self.since?);
        (frame >= SETTLING && rested >= SAMPLE).then_some(rested % PERIOD)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn followed(rest: Rest, frames: std::ops::Range<u64>) -> (u64, u64) {
        let count = |is_meant: fn(Rest, u64) -> bool| {
            frames.clone().filter(|frame| is_meant(rest, *frame)).count() as u64
        };
        (count(Rest::follows), count(Rest::learns))
    }

    #[test]
    fn all_frames_are_followed_at_first_and_while_a_gate_is_at_work() {
        assert_eq!(followed(Rest::default(), 1000..2000), (1000, 1000));
        let mut rest = Rest::default();
        rest.set(true, 10);
        assert_eq!(followed(rest, 0..SETTLING), (SETTLING, SETTLING));
    }

    #[test]
    fn a_resting_device_is_sampled() {
        let mut rest = Rest::default();
        rest.set(true, 1000);
        assert_eq!(followed(rest, 1000..1000 + SAMPLE), (SAMPLE, SAMPLE), "maps become 1x1");
        assert_eq!(followed(rest, 1000 + PERIOD..1000 + 11 * PERIOD), (10 * SAMPLE, 10 * (SAMPLE - 1)));
        for frame in 1000..1000 + 3 * PERIOD {
            let until = (frame..).find(|frame| rest.follows(*frame)).unwrap();
            assert_eq!(rest.untracked_frames(frame), until - frame);
        }
        rest.set(true, 5000);
        assert!(!rest.follows(1000 + PERIOD - 1), "it has rested since frame 1000");
        rest.set(false, 5000);
        assert!(rest.follows(1000 + PERIOD - 1));
    }
}
