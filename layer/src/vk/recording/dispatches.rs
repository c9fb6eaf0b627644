//! Dispatches of compute shaders: command buffers of compute alone take time, too.

use super::{timed, with_buffer};
use ash::vk;

/// Hooks of dispatches; the next layer's function of that name is in the table's `$field`.
macro_rules! dispatches {
    ($($name:ident, $call:literal, $field:ident: ($($argument:ident: $type:ty),*);)*) => {$(
        #[doc = concat!("`", $call, "`.")]
        ///
        /// # Safety
        ///
        /// The valid usage of the call.
        pub unsafe extern "system" fn $name(handle: vk::CommandBuffer, $($argument: $type),*) {
            hook!($call, with_buffer, $field(handle $(, $argument)*), |known, next| {
                if let Some(known) = known {
                    // SAFETY: the command buffer is recording, by valid usage.
                    unsafe { timed::work_begins(&known, handle) };
                }
                next();
            });
        }
    )*};
}

dispatches! {
    dispatch, "vkCmdDispatch", cmd_dispatch: (x: u32, y: u32, z: u32);
    dispatch_base, "vkCmdDispatchBase", cmd_dispatch_base: (
        base_x: u32, base_y: u32, base_z: u32, x: u32, y: u32, z: u32
    );
    dispatch_indirect, "vkCmdDispatchIndirect", cmd_dispatch_indirect: (buffer: vk::Buffer, offset: vk::DeviceSize);
}
