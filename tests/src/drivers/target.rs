//! The devices of the matrix.

use super::{Folder, Program, ShimDevice};
use crate::HarnessError;
use crate::device::Machine;
use crate::installation::Driver;
use crate::run::Run;

/// A device of the matrix.
#[derive(Clone, Debug)]
pub enum Target {
    /// A device that a shim fakes.
    Shim(ShimDevice),
    /// A real GPU.
    Gpu(Machine),
}

impl Target {
    /// Its name in tables.
    pub fn name(&self) -> &str {
        match self {
            Self::Shim(device) => device.name(),
            Self::Gpu(machine) => &machine.device.name,
        }
    }

    /// The driver's version: the package's, or the driver's own words.
    ///
    /// # Errors
    /// As for [`Folder::version`].
    pub fn version(&self) -> Result<String, HarnessError> {
        match self {
            Self::Shim(device) => Ok(format!("Mesa {}", device.folder().version("mesa-vulkan-drivers")?)),
            Self::Gpu(machine) => Ok(machine.device.driver.clone()),
        }
    }

    /// Sets a run up to be on this device.
    pub fn set_up(&self, run: Run) -> Run {
        match self {
            Self::Shim(device) => run.driver(Driver::Shim(*device)),
            Self::Gpu(machine) => machine.set_up(run),
        }
    }

    /// Reason why a program cannot run on this device; None where it can.
    pub fn refusal(&self, program: Program) -> Option<&'static str> {
        let is_sid = matches!(self, Self::Shim(device) if device.folder() == Folder::Sid);
        if is_sid && program.starts_programs() {
            Some("programs that it starts have another C library")
        } else if !is_sid && matches!(program, Program::Direct3d(_)) {
            Some("DXVK for Linux programs is a package of Debian sid")
        } else if !is_sid && matches!(program, Program::Quick3d(_)) {
            Some("Qt Quick 3D XR for Vulkan is a package of Debian sid")
        } else {
            None
        }
    }
}
