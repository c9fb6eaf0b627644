use super::*;

#[test]
fn grey_has_no_colour_and_primaries_have_theirs() {
    let Opponent { red_green, yellow_violet } = Opponent::new();
    assert!(red_green.dot(Vec3::ONE).abs() < 0.01 && yellow_violet.dot(Vec3::ONE).abs() < 0.02);
    assert!(red_green.x > 0.1 && red_green.y < -0.05, "{red_green}");
    assert!(yellow_violet.z > 0.5 && yellow_violet.x < 0.0 && yellow_violet.y < 0.0, "{yellow_violet}");
}

/// The D65 white that castleCSF's authors give in `lms2006`: L 0.7347, M 0.3163, S 0.0208.
#[test]
fn cones_see_d65_as_published() {
    let lms = LMS_TO_XYZ.inverse() * (RGB_TO_XYZ * DVec3::ONE);
    assert!((lms - DVec3::new(0.7347, 0.3163, 0.0208)).length() < 2e-3, "{lms}");
}
