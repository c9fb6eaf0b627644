//! Which of the runtime's images the application has, where it gets them from the runtime itself.

use smallvec::SmallVec;

/// Images that were acquired and not released, and the one that was released last.
#[derive(Debug, Default)]
pub struct Turns {
    /// By index, in the order in which they are released: that in which they were acquired.
    acquired: SmallVec<[u32; 8]>,
    released: Option<u32>,
}

impl Turns {
    /// An image was acquired.
    pub fn acquired(&mut self, index: u32) {
        self.acquired.push(index);
    }

    /// An image was released.
    pub fn released(&mut self) {
        if !self.acquired.is_empty() {
            self.released = Some(self.acquired.remove(0));
        }
    }

    /// The image that was released last.
    pub fn newest(&self) -> Option<u32> {
        self.released
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_come_back_in_the_order_in_which_they_were_taken() {
        let mut turns = Turns::default();
        turns.released();
        assert_eq!(turns.newest(), None);
        for index in [2, 0, 1] {
            turns.acquired(index);
        }
        assert_eq!(turns.newest(), None);
        for expected in [2, 0, 1, 1] {
            turns.released();
            assert_eq!(turns.newest(), Some(expected));
        }
    }
}
