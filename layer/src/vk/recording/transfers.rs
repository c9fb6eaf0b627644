//! Copies, blits and resolves between images.

mod logged;
mod region;

use super::{Buffer, timed, with_buffer};
use crate::abi::copies::slice;
use crate::pass_detection::{Transfer, TransferKind};
use ash::vk;
use region::Region;

/// A hook of the first kind, whose regions are arguments.
macro_rules! transfer {
    ($function:ident, $name:literal, $next:ident, $kind:ident, $region:ident $(, $filter:ident)?) => {
        #[doc = concat!("`", $name, "`.")]
        ///
        /// # Safety
        ///
        /// The valid usage of the call.
        pub unsafe extern "system" fn $function(
            handle: vk::CommandBuffer,
            from: vk::Image,
            from_layout: vk::ImageLayout,
            to: vk::Image,
            to_layout: vk::ImageLayout,
            count: u32,
            regions: *const vk::$region,
            $($filter: vk::Filter,)?
        ) {
            hook!(
                $name,
                with_buffer,
                $next(handle, from, from_layout, to, to_layout, count, regions $(, $filter)?),
                |known, next| {
                    if let Some(known) = &known {
                        // SAFETY: the command buffer is recording, by valid usage.
                        unsafe { timed::work_begins(known, handle) };
                    }
                    next();
                    if let Some(known) = known {
                        // SAFETY: the valid usage of the call demands `count` regions.
                        let regions = unsafe { slice(regions, count) };
                        note(&known, TransferKind::$kind, from, to, regions);
                    }
                }
            );
        }
    };
}

/// A hook of the second kind, with a structure.
macro_rules! transfer2 {
    ($function:ident, $name:literal, $next:ident, $kind:ident, $info:ident) => {
        #[doc = concat!("`", $name, "`.")]
        ///
        /// # Safety
        ///
        /// The valid usage of the call.
        pub unsafe extern "system" fn $function(handle: vk::CommandBuffer, info: *const vk::$info<'_>) {
            hook!($name, with_buffer, $next(handle, info), |known, next| {
                if let Some(known) = &known {
                    // SAFETY: the command buffer is recording, by valid usage.
                    unsafe { timed::work_begins(known, handle) };
                }
                next();
                if let Some(known) = known {
                    // SAFETY: the pointer is valid, by valid usage, with `region_count` regions.
                    let (info, regions) = unsafe { (&*info, slice((*info).p_regions, (*info).region_count)) };
                    note(&known, TransferKind::$kind, info.src_image, info.dst_image, regions);
                }
            });
        }
    };
}

transfer!(copy, "vkCmdCopyImage", cmd_copy_image, Copy, ImageCopy);
transfer!(blit, "vkCmdBlitImage", cmd_blit_image, Blit, ImageBlit, filter);
transfer!(resolve, "vkCmdResolveImage", cmd_resolve_image, Resolve, ImageResolve);
transfer2!(copy2, "vkCmdCopyImage2", cmd_copy_image2, Copy, CopyImageInfo2);
transfer2!(blit2, "vkCmdBlitImage2", cmd_blit_image2, Blit, BlitImageInfo2);
transfer2!(resolve2, "vkCmdResolveImage2", cmd_resolve_image2, Resolve, ResolveImageInfo2);

/// Notes transfers of colour between images that are known.
fn note(buffer: &Buffer, kind: TransferKind, from: vk::Image, to: vk::Image, regions: &[impl Region]) {
    let objects = &buffer.armed.objects;
    if !buffer.armed.follows_passes() {
        return;
    }
    let (Some(from), Some(to)) = (objects.image(from), objects.image(to)) else { return };
    if logged::never_holds_picture(&from) || logged::never_holds_picture(&to) {
        return;
    }
    let mut recorded = buffer.recorded();
    for region in regions {
        let ends = region.ends();
        let transfer = Transfer {
            kind,
            from: ends.from.target(&from.description),
            from_rect: ends.from.rect,
            to: ends.to.target(&to.description),
            to_rect: ends.to.rect,
        };
        let are_textures = logged::is_texture(&from) && logged::is_texture(&to);
        logged::add(&mut recorded.events, transfer, are_textures);
    }
}
