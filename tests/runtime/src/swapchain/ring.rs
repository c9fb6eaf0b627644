//! The order of a swapchain's images (OpenXR, "Swapchain Image Management").

use crate::fault::{Fault, section};
use std::collections::VecDeque;

/// Images that the application has acquired.
#[derive(Clone, Debug)]
pub(crate) struct Ring {
    count: u32,
    is_static: bool,
    /// Acquired and not released, the oldest first.
    acquired: VecDeque<u32>,
    /// Whether the oldest one was waited for.
    waited: bool,
    /// Images acquired so far.
    acquisitions: u64,
    /// The image released last.
    shown: Option<u32>,
}

impl Ring {
    pub fn new(count: u32, is_static: bool) -> Self {
        Self { count, is_static, acquired: VecDeque::new(), waited: false, acquisitions: 0, shown: None }
    }

    /// Index of the last released image, which layers show.
    pub fn shown(&self) -> Option<u32> {
        self.shown
    }

    pub fn acquire(&mut self) -> Result<u32, Fault> {
        if self.is_static && self.acquisitions > 0 {
            return Err(Fault::order(
                section::SWAPCHAINS,
                "the image of a static swapchain was acquired before",
            ));
        }
        if self.acquired.len() == self.count as usize {
            let message = format!("all {} images are acquired", self.count);
            return Err(Fault::order(section::SWAPCHAINS, message));
        }
        let index = (self.acquisitions % u64::from(self.count)) as u32;
        self.acquisitions += 1;
        self.acquired.push_back(index);
        Ok(index)
    }

    /// Whether there is an image to wait for.
    pub fn check_wait(&self) -> Result<(), Fault> {
        if self.acquired.is_empty() {
            return Err(Fault::order(section::SWAPCHAINS, "no image is acquired"));
        }
        if self.waited {
            let message = "the image waited for before is not released: one may be held at a time";
            return Err(Fault::order(section::SWAPCHAINS, message));
        }
        Ok(())
    }

    pub fn wait(&mut self) -> Result<(), Fault> {
        self.check_wait()?;
        self.waited = true;
        Ok(())
    }

    pub fn release(&mut self) -> Result<(), Fault> {
        if !self.waited {
            return Err(Fault::order(section::SWAPCHAINS, "no image was waited for since the last release"));
        }
        self.waited = false;
        self.shown = self.acquired.pop_front();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_come_in_order_and_the_oldest_is_waited_for_and_released_first() {
        let mut ring = Ring::new(3, false);
        assert_eq!([ring.acquire(), ring.acquire(), ring.acquire()], [Ok(0), Ok(1), Ok(2)]);
        assert!(ring.acquire().is_err());
        ring.wait().unwrap();
        assert!(ring.wait().is_err());
        ring.release().unwrap();
        assert_eq!((ring.shown(), ring.acquire()), (Some(0), Ok(0)));
        assert!(ring.release().is_err());
    }

    #[test]
    fn a_static_image_is_acquired_once() {
        let mut ring = Ring::new(1, true);
        ring.acquire().unwrap();
        ring.wait().unwrap();
        ring.release().unwrap();
        assert!(ring.acquire().is_err());
        assert_eq!(ring.shown(), Some(0));
    }
}
