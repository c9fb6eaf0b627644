//! Images with their mip chains.

/// Meaning of the bytes of an image when it is filtered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Colour, sRGB-encoded; alpha linear.
    Srgb,
    /// Data, filtered as it is.
    Linear,
}

/// An RGBA8 image and all its mip levels.
#[derive(Clone, Debug)]
pub struct Texture {
    /// Width and height of the first level in texels, powers of two.
    pub size: [u32; 2],
    /// Meaning of the bytes.
    pub encoding: Encoding,
    /// Texels by level, finest first, rows from the top.
    pub levels: Vec<Vec<u8>>,
}

impl Texture {
    /// Makes the mip chain of an image.
    pub fn new(size: [u32; 2], encoding: Encoding, texels: Vec<u8>) -> Self {
        let mut levels = vec![texels];
        let mut current = size;
        while current != [1, 1] {
            let next = current.map(|side| (side / 2).max(1));
            let finer = &levels[levels.len() - 1];
            levels.push(halve(finer, current, next, encoding));
            current = next;
        }
        Self { size, encoding, levels }
    }

    /// Makes an image from a function of the texel centre's `u` and `v`, both 0..1.
    pub fn from_fn(side: u32, encoding: Encoding, texel: impl Fn(f32, f32) -> [f32; 4]) -> Self {
        let mut texels = Vec::with_capacity((side * side * 4) as usize);
        for y in 0..side {
            for x in 0..side {
                let [r, g, b, a] = texel((x as f32 + 0.5) / side as f32, (y as f32 + 0.5) / side as f32);
                let colour = [r, g, b].map(|value| match encoding {
                    Encoding::Srgb => encode(value),
                    Encoding::Linear => quantise(value),
                });
                texels.extend([colour[0], colour[1], colour[2], quantise(a)]);
            }
        }
        Self::new([side, side], encoding, texels)
    }
}

fn halve(finer: &[u8], size: [u32; 2], next: [u32; 2], encoding: Encoding) -> Vec<u8> {
    let decoded: [f32; 256] = std::array::from_fn(|code| match encoding {
        Encoding::Srgb => decode(code as u8),
        Encoding::Linear => code as f32 / 255.0,
    });
    let mut coarser = Vec::with_capacity((next[0] * next[1] * 4) as usize);
    for y in 0..next[1] {
        for x in 0..next[0] {
            for channel in 0..4 {
                let at = |dx: u32, dy: u32| {
                    let (x, y) = ((x * 2 + dx).min(size[0] - 1), (y * 2 + dy).min(size[1] - 1));
                    finer[((y * size[0] + x) * 4 + channel) as usize]
                };
                let samples = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
                coarser.push(if channel == 3 || encoding == Encoding::Linear {
                    (samples.iter().map(|&code| u32::from(code)).sum::<u32>() / 4) as u8
                } else {
                    encode(samples.iter().map(|&code| decoded[usize::from(code)]).sum::<f32>() / 4.0)
                });
            }
        }
    }
    coarser
}

fn quantise(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// The sRGB transfer function (IEC 61966-2-1), linear light 0..1 to a code value.
fn encode(linear: f32) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    quantise(if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 })
}

fn decode(code: u8) -> f32 {
    let encoded = f32::from(code) / 255.0;
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mips_average_light_not_code_values() {
        let black_and_white = [[0, 0, 0, 255], [255, 255, 255, 255]].concat();
        let srgb = Texture::new([2, 1], Encoding::Srgb, black_and_white.clone());
        assert_eq!(srgb.levels[1], [188, 188, 188, 255]);
        let linear = Texture::new([2, 1], Encoding::Linear, black_and_white);
        assert_eq!(linear.levels[1], [127, 127, 127, 255]);
    }
}
