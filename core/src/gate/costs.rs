//! What a few frames cost.

/// Up to 16 costs; when there is no room, the oldest goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Costs {
    values: [f64; Self::MOST],
    len: usize,
    room: usize,
}

impl Costs {
    const MOST: usize = 16;

    /// None yet, and room for so many, 1..=16.
    pub(super) fn new(room: usize) -> Self {
        Self { values: [0.0; Self::MOST], len: 0, room: room.clamp(1, Self::MOST) }
    }

    pub(super) fn push(&mut self, cost_ns: u64) {
        self.push_value(cost_ns as f64);
    }

    fn push_value(&mut self, value: f64) {
        if self.len == self.room {
            self.values.copy_within(1..self.len, 0);
            self.len -= 1;
        }
        self.values[self.len] = value;
        self.len += 1;
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds the newest `count` of these to `to`; false, and nothing done, where there are fewer.
    pub(super) fn newest(&self, count: usize, to: &mut Self) -> bool {
        let Some(first) = self.len.checked_sub(count) else { return false };
        self.values[first..self.len].iter().for_each(|&value| to.push_value(value));
        true
    }

    /// The median; NaN without any.
    pub(super) fn median(&self) -> f64 {
        let mut sorted = self.values;
        let sorted = &mut sorted[..self.len];
        sorted.sort_unstable_by(f64::total_cmp);
        let middle = self.len / 2;
        match self.len {
            0 => f64::NAN,
            len if len % 2 == 1 => sorted[middle],
            _ => (sorted[middle - 1] + sorted[middle]) / 2.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Costs;

    #[test]
    fn the_oldest_go_and_the_middle_counts() {
        let mut costs = Costs::new(4);
        assert!(costs.median().is_nan());
        [9, 1, 3, 100].into_iter().for_each(|cost| costs.push(cost));
        assert_eq!(costs.median(), 6.0);
        costs.push(2);
        assert_eq!((costs.len(), costs.median()), (4, 2.5));
        let mut newest = Costs::new(16);
        assert!(!costs.newest(5, &mut newest) && newest.len() == 0);
        assert!(costs.newest(3, &mut newest));
        assert_eq!(newest.median(), 3.0);
    }
}
