//! Viewports and scissors: their commands, and the values that a pipeline of ours replaces until they are set again.

use super::{Buffer, draws, with_buffer};
use crate::abi::copies::slice;
use crate::vk::functions::ArmedTable;
use ash::vk;
use smallvec::SmallVec;

/// The viewports and scissors of a command buffer, from number 0 on, as far as they were set.
#[derive(Clone, Default)]
pub struct Rects {
    viewports: Values<vk::Viewport>,
    scissors: Values<vk::Rect2D>,
}

/// Values of one state.
#[derive(Clone)]
struct Values<T> {
    values: SmallVec<[Option<T>; 2]>,
    /// Whether their number was set with them.
    has_count: bool,
}

impl Rects {
    /// Forgets all; the memory stays.
    pub fn clear(&mut self) {
        self.viewports.clear();
        self.scissors.clear();
    }

    /// Sets them again, with the next layer's functions, after a pipeline of ours with one viewport and one scissor.
    ///
    /// # Safety
    ///
    /// `commands` is recording.
    pub unsafe fn restore(&self, next: &ArmedTable, commands: vk::CommandBuffer) {
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        unsafe {
            if let (Some(all), Some(set)) = (self.viewports.all(), next.cmd_set_viewport_with_count) {
                set(commands, all.len() as u32, all.as_ptr());
            } else if let (Some(viewport), Some(set)) = (self.viewports.first(), next.cmd_set_viewport) {
                set(commands, 0, 1, &viewport);
            }
            if let (Some(all), Some(set)) = (self.scissors.all(), next.cmd_set_scissor_with_count) {
                set(commands, all.len() as u32, all.as_ptr());
            } else if let (Some(scissor), Some(set)) = (self.scissors.first(), next.cmd_set_scissor) {
                set(commands, 0, 1, &scissor);
            }
        }
    }
}

impl<T> Default for Values<T> {
    fn default() -> Self {
        Self { values: SmallVec::new(), has_count: false }
    }
}

impl<T: Copy> Values<T> {
    fn clear(&mut self) {
        self.values.clear();
        self.has_count = false;
    }

    /// Values are set from number `first` on; `None`: these and no others.
    fn set(&mut self, first: Option<u32>, values: &[T]) {
        if first.is_none() {
            self.values.clear();
        }
        self.has_count = first.is_none();
        for (index, value) in (first.unwrap_or(0) as usize..).zip(values) {
            if self.values.len() <= index {
                self.values.resize(index + 1, None);
            }
            self.values[index] = Some(*value);
        }
    }

    fn first(&self) -> Option<T> {
        self.values.first().copied().flatten()
    }

    /// All values, if their number was set with them.
    fn all(&self) -> Option<SmallVec<[T; 2]>> {
        if self.has_count { self.values.iter().copied().collect() } else { None }
    }
}

/// The application sets viewports from number `first` on; `None`: these and no others.
fn viewports_set(known: &Buffer, handle: vk::CommandBuffer, first: Option<u32>, viewports: &[vk::Viewport]) {
    if viewports.is_empty() {
        return;
    }
    let counts = draws::counts(known, handle);
    let mut recorded = known.recorded();
    recorded.viewports.set(first.unwrap_or(0), viewports, counts);
    if recorded.drawing.is_followed() {
        recorded.drawing.rects.viewports.set(first, viewports);
    }
}

/// The application sets scissors from number `first` on; `None`: these and no others.
fn scissors_set(known: &Buffer, first: Option<u32>, scissors: &[vk::Rect2D]) {
    let mut recorded = known.recorded();
    if !scissors.is_empty() && recorded.drawing.is_followed() {
        recorded.drawing.rects.scissors.set(first, scissors);
    }
}

/// `vkCmdSetViewport`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn set_viewport(
    handle: vk::CommandBuffer,
    first: u32,
    count: u32,
    viewports: *const vk::Viewport,
) {
    hook!(
        "vkCmdSetViewport",
        with_buffer,
        cmd_set_viewport(handle, first, count, viewports),
        |known, next| {
            next();
            if let Some(known) = known {
                // SAFETY: valid usage demands so many viewports.
                viewports_set(&known, handle, Some(first), unsafe { slice(viewports, count) });
            }
        }
    );
}

/// `vkCmdSetViewportWithCount`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn set_viewport_with_count(
    handle: vk::CommandBuffer,
    count: u32,
    viewports: *const vk::Viewport,
) {
    hook!(
        "vkCmdSetViewportWithCount",
        with_buffer,
        cmd_set_viewport_with_count(handle, count, viewports),
        |known, next| {
            next();
            if let Some(known) = known {
                // SAFETY: valid usage demands so many viewports.
                viewports_set(&known, handle, None, unsafe { slice(viewports, count) });
            }
        }
    );
}

/// `vkCmdSetScissor`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn set_scissor(
    handle: vk::CommandBuffer,
    first: u32,
    count: u32,
    scissors: *const vk::Rect2D,
) {
    hook!("vkCmdSetScissor", with_buffer, cmd_set_scissor(handle, first, count, scissors), |known, next| {
        next();
        if let Some(known) = known {
            // SAFETY: valid usage demands so many scissors.
            scissors_set(&known, Some(first), unsafe { slice(scissors, count) });
        }
    });
}

/// `vkCmdSetScissorWithCount`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn set_scissor_with_count(
    handle: vk::CommandBuffer,
    count: u32,
    scissors: *const vk::Rect2D,
) {
    hook!(
        "vkCmdSetScissorWithCount",
        with_buffer,
        cmd_set_scissor_with_count(handle, count, scissors),
        |known, next| {
            next();
            if let Some(known) = known {
                // SAFETY: valid usage demands so many scissors.
                scissors_set(&known, None, unsafe { slice(scissors, count) });
            }
        }
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_kept_by_their_numbers() {
        let mut values = Values::default();
        values.set(Some(1), &[10, 11]);
        assert_eq!((values.values.as_slice(), values.first()), (&[None, Some(10), Some(11)][..], None));
        values.set(Some(0), &[20, 21]);
        assert_eq!(values.values.as_slice(), [Some(20), Some(21), Some(11)]);
        assert_eq!(values.all(), None, "their number comes from the pipeline");
        values.set(None, &[30, 31]);
        assert_eq!(values.all().as_deref(), Some(&[30, 31][..]));
    }
}
