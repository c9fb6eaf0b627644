//! Formats of colour attachments by the names that Vulkan gives them.

use std::fmt;

/// A format of [`COLOR_FORMATS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColorFormat {
    name: &'static str,
    value: i32,
}

impl ColorFormat {
    const fn new(name: &'static str, value: i32) -> Self {
        Self { name, value }
    }

    /// The format of this name, which is VkFormat's without `VK_FORMAT_`.
    pub fn from_name(name: &str) -> Option<Self> {
        COLOR_FORMATS.iter().find(|format| format.name == name).copied()
    }

    /// Its name without `VK_FORMAT_`.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// The value of its VkFormat.
    pub fn value(self) -> i32 {
        self.value
    }
}

impl fmt::Display for ColorFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// The formats that applications draw pictures into (values: Vulkan specification, `VkFormat`).
pub const COLOR_FORMATS: &[ColorFormat] = &[
    ColorFormat::new("R5G6B5_UNORM_PACK16", 4),
    ColorFormat::new("R8_UNORM", 9),
    ColorFormat::new("R8G8_UNORM", 16),
    ColorFormat::new("R8G8B8A8_UNORM", 37),
    ColorFormat::new("R8G8B8A8_SNORM", 38),
    ColorFormat::new("R8G8B8A8_UINT", 41),
    ColorFormat::new("R8G8B8A8_SRGB", 43),
    ColorFormat::new("B8G8R8A8_UNORM", 44),
    ColorFormat::new("B8G8R8A8_SRGB", 50),
    ColorFormat::new("A8B8G8R8_UNORM_PACK32", 51),
    ColorFormat::new("A8B8G8R8_SRGB_PACK32", 57),
    ColorFormat::new("A2R10G10B10_UNORM_PACK32", 58),
    ColorFormat::new("A2B10G10R10_UNORM_PACK32", 64),
    ColorFormat::new("R16_UNORM", 70),
    ColorFormat::new("R16_SFLOAT", 76),
    ColorFormat::new("R16G16_UNORM", 77),
    ColorFormat::new("R16G16_SFLOAT", 83),
    ColorFormat::new("R16G16B16A16_UNORM", 91),
    ColorFormat::new("R16G16B16A16_SNORM", 92),
    ColorFormat::new("R16G16B16A16_UINT", 95),
    ColorFormat::new("R16G16B16A16_SFLOAT", 97),
    ColorFormat::new("R32_UINT", 98),
    ColorFormat::new("R32_SFLOAT", 100),
    ColorFormat::new("R32G32_UINT", 101),
    ColorFormat::new("R32G32_SFLOAT", 103),
    ColorFormat::new("R32G32B32A32_UINT", 107),
    ColorFormat::new("R32G32B32A32_SFLOAT", 109),
    ColorFormat::new("B10G11R11_UFLOAT_PACK32", 122),
];
