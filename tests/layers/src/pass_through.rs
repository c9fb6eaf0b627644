//! Layers that do nothing: the cost of any layer, as the baseline of the overhead bench, and a neighbour of Parafovea's on
//! either side, as overlays and capture tools are.

use crate::layer::{Layer, NextDevice, Tracked, made_as_asked};
use ash::vk;
use std::ffi::CStr;

macro_rules! pass_through {
    ($($(#[$doc:meta])* $layer:ident),*) => {$(
        $(#[$doc])*
        pub(crate) struct $layer {
            next: NextDevice,
        }

        impl $layer {
            fn over(next: NextDevice) -> Self {
                Self { next }
            }
        }

        impl Layer for $layer {
            fn tracked() -> &'static Tracked<Self> {
                static TRACKED: Tracked<$layer> = Tracked::new();
                &TRACKED
            }

            made_as_asked!();

            fn hook(_: &CStr) -> vk::PFN_vkVoidFunction {
                None
            }

            fn next(&self) -> &NextDevice {
                &self.next
            }
        }
    )*};
}

pass_through! {
    /// Below Parafovea.
    PassThrough,
    /// Above Parafovea.
    Above
}
