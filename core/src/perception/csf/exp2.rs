//! Powers of two, for loops over tiles.

/// 2^`x` to within 3e-7 of itself, for x within -126..=127, to which others are clamped; NaN counts as -126.
///
/// The library's `exp2` is a call of 5 ns; this is a few operations, of which a compiler does four or eight at a time.
#[inline]
pub(super) fn exp2(x: f32) -> f32 {
    /// Adding it leaves the nearest integer in the last bits of the sum.
    const TO_INTEGER: f32 = 12_582_912.0; // 1.5 * 2^23
    // Minimax in relative error over -0.5..=0.5: 7.5e-8.
    const C: [f32; 6] =
        [1.000_000_1, 0.693_146_97, 0.240_221_2, 0.055_507_13, 0.009_675_541, 0.001_327_647_1];
    let x = if x > -126.0 { x.min(127.0) } else { -126.0 };
    let shifted = x + TO_INTEGER;
    let t = x - (shifted - TO_INTEGER);
    let mantissa = C[0] + t * (C[1] + t * (C[2] + t * (C[3] + t * (C[4] + t * C[5]))));
    // Bits of `shifted` beyond the integer leave by the shift.
    let exponent = shifted.to_bits() << 23;
    f32::from_bits(mantissa.to_bits().wrapping_add(exponent))
}

#[cfg(test)]
mod tests;
