//! The texels of a map: their rates, and whether the device has such rates.

use super::lines::{SHADING_RATE_TEXELS_VARIABLE, ShadingRateMap};
use super::profile::ShadingRateProfile;
use ash::vk;
use std::collections::BTreeMap;

/// Most texels of a map that are written without [`SHADING_RATE_TEXELS_VARIABLE`].
const SMALL: usize = 1024;

/// A map's copy, and the part of it that lies under a render area.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Shape {
    /// Of the copy: width, height, layers.
    extent: [u32; 3],
    /// The part: x, y, width, height.
    part: [u32; 4],
}

impl Shape {
    pub fn under(area: [u32; 4], texel: [u32; 2], extent: vk::Extent2D, layers: u32) -> Self {
        let [x, y, width, height] = area;
        let side = |first: u32, length: u32, texel: u32, most: u32| {
            let texel = texel.max(1);
            let start = (first / texel).min(most);
            (start, (first + length).div_ceil(texel).min(most) - start)
        };
        let (x, width) = side(x, width, texel[0], extent.width);
        let (y, height) = side(y, height, texel[1], extent.height);
        Self { extent: [extent.width, extent.height, layers], part: [x, y, width, height] }
    }

    pub fn bytes(&self) -> vk::DeviceSize {
        self.extent.iter().map(|&side| vk::DeviceSize::from(side)).product()
    }

    /// The part's rows, of all layers.
    fn rows<'a>(&self, bytes: &'a [u8]) -> impl Iterator<Item = &'a [u8]> {
        let ([width, height, layers], [x, y, columns, rows]) = (self.extent, self.part);
        (0..layers).flat_map(move |layer| {
            (y..y + rows).filter_map(move |row| {
                let start = ((layer * height + row) * width + x) as usize;
                bytes.get(start..start + columns as usize)
            })
        })
    }
}

/// The size of fragments that a texel asks for: two bits each for the logarithms of width and height.
fn fragment_size(texel: u8) -> Option<[u32; 2]> {
    (texel < 16).then(|| [1 << (texel >> 2), 1 << (texel & 3)])
}

/// Reads a map, and the first texel with a rate that the device lacks.
pub(super) fn read(shape: &Shape, bytes: &[u8], profile: ShadingRateProfile) -> (ShadingRateMap, Option<u8>) {
    let texels: Vec<u8> = shape.rows(bytes).flatten().copied().collect();
    let mut histogram = BTreeMap::new();
    let mut illegal = None;
    for &texel in &texels {
        let size = fragment_size(texel).filter(|&[width, height]| profile.has_rate(width, height));
        match size {
            Some([width, height]) => *histogram.entry(format!("{width}x{height}")).or_default() += 1,
            None => illegal = illegal.or(Some(texel)),
        }
    }
    let wanted =
        texels.len() <= SMALL || std::env::var(SHADING_RATE_TEXELS_VARIABLE).is_ok_and(|on| on == "1");
    let map = ShadingRateMap {
        extent: [shape.part[2], shape.part[3], shape.extent[2]],
        histogram,
        hash: format!("{:016x}", fnv1a(&texels)),
        texels: wanted.then(|| texels.iter().map(|texel| format!("{texel:02x}")).collect()),
    };
    (map, illegal)
}

fn fnv1a(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}
