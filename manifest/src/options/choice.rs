//! Options with named values.

/// Makes an enum whose variants are a choice in the configuration, each with its name there. The variants'
/// comments are the descriptions in the default file.
macro_rules! choice {
    ($(#[doc = $doc:literal])+ $type:ident {
        $($(#[doc = $about:literal])+ $variant:ident = $name:literal,)+
    }) => {
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $type {
            $($(#[doc = $about])+ $variant,)+
        }

        impl $type {
            /// All of them, in the order of the table.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// Its name in the configuration.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)+
                }
            }

            /// The one of that name.
            pub fn of_name(name: &str) -> Option<Self> {
                match name {
                    $($name => Some(Self::$variant),)+
                    _ => None,
                }
            }
        }

        impl crate::options::Setting for $type {
            type Range = ();

            fn read(value: &toml::de::DeValue<'_>, (): ()) -> Option<Self> {
                Self::of_name(value.as_str()?)
            }

            fn allowed((): ()) -> crate::options::Allowed {
                crate::options::Allowed::Choice(&[$(($name, concat!($($about),+))),+])
            }

            fn to_toml(self) -> String {
                format!("\"{}\"", self.name())
            }
        }
    };
}

pub(super) use choice;
