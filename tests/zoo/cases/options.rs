//! The command line.

use clap::{Parser, ValueEnum};
use std::ffi::CString;
use std::path::PathBuf;

/// Runs one case and prints its observations as one JSON object. Exits with 0 if they meet the OpenXR specification, else with 1.
#[derive(Parser)]
#[command(name = "parafovea-cases", version)]
pub struct Options {
    /// Name of the case
    #[arg(required_unless_present_any = ["list", "soak", "sequences"])]
    pub case: Option<String>,
    /// Print the names of the cases, one per line
    #[arg(long)]
    pub list: bool,
    /// Instead of a case: start and end repeatedly for this number of seconds, and print the resources of the process each time, one JSON
    /// object per line
    #[arg(long, value_name = "SECONDS")]
    pub soak: Option<u64>,
    /// Instead of a case: run this number of random call sequences, and print the result of each in a line; for a single one, every call
    #[arg(long, value_name = "COUNT")]
    pub sequences: Option<u64>,
    /// Number of the first sequence
    #[arg(long, default_value_t = 0)]
    pub first: u64,
    /// Call sequences that break the specification
    #[arg(long)]
    pub hostile: bool,
    /// Run the case this number of times in one process, each time with new loaders, instances and devices, and print a report after
    /// each
    #[arg(long, value_name = "COUNT", default_value_t = 1)]
    pub lives: u32,
    /// Graphics extension: XR_KHR_vulkan_enable (1) or XR_KHR_vulkan_enable2 (2)
    #[arg(long, value_enum, default_value = "2")]
    pub enable: Enable,
    /// Requested Vulkan version
    #[arg(long, value_enum, default_value = "1.1")]
    pub vulkan: VulkanVersion,
    /// Requested OpenXR version; 1.1 needs a loader of that version
    #[arg(long, value_enum, default_value = "1.0")]
    pub openxr: OpenXrVersion,
    /// Create VkInstance and VkDevice before the XrInstance (needs --enable 1)
    #[arg(long)]
    pub vulkan_first: bool,
    /// Application name for OpenXR
    #[arg(long, default_value = "parafovea-cases")]
    pub name: CString,
    /// Engine name for Vulkan
    #[arg(long, default_value = "none")]
    pub engine: CString,
    /// Enumerate images into structures with neither type nor next pointer, as xrgears and xrdesktop do
    #[arg(long)]
    pub untyped_images: bool,
    /// Enumerate the images of each swapchain once, with an array of this number, as LÖVR does
    #[arg(long, value_name = "COUNT")]
    pub image_capacity: Option<u32>,
    /// A file whose lock (flock) is held around each vkQueueSubmit
    #[arg(long)]
    pub submit_lock: Option<PathBuf>,
}

/// The graphics extension.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Enable {
    /// XR_KHR_vulkan_enable
    #[value(name = "1")]
    One,
    /// XR_KHR_vulkan_enable2
    #[value(name = "2")]
    Two,
}

/// The version in XrApplicationInfo.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum OpenXrVersion {
    /// OpenXR 1.0
    #[value(name = "1.0")]
    V1_0,
    /// OpenXR 1.1
    #[value(name = "1.1")]
    V1_1,
}

/// The version in VkApplicationInfo.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum VulkanVersion {
    /// Vulkan 1.0
    #[value(name = "1.0")]
    V1_0,
    /// Vulkan 1.1
    #[value(name = "1.1")]
    V1_1,
    /// Vulkan 1.3
    #[value(name = "1.3")]
    V1_3,
}

impl VulkanVersion {
    /// As Vulkan encodes it.
    pub fn encoded(self) -> u32 {
        match self {
            Self::V1_0 => ash::vk::API_VERSION_1_0,
            Self::V1_1 => ash::vk::API_VERSION_1_1,
            Self::V1_3 => ash::vk::API_VERSION_1_3,
        }
    }
}
