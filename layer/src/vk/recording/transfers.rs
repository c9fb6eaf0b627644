//! Copies, blits and resolves between images.

mod region;

use super::{Buffer, timed, with_buffer};
use crate::abi::guard;
use crate::pass_detection::{Event, Transfer, TransferKind};
use ash::vk;
use region::Region;
use std::slice;

/// A hook of the first kind, whose regions are arguments.
macro_rules! hook {
    ($function:ident, $name:literal, $next:ident, $kind:ident, $region:ident $(, $filter:ident)?) => {
        #[doc = concat!("`", $name, "`.")]
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
            // SAFETY: the application's own arguments; `count` regions are there.
            // SAFETY: as above.
            let pass_on = || unsafe {
                pass_on!(with_buffer: handle, $next(handle, from, from_layout, to, to_layout, count, regions $(, $filter)?), ())
            };
            // SAFETY: as above.
            guard($name, pass_on, |answer| unsafe {
                let Some((known, next)) = with_buffer(handle, |next| next.$next) else { return };
                if let Some(known) = &known {
                    timed::work_begins(known, handle);
                }
                next(handle, from, from_layout, to, to_layout, count, regions $(, $filter)?);
                answer.made();
                if let Some(known) = known {
                    let regions = slice::from_raw_parts(regions, count as usize);
                    note(&known, TransferKind::$kind, from, to, regions);
                }
            });
        }
    };
}

/// A hook of the second kind, with a structure.
macro_rules! hook2 {
    ($function:ident, $name:literal, $next:ident, $kind:ident, $info:ident) => {
        #[doc = concat!("`", $name, "`.")]
        pub unsafe extern "system" fn $function(handle: vk::CommandBuffer, info: *const vk::$info<'_>) {
            // SAFETY: the application's own arguments; `info` is valid, with as many regions as it says.
            guard(
                $name,
                // SAFETY: as above.
                || unsafe { pass_on!(with_buffer: handle, $next(handle, info), ()) },
                // SAFETY: as above.
                |answer| unsafe {
                    let Some((known, next)) = with_buffer(handle, |next| next.$next) else { return };
                    if let Some(known) = &known {
                        timed::work_begins(known, handle);
                    }
                    next(handle, info);
                    answer.made();
                    if let Some(known) = known {
                        let regions = slice::from_raw_parts((*info).p_regions, (*info).region_count as usize);
                        note(&known, TransferKind::$kind, (*info).src_image, (*info).dst_image, regions);
                    }
                },
            );
        }
    };
}

hook!(copy, "vkCmdCopyImage", cmd_copy_image, Copy, ImageCopy);
hook!(blit, "vkCmdBlitImage", cmd_blit_image, Blit, ImageBlit, filter);
hook!(resolve, "vkCmdResolveImage", cmd_resolve_image, Resolve, ImageResolve);
hook2!(copy2, "vkCmdCopyImage2", cmd_copy_image2, Copy, CopyImageInfo2);
hook2!(blit2, "vkCmdBlitImage2", cmd_blit_image2, Blit, BlitImageInfo2);
hook2!(resolve2, "vkCmdResolveImage2", cmd_resolve_image2, Resolve, ResolveImageInfo2);

/// Notes transfers of colour between images that are known.
fn note(buffer: &Buffer, kind: TransferKind, from: vk::Image, to: vk::Image, regions: &[impl Region]) {
    let objects = &buffer.armed.objects;
    if !buffer.armed.follows_passes() {
        return;
    }
    let (Some(from), Some(to)) = (objects.image(from), objects.image(to)) else { return };
    let mut recorded = buffer.recorded();
    for region in regions {
        let ends = region.ends();
        recorded.events.push(Event::Transfer(Transfer {
            kind,
            from: ends.from.target(&from.description),
            from_rect: ends.from.rect,
            to: ends.to.target(&to.description),
            to_rect: ends.to.rect,
        }));
    }
}
