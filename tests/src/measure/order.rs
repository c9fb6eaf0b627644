//! The order of applications that have a frame each in turn.
//!
//! A frame takes less CPU time after one of the same application, whose data are still in the caches: in an order that is reversed from
//! frame to frame, first and last have two frames in a row, and cost 2 % less than the same application between them.

/// An order in which no player follows itself, unless it is alone, and each follows each other one about equally often: a design balanced
/// for carry-over effects (Williams, 1949), made step by step for any number of frames.
#[derive(Clone, Debug)]
pub struct FrameOrder {
    /// Number of times that a player followed another one: `follows[previous][next]`.
    follows: Vec<Vec<u32>>,
    /// Player that had the last frame.
    previous: Option<usize>,
}

impl FrameOrder {
    /// Order of so many players.
    pub fn of(players: usize) -> Self {
        Self { follows: vec![vec![0; players]; players], previous: None }
    }

    /// The players in the order of their next frame: each of them once.
    pub fn next_frame(&mut self) -> Vec<usize> {
        let mut left: Vec<usize> = (0..self.follows.len()).collect();
        let mut order = Vec::with_capacity(left.len());
        while let Some(place) = self.rarest(&left) {
            let next = left.remove(place);
            if let Some(previous) = self.previous.replace(next) {
                self.follows[previous][next] += 1;
            }
            order.push(next);
        }
        order
    }

    /// Index in `left` of the player that followed the previous one least often, the first of several; None if none is left.
    fn rarest(&self, left: &[usize]) -> Option<usize> {
        let Some(previous) = self.previous else { return (!left.is_empty()).then_some(0) };
        (0..left.len()).min_by_key(|&place| (left[place] == previous, self.follows[previous][left[place]]))
    }
}

#[cfg(test)]
mod tests {
    use super::FrameOrder;

    #[test]
    fn each_player_has_each_frame_and_follows_each_other_one_equally_often() {
        for players in 2..9 {
            let mut order = FrameOrder::of(players);
            for _ in 0..36 {
                let mut frame = order.next_frame();
                frame.sort_unstable();
                assert_eq!(frame, (0..players).collect::<Vec<_>>());
            }
            let expected = 36.0 / (players as f64 - 1.0);
            for (previous, counts) in order.follows.iter().enumerate() {
                assert_eq!(counts[previous], 0);
                let others = counts.iter().enumerate().filter(|&(next, _)| next != previous);
                for (_, &count) in others {
                    assert!((f64::from(count) - expected).abs() <= 2.0, "{players}: {:?}", order.follows);
                }
            }
        }
    }

    #[test]
    fn a_single_player_has_all_frames() {
        let mut order = FrameOrder::of(1);
        assert_eq!([order.next_frame(), order.next_frame()], [[0], [0]]);
    }
}
