//! Output of the layer: a line of JSON for each finding and for each executed pass with a rate attachment.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The variable with the file to which the lines, each a [`ShadingRateLine`], are appended.
pub const SHADING_RATE_FILE_VARIABLE: &str = "PARAFOVEA_TEST_SHADING_RATE_FILE";

/// The variable that, set to 1, has the texels of every map written; without it, only the texels of small maps.
pub const SHADING_RATE_TEXELS_VARIABLE: &str = "PARAFOVEA_TEST_SHADING_RATE_TEXELS";

/// A line of the file.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShadingRateLine {
    /// Something is used wrongly.
    Finding(ShadingRateFinding),
    /// A pass with a rate attachment was executed.
    Pass(ShadingRatePass),
}

/// Something that is used wrongly. The same one is written once for each device.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct ShadingRateFinding {
    /// Place of the violation: `device`, `image`, `render_pass`, `framebuffer`, `pipeline`, `command`, `execution`.
    pub kind: String,
    /// The Valid Usage ID of the Vulkan specification, or a name of the layer's own where it has none.
    pub rule: String,
    /// The found value.
    pub message: String,
    /// The object at fault.
    pub object: String,
}

/// A pass that was executed with a rate attachment. A render pass with two different ones is two of these.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct ShadingRatePass {
    /// In the order of submission, from 0.
    pub index: u64,
    /// `render_pass`, `imageless` or `dynamic`.
    pub form: String,
    /// The render area in pixels: x, y, width, height.
    pub area: [u32; 4],
    /// Layers of the framebuffer, 1 with multiview.
    pub layers: u32,
    /// The views of multiview, 0 without.
    pub view_mask: u32,
    /// Formats of the colour attachments; in a render pass, of its first subpass.
    pub formats: Vec<String>,
    /// Their images.
    pub targets: Vec<String>,
    /// Draw calls in the pass, of a suspended one only those before it is resumed.
    pub draws: u32,
    /// Number of these draw calls that obey the attachment: their second combiner is not KEEP.
    pub draws_obeying: u32,
    /// The size of a texel's area in pixels.
    pub texel: [u32; 2],
    /// The rate image.
    pub image: String,
    /// The map as it was when the pass was executed; none if it could not be read in time.
    pub map: Option<ShadingRateMap>,
}

/// The texels of a rate attachment that lie under the render area, layer by layer, row by row.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct ShadingRateMap {
    /// Texels: width, height, layers.
    pub extent: [u32; 3],
    /// Number of texels of each rate, named as `2x1` (width, height).
    pub histogram: BTreeMap<String, u32>,
    /// FNV-1a of the texels' bytes, 64 bits, in hexadecimal digits.
    pub hash: String,
    /// The texels' bytes, in hexadecimal digits; see [`SHADING_RATE_TEXELS_VARIABLE`].
    pub texels: Option<String>,
}
