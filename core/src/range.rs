//! Numbers from outside, brought into the range that a model is defined for.

/// `value` within `least..=greatest`; `if_nan` where it is NaN.
pub(crate) fn within(value: f32, [least, greatest]: [f32; 2], if_nan: f32) -> f32 {
    if value.is_nan() { if_nan } else { value.clamp(least, greatest) }
}
