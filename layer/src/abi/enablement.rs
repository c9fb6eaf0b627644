//! Whether this process wants Parafovea.

use std::ffi::OsStr;
use std::fmt;

/// The request for the layer, as an instance is created. The loader's call of the layer is the request: the manifest is implicit and names
/// `PARAFOVEA=1`, or the layer was enabled by name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Enablement {
    /// Wanted.
    Enabled,
    /// `DISABLE_PARAFOVEA` is set, to any value: the loaders read a manifest's `disable_environment` so.
    Disabled,
    /// The process runs with elevated rights (`AT_SECURE`); its environment must not enable anything.
    Elevated,
}

impl Enablement {
    /// Reads it from this process.
    pub fn of_process() -> Self {
        // SAFETY: getauxval reads a vector that the kernel set up before the process started.
        let elevated = unsafe { libc::getauxval(libc::AT_SECURE) } != 0;
        Self::from_parts(elevated, std::env::var_os("DISABLE_PARAFOVEA").as_deref())
    }

    fn from_parts(elevated: bool, disable: Option<&OsStr>) -> Self {
        match (elevated, disable) {
            (true, _) => Self::Elevated,
            (false, Some(_)) => Self::Disabled,
            (false, None) => Self::Enabled,
        }
    }
}

impl fmt::Display for Enablement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Enabled => "enabled",
            Self::Disabled => "DISABLE_PARAFOVEA is set",
            Self::Elevated => "the process runs with elevated rights",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rights_come_before_variables_and_any_value_disables() {
        let empty = Some(OsStr::new(""));
        assert_eq!(Enablement::from_parts(false, None), Enablement::Enabled);
        assert_eq!(Enablement::from_parts(false, empty), Enablement::Disabled);
        assert_eq!(Enablement::from_parts(true, None), Enablement::Elevated);
        assert_eq!(Enablement::from_parts(true, empty), Enablement::Elevated);
    }
}
