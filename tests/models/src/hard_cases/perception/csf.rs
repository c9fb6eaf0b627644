//! Contrast sensitivity at and beyond the ends of its domain: `error` is relative, against double precision at the
//! documented clamped stimulus.

use super::Case;
use crate::reference::perception::csf as reference;
use parafovea_core::perception::csf::{Stimulus, VisualField, castle, tursun};

pub(super) fn cases() -> Vec<Case> {
    let usual = Stimulus::default();
    let nan = Stimulus {
        frequency_cpd: f32::NAN,
        temporal_hz: f32::NAN,
        eccentricity_deg: f32::NAN,
        luminance_cd_m2: f32::NAN,
        area_deg2: f32::NAN,
    };
    let mut cases = Vec::new();
    for (case, given, clamped) in [
        ("0 cpd", Stimulus { frequency_cpd: 0.0, ..usual }, Stimulus { frequency_cpd: 0.0625, ..usual }),
        (
            "1e-40 cpd",
            Stimulus { frequency_cpd: 1e-40, ..usual },
            Stimulus { frequency_cpd: 0.0625, ..usual },
        ),
        (
            "infinite frequency",
            Stimulus { frequency_cpd: f32::INFINITY, ..usual },
            Stimulus { frequency_cpd: 64.0, ..usual },
        ),
        ("0 cd/m2", Stimulus { luminance_cd_m2: 0.0, ..usual }, Stimulus { luminance_cd_m2: 1e-3, ..usual }),
        (
            "-1 cd/m2",
            Stimulus { luminance_cd_m2: -1.0, ..usual },
            Stimulus { luminance_cd_m2: 1e-3, ..usual },
        ),
        (
            "10,000 cd/m2",
            Stimulus { luminance_cd_m2: 1e4, ..usual },
            Stimulus { luminance_cd_m2: 1e4, ..usual },
        ),
        (
            "infinite luminance",
            Stimulus { luminance_cd_m2: f32::INFINITY, ..usual },
            Stimulus { luminance_cd_m2: 1e4, ..usual },
        ),
        (
            "120 degrees",
            Stimulus { eccentricity_deg: 120.0, ..usual },
            Stimulus { eccentricity_deg: 120.0, ..usual },
        ),
        (
            "180 degrees",
            Stimulus { eccentricity_deg: 180.0, ..usual },
            Stimulus { eccentricity_deg: 120.0, ..usual },
        ),
        ("no area", Stimulus { area_deg2: 0.0, ..usual }, Stimulus { area_deg2: 1e-4, ..usual }),
        (
            "infinite area",
            Stimulus { area_deg2: f32::INFINITY, ..usual },
            Stimulus { area_deg2: 41_253.0, ..usual },
        ),
        ("90 Hz", Stimulus { temporal_hz: 90.0, ..usual }, Stimulus { temporal_hz: 90.0, ..usual }),
        ("NaN in every member", nan, usual),
    ] {
        let exact = exact(&clamped);
        let achromatic = reference::achromatic(&exact);
        cases.push(sensitivity(
            "castleCSF",
            case.to_owned(),
            castle::achromatic(&given, VisualField::Worst),
            worst(achromatic),
        ));
        if !["0 cpd", "0 cd/m2", "120 degrees", "NaN in every member"].contains(&case) {
            continue;
        }
        let colour = [
            ("red-green", castle::red_green(&given, VisualField::Worst), reference::red_green(&exact)),
            (
                "yellow-violet",
                castle::yellow_violet(&given, VisualField::Worst),
                reference::yellow_violet(&exact),
            ),
        ];
        for (mechanism, got, expected) in colour {
            cases.push(sensitivity("castleCSF", format!("{case}, {mechanism}"), got, worst(expected)));
        }
    }
    for (case, given, clamped) in [
        ("0 cpd", [0.0, 0.0, 100.0], [1e-6, 0.0, 100.0]),
        ("64 cpd, nothing is seen", [64.0, 0.0, 100.0], [64.0, 0.0, 100.0]),
        ("0 cd/m2", [4.0, 0.0, 0.0], [4.0, 0.0, 1e-3]),
        ("180 degrees", [4.0, 180.0, 100.0], [4.0, 120.0, 100.0]),
        ("NaN in every argument", [f32::NAN; 3], [4.0, 0.0, 100.0]),
    ] {
        let [f, theta, l_a] = clamped.map(f64::from);
        let expected = reference::tursun([5.28964, 6.22567, 3.40410, 4.01061], 0.0398141, f, theta, l_a);
        let got = tursun::sensitivity(given[0], given[1], given[2]);
        cases.push(sensitivity("Tursun", case.to_owned(), got, expected));
    }
    cases
}

fn worst((temporal, nasal): (f64, f64)) -> f64 {
    temporal.max(nasal)
}

fn exact(s: &Stimulus) -> reference::Stimulus {
    reference::Stimulus {
        rho: s.frequency_cpd.into(),
        omega: s.temporal_hz.into(),
        eccentricity: s.eccentricity_deg.into(),
        luminance: s.luminance_cd_m2.into(),
        area: s.area_deg2.into(),
    }
}

fn sensitivity(model: &'static str, case: String, got: f32, expected: f64) -> Case {
    // f32 ends there.
    let expected = expected.max(2f64.powi(-126));
    let error = (f64::from(got) / expected - 1.0).abs();
    Case {
        model,
        case,
        expected: format!("{expected:.5e} within 1e-4 of itself"),
        got: format!("{got:.5e}"),
        error: Some(error),
        passed: error < 1e-4,
    }
}
