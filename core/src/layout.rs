//! Layout of parameters for the GPU: each struct lists its fields, and the layer's build compares the list with the shader's own
//! struct, so that the two cannot drift apart.

/// One field of a parameter struct: its name in Rust and in WGSL, and where it lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name of the field.
    pub name: &'static str,
    /// Offset from the start of the struct, in bytes.
    pub offset: usize,
    /// Size in bytes.
    pub size: usize,
}

/// Parameters of a kernel in a uniform buffer. Implemented by the `uniform!` macro only.
pub trait Uniform: bytemuck::Pod {
    /// Name of the struct in Rust and in WGSL.
    const NAME: &'static str;
    /// All fields, in order.
    const FIELDS: &'static [Field];
}

/// Declares a `repr(C)` parameter struct together with its [`Uniform`] table.
macro_rules! uniform {
    (
        $(#[$outer:meta])*
        pub struct $name:ident {
            $( $(#[$inner:meta])* pub $field:ident: $type:ty, )*
        }
    ) => {
        $(#[$outer])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct $name {
            $( $(#[$inner])* pub $field: $type, )*
        }

        impl $crate::layout::Uniform for $name {
            const NAME: &'static str = stringify!($name);
            const FIELDS: &'static [$crate::layout::Field] = &[
                $( $crate::layout::Field {
                    name: stringify!($field),
                    offset: std::mem::offset_of!($name, $field),
                    size: size_of::<$type>(),
                }, )*
            ];
        }
    };
}

pub(crate) use uniform;
