//! Images of the runtime that the application has acquired, if it gets them from the runtime itself.

use smallvec::SmallVec;

/// Images that were acquired and not released, and the one that was released last.
#[derive(Debug, Default)]
pub struct AcquiredImages {
    /// By index, in the order in which they are released: that in which they were acquired.
    acquired: SmallVec<[u32; 8]>,
    is_waited: bool,
    released: Option<u32>,
}

impl AcquiredImages {
    /// An image was acquired.
    pub fn acquired(&mut self, index: u32) {
        self.acquired.push(index);
    }

    /// The image that was acquired first was waited for.
    pub fn waited(&mut self) {
        self.is_waited = true;
    }

    /// The image that is the application's to draw to, and is released next.
    pub fn ready(&self) -> Option<u32> {
        self.acquired.first().copied().filter(|_| self.is_waited)
    }

    /// The same, if no other image is acquired.
    pub fn ready_alone(&self) -> Option<u32> {
        self.ready().filter(|_| self.acquired.len() == 1)
    }

    /// An image was released.
    pub fn released(&mut self) {
        self.is_waited = false;
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
        let mut images = AcquiredImages::default();
        images.released();
        assert_eq!(images.newest(), None);
        for index in [2, 0, 1] {
            images.acquired(index);
        }
        assert_eq!(images.newest(), None);
        for expected in [2, 0, 1] {
            assert_eq!(images.ready(), None, "not waited for");
            images.waited();
            assert_eq!(images.ready(), Some(expected));
            assert_eq!(images.ready_alone(), Some(expected).filter(|last| *last == 1), "of three");
            images.released();
            assert_eq!(images.newest(), Some(expected));
        }
        assert_eq!(images.ready(), None);
        images.released();
        assert_eq!(images.newest(), Some(1), "one release too many");
    }
}
