//! Fixed foveation of OpenXR Toolkit: two ellipses on the screen, as a baseline beside FR.
//!
//! After its 2023-11 state (`vrs.cpp`, and `setOptionsDefaults` of `layer.cpp`); radii are parts of the image's half
//! sides, so that their angles differ from headset to headset. It also moves the centre sideways by 4 %, which is the
//! caller's to do.

use glam::Vec2;
use parafovea_core::rate::ShadingRate;

/// Rates by position on the screen: 1x1 inside of one ellipse, one rate up to a second, one beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenEllipses {
    /// Vertical half axis of the inner ellipse, part of half the image's height.
    pub inner: f32,
    /// Vertical half axis of the outer ellipse, likewise.
    pub outer: f32,
    /// Horizontal half axes over vertical ones, each as part of its own half side.
    pub horizontal_scale: f32,
    /// Rate between the ellipses.
    pub middle: ShadingRate,
    /// Rate outside of both.
    pub periphery: ShadingRate,
}

impl ScreenEllipses {
    /// Preset "Wide" with the rates "Performance".
    pub const WIDE: Self = Self { inner: 0.55, outer: 0.80, ..Self::BALANCED };
    /// Preset "Balanced" with the rates "Performance".
    pub const BALANCED: Self = Self {
        inner: 0.50,
        outer: 0.60,
        horizontal_scale: 1.25,
        middle: ShadingRate::R2X2,
        periphery: ShadingRate::R4X4,
    };
    /// Preset "Narrow" with the rates "Performance".
    pub const NARROW: Self = Self { inner: 0.30, outer: 0.55, ..Self::BALANCED };

    /// The same ellipses with the rates "Quality".
    pub const fn with_quality_rates(self) -> Self {
        Self { middle: ShadingRate::R2X1, periphery: ShadingRate::R2X2, ..self }
    }

    /// The rate at an offset from the centre, of which 1 is half the image's width or height. NaN, also in a field of this
    /// type, gives 1x1, infinity the periphery.
    pub fn shading_rate(&self, offset: Vec2) -> ShadingRate {
        let radius = Vec2::new(offset.x / self.horizontal_scale, offset.y).length();
        if radius.is_nan() || self.inner.is_nan() || self.outer.is_nan() {
            ShadingRate::R1X1
        } else if radius > self.inner.max(self.outer) {
            self.periphery
        } else if radius > self.inner {
            self.middle
        } else {
            ShadingRate::R1X1
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_follow_the_ellipses() {
        let map = ScreenEllipses::BALANCED;
        for (offset, rate) in [
            ([0.0, 0.49], ShadingRate::R1X1),
            ([0.62, 0.0], ShadingRate::R1X1),
            ([0.0, 0.51], ShadingRate::R2X2),
            ([0.74, 0.0], ShadingRate::R2X2),
            ([0.0, 0.61], ShadingRate::R4X4),
            ([0.76, 0.0], ShadingRate::R4X4),
            ([f32::INFINITY, 0.0], ShadingRate::R4X4),
            ([f32::NAN, 0.0], ShadingRate::R1X1),
        ] {
            assert_eq!(map.shading_rate(offset.into()), rate, "{offset:?}");
        }
        assert_eq!(map.with_quality_rates().shading_rate([0.0, 0.55].into()), ShadingRate::R2X1);
        for broken in [
            ScreenEllipses { inner: f32::NAN, ..map },
            ScreenEllipses { outer: f32::NAN, ..map },
            ScreenEllipses { horizontal_scale: f32::NAN, ..map },
        ] {
            assert_eq!(broken.shading_rate([0.9, 0.9].into()), ShadingRate::R1X1);
        }
    }
}
