//! Presets: named sets of values, between the defaults and the values of the file.

/// Makes a choice of presets from a list of the values that each sets.
macro_rules! presets {
    ($(#[doc = $doc:literal])+ $type:ident {
        $($(#[doc = $about:literal])+ $variant:ident = $name:literal {
            $($section:ident.$option:ident = $value:expr;)*
        })+
    }) => {
        choice! {
            $(#[doc = $doc])+
            $type { $($(#[doc = $about])+ $variant = $name,)+ }
        }

        impl Config {
            /// The configuration of a file that sets nothing but this preset.
            pub fn of_preset(preset: $type) -> Self {
                #[allow(unused_mut, reason = "a preset may set nothing")]
                let mut config = Self { preset, ..Self::default() };
                match preset {
                    $($type::$variant => { $(config.$section.$option = $value;)* })+
                }
                config
            }
        }
    };
}

pub(super) use presets;
