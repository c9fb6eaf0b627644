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

        impl crate::options::Setting for $type {
            type Range = ();

            fn read(value: &toml::de::DeValue<'_>, (): ()) -> Option<Self> {
                match value.as_str()? {
                    $($name => Some(Self::$variant),)+
                    _ => None,
                }
            }

            fn allowed((): ()) -> crate::options::Allowed {
                crate::options::Allowed::Choice(&[$(($name, concat!($($about),+))),+])
            }

            fn to_toml(self) -> String {
                match self {
                    $(Self::$variant => concat!('"', $name, '"').to_owned(),)+
                }
            }
        }
    };
}

pub(super) use choice;
