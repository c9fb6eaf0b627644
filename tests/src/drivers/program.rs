//! The programs that are run on every driver.

use super::{direct3d, quick3d};
use crate::HarnessError;
use crate::run::{Application, Run};
use crate::scenario::{Scenario, ScenarioExt};
use parafovea_zoo::{STYLES, Style};
use std::time::Duration;

/// A program on a driver.
#[derive(Clone, Copy)]
pub enum Program {
    /// A style of the zoo.
    Style(&'static Style),
    /// Khronos' hello_xr with the graphics plug-in of this name.
    HelloXr(&'static str),
    /// Our scene.
    Scene,
    /// The whole output of vulkaninfo, which creates a device of every kind.
    VulkanInfo,
    /// `parafovea doctor`.
    Doctor,
    /// Direct3D 11 by DXVK's Linux build, with this way of drawing.
    Direct3d(&'static str),
    /// Qt Quick 3D XR with this way of drawing.
    Quick3d(quick3d::Look),
}

/// Frames of an application; passes are known from the fourth on.
pub const FRAMES: u64 = 12;

/// Width and height of an eye buffer, pixels.
const SIZE: u32 = 96;

/// An application that takes longer hangs.
const LIMIT: Duration = Duration::from_secs(30);

impl Program {
    /// All of them, programs before styles.
    pub fn all() -> Vec<Self> {
        let others =
            [Self::VulkanInfo, Self::Doctor, Self::HelloXr("Vulkan"), Self::HelloXr("Vulkan2"), Self::Scene];
        let looks = direct3d::LOOKS.into_iter().map(Self::Direct3d);
        let looks = looks.chain(quick3d::LOOKS.into_iter().map(Self::Quick3d));
        others.into_iter().chain(looks).chain(STYLES.iter().copied().map(Self::Style)).collect()
    }

    /// Its name in tables.
    pub fn name(self) -> String {
        match self {
            Self::Style(style) => style.name.to_owned(),
            Self::HelloXr(graphics) => format!("hello_xr {graphics}"),
            Self::Scene => "scene".to_owned(),
            Self::VulkanInfo => "vulkaninfo".to_owned(),
            Self::Doctor => "doctor".to_owned(),
            Self::Direct3d(look) => format!("d3d11 {look}"),
            Self::Quick3d(look) => format!("qt {}", look.name),
        }
    }

    /// Whether it renders frames in an OpenXR session.
    pub fn has_frames(self) -> bool {
        !matches!(self, Self::VulkanInfo | Self::Doctor)
    }

    /// Whether it sets shading rates itself: the layer leaves its passes alone, which the record of passes does not show.
    pub fn sets_rates(self) -> bool {
        let rates = c"VK_KHR_fragment_shading_rate";
        matches!(self, Self::Style(style) if style.needs.extensions.contains(&rates))
    }

    /// Whether it starts programs, which do not get the program loader of a folder with a C library of its own.
    pub fn starts_programs(self) -> bool {
        matches!(self, Self::Doctor)
    }

    /// Rules of validation that the program breaks by itself, in each run a different number of times.
    pub fn own_violations(self) -> &'static [&'static str] {
        match self {
            // Qt makes all images PREINITIALIZED.
            Self::Quick3d(_) => &["VUID-VkImageCreateInfo-initialLayout-12478"],
            _ => &[],
        }
    }

    /// The oldest Vulkan headers (1.3.N) of a validation layer that knows its calls.
    pub fn headers(self) -> u32 {
        if let Self::Style(style) = self { style.headers } else { 0 }
    }

    /// A run of it, without the layer, on lavapipe.
    ///
    /// # Errors
    /// [`HarnessError::NotBuilt`], [`HarnessError::NotInstalled`].
    pub fn run(self) -> Result<Run, HarnessError> {
        let scenario = Scenario::new(FRAMES).sized(SIZE, SIZE);
        let (size, frames) = (SIZE.to_string(), FRAMES.to_string());
        let application = match self {
            Self::Direct3d(look) => return Ok(direct3d::run(look, SIZE, &scenario)?.timeout(LIMIT)),
            Self::Quick3d(look) => return Ok(quick3d::run(look, &scenario)?.timeout(LIMIT)),
            Self::Style(style) => {
                let arguments = ["--style", style.name, "--size", &size, "--frames", &frames];
                Application::ours("parafovea-zoo", &arguments)?
            }
            Self::HelloXr(graphics) => Application::hello_xr(graphics)?,
            Self::Scene => Application::ours("parafovea-scene", &["--frames", &frames])?,
            Self::VulkanInfo => Application::of_system("vulkaninfo", &[])?,
            Self::Doctor => Application::ours("parafovea", &["doctor"])?,
        };
        let has_two = matches!(self, Self::Style(style) if style.needs.queues.are_two());
        let run = Run::new(&application, &scenario).two_queues(has_two).timeout(LIMIT);
        Ok(if matches!(self, Self::HelloXr(_)) { run.closing_input() } else { run })
    }
}
