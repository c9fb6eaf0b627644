//! Pictures of each format, and how a result is compared with the reference.

use glam::Vec4;
use parafovea_core::kernels::fill::FillFormat;

/// Smooth gradients, hard edges and noise, in thirds from top to bottom; alpha is anything.
pub fn picture(format: FillFormat, [width, height]: [u32; 2], seed: u32) -> Vec<u8> {
    let noise = |i: u32| ((i.wrapping_add(seed).wrapping_mul(2_654_435_761) >> 13) & 0xff) as f32 / 255.0;
    // Floating point beyond 1, and below 0 where there is a sign.
    let (scale, offset) = match format {
        FillFormat::Float11 => (100.0, 0.0),
        FillFormat::Float16 => (1000.0, -1.0),
        _ => (1.0, 0.0),
    };
    let color = |x: u32, y: u32| {
        let i = y * width + x;
        let rgb = match y * 3 / height.max(3) {
            0 => [x as f32 / width as f32, y as f32 / height as f32, 0.5],
            1 => [1, 2, 4].map(|bit| if (x / 5 + y / 7 + seed) & bit != 0 { 1.0 } else { 0.0 }),
            _ => [noise(i), noise(i ^ 0x5555), noise(i ^ 0xaaaa)],
        };
        let [red, green, blue] = rgb.map(|value| value * scale + offset);
        Vec4::new(red, green, blue, noise(i.wrapping_mul(5)))
    };
    let mut pixels = vec![0; (width * height) as usize * format.texel_size()];
    for (index, texel) in pixels.chunks_exact_mut(format.texel_size()).enumerate() {
        format.encode(color(index as u32 % width, index as u32 / width), texel);
    }
    pixels
}

/// The components of a texel as codes: neighbouring values of the format differ by 1.
fn codes(format: FillFormat, texel: &[u8]) -> [i32; 4] {
    let word = || u32::from_le_bytes([texel[0], texel[1], texel[2], texel[3]]);
    match format {
        FillFormat::Unorm8 | FillFormat::Srgb8 => [0, 1, 2, 3].map(|at| i32::from(texel[at])),
        FillFormat::Unorm10 => {
            [word() & 0x3ff, word() >> 10 & 0x3ff, word() >> 20 & 0x3ff, word() >> 30].map(|code| code as i32)
        }
        FillFormat::Float11 => {
            [word() & 0x7ff, word() >> 11 & 0x7ff, word() >> 22, 0].map(|code| code as i32)
        }
        FillFormat::Float16 => [0, 2, 4, 6].map(|at| {
            let bits = i32::from(u16::from_le_bytes([texel[at], texel[at + 1]]));
            // Sign and magnitude, to a scale without a step at 0.
            if bits & 0x8000 != 0 { 0x8000 - bits } else { bits }
        }),
    }
}

/// Asserts that a result is within one code value a component of the reference, and the same where nothing was skipped.
pub fn assert_matches(
    format: FillFormat,
    expected: &[u8],
    result: &[u8],
    skipped: impl Fn([u32; 2]) -> bool,
    [width, _]: [u32; 2],
) {
    let size = format.texel_size();
    for (index, (expected, result)) in expected.chunks_exact(size).zip(result.chunks_exact(size)).enumerate()
    {
        let pixel = [index as u32 % width, index as u32 / width];
        if !skipped(pixel) {
            assert_eq!(expected, result, "{format:?}: shaded pixel {pixel:?}");
        }
        let (expected, result) = (codes(format, expected), codes(format, result));
        let close = expected.iter().zip(&result).all(|(a, b)| a.abs_diff(*b) <= 1);
        assert!(close, "{format:?}: {result:?} instead of {expected:?} at {pixel:?}");
    }
}
