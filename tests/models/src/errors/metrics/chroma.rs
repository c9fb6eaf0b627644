//! The two colour mechanisms of castleCSF.

use crate::errors::clip::{Picture, Viewing};
use glam::{DMat3, DVec3, Vec3};
use parafovea_core::image::Plane;

/// BT.709 primaries in linear light to CIE 1931 XYZ (IEC 61966-2-1), by columns.
const RGB_TO_XYZ: DMat3 = DMat3::from_cols(
    DVec3::new(0.4124, 0.2126, 0.0193),
    DVec3::new(0.3576, 0.7152, 0.1192),
    DVec3::new(0.1805, 0.0722, 0.9505),
);

/// CIE 2006 cone responses to CIE 1931 XYZ on an LED display, as castleCSF has it (`lms2006_2xyz`), by columns.
const LMS_TO_XYZ: DMat3 = DMat3::from_cols(
    DVec3::new(2.629_129_278_399_65, 0.865_649_062_438_827, -0.008_886_561_474_676),
    DVec3::new(-3.780_202_391_780_134, 1.215_555_811_642_301, 0.081_612_628_990_755),
    DVec3::new(10.294_956_387_893_45, -0.984_175_688_105_352, 51.371_024_830_897_89),
);

/// castleCSF's mechanisms (`get_lms2acc` with `colmat` 2.3112, 0, 0, 50.9875): achromatic L + M, red-green
/// L - 2.3112 M, yellow-violet 50.9875 S - L - M; by columns. The latter two are about 0 for D65's grey.
const LMS_TO_ACC: DMat3 = DMat3::from_cols(
    DVec3::new(1.0, 1.0, -1.0),
    DVec3::new(1.0, -2.3112, -1.0),
    DVec3::new(0.0, 0.0, 50.9875),
);

/// Responses of the opponent mechanisms to red, green and blue light, scaled so that white has achromatic 1.
pub(crate) struct Opponent {
    red_green: Vec3,
    yellow_violet: Vec3,
}

impl Opponent {
    pub fn new() -> Self {
        let rgb_to_acc = LMS_TO_ACC * LMS_TO_XYZ.inverse() * RGB_TO_XYZ;
        let white = rgb_to_acc.row(0).dot(DVec3::ONE);
        let [_, red_green, yellow_violet] = [0, 1, 2].map(|row| (rgb_to_acc.row(row) / white).as_vec3());
        Self { red_green, yellow_violet }
    }

    /// Change of the red-green and of the yellow-violet response, in cd/m^2, as castleCSF's contrasts of colour are
    /// such a change over the achromatic response of the surroundings.
    pub fn changes(&self, reference: &Picture, test: &Picture, viewing: &Viewing) -> [Plane; 2] {
        let scale = viewing.white_cd_m2 - viewing.black_cd_m2();
        [self.red_green, self.yellow_violet].map(|weights| {
            let mut change = test.weighted(weights * scale, 0.0);
            let before = reference.weighted(weights * scale, 0.0);
            change.texels_mut().iter_mut().zip(before.texels()).for_each(|(after, before)| *after -= before);
            change
        })
    }
}

#[cfg(test)]
mod tests;
