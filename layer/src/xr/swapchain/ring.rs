//! The images of a virtual swapchain as the application takes and returns them.
//!
//! Source: "Swapchain Image Management" of the OpenXR specification. Images are acquired, waited for and released in one order, so three
//! counts are the whole state: acquisition `n` uses image `(n - 1) % count`.

/// The call is not allowed in this state: `XR_ERROR_CALL_ORDER_INVALID`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CallOrderInvalid;

/// The state of a ring of images.
#[derive(Debug, Clone, Copy)]
pub struct Ring {
    count: u64,
    acquired: u64,
    waited: u64,
    released: u64,
    shown: u64,
}

/// The image that the application released last: the one of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Newest {
    /// Index of the image.
    pub index: u32,
    /// The number of releases until now, for [`Ring::mark_shown`].
    pub release: u64,
    /// Whether it was not shown yet.
    pub fresh: bool,
    /// Whether its released picture is intact; the application may have begun to draw the next picture
    /// into it.
    pub intact: bool,
}

impl Ring {
    /// A ring of `count` images, at least one, none of them acquired.
    pub fn new(count: u32) -> Self {
        Self { count: u64::from(count.max(1)), acquired: 0, waited: 0, released: 0, shown: 0 }
    }

    /// Number of images that the application has had.
    pub fn given_out(&self) -> u32 {
        self.acquired.min(self.count) as u32
    }

    /// Goes on with the first `count` images, at least one, where none was acquired and there are more. Returns whether it does.
    pub fn shrink(&mut self, count: u32) -> bool {
        let is_fewer = u64::from(count) < self.count && count > 0 && self.acquired == 0;
        if is_fewer {
            self.count = count.into();
        }
        is_fewer
    }

    /// `xrAcquireSwapchainImage`: the index of the next image, unless the application has all of them.
    pub fn acquire(&mut self) -> Result<u32, CallOrderInvalid> {
        if self.acquired - self.released == self.count {
            return Err(CallOrderInvalid);
        }
        self.acquired += 1;
        Ok(self.image_of(self.acquired))
    }

    /// The image that `xrWaitSwapchainImage` is for: the oldest acquired one, unless none is acquired, or the one that was waited for last is not
    /// released yet.
    pub fn awaited(&self) -> Result<u32, CallOrderInvalid> {
        if self.waited == self.acquired || self.waited > self.released {
            return Err(CallOrderInvalid);
        }
        Ok(self.image_of(self.waited + 1))
    }

    /// `xrWaitSwapchainImage`, of the image of [`Self::awaited`].
    pub fn wait(&mut self) -> Result<(), CallOrderInvalid> {
        self.awaited()?;
        self.waited += 1;
        Ok(())
    }

    /// `xrReleaseSwapchainImage`: of the image that was waited for.
    pub fn release(&mut self) -> Result<(), CallOrderInvalid> {
        if self.waited == self.released {
            return Err(CallOrderInvalid);
        }
        self.released += 1;
        Ok(())
    }

    /// The image that the application released last, if it ever did.
    pub fn newest(&self) -> Option<Newest> {
        (self.released > 0).then(|| Newest {
            index: self.image_of(self.released),
            release: self.released,
            fresh: self.shown < self.released,
            intact: self.is_intact(self.released),
        })
    }

    /// Whether the picture of that release is intact. The next acquisition of its image is [`Self::count`] later; the picture is lost once
    /// that image was waited for.
    pub fn is_intact(&self, release: u64) -> bool {
        self.waited < release + self.count
    }

    /// Number of images.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Notes that the image of that release was written to the runtime's image.
    pub fn mark_shown(&mut self, release: u64) {
        self.shown = self.shown.max(release);
    }

    fn image_of(&self, acquisition: u64) -> u32 {
        ((acquisition - 1) % self.count) as u32
    }
}

#[cfg(test)]
mod tests;
