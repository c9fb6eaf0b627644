use super::*;
use crate::perception::csf::VisualField;
use crate::perception::csf::castle::{achromatic, achromatic_fall};
use proptest::prelude::*;

proptest! {
    #[test]
    fn close_to_the_formula(
        octave in -1.0..6.0f32, omega in 0.0..20.0f32, eccentricity_deg in 0.0..100.0f32,
        // But for the step between 0.009 and 0.032 cd/m^2.
        decade in prop_oneof![1 => -3.0..-2.046f32, 5 => -1.494..4.0f32],
    ) {
        let luminance_cd_m2 = 10f32.powf(decade);
        let falls = FovealTable::new(omega, 0.6).falls(octave.exp2(), luminance_cd_m2);
        for (band, fall) in falls.into_iter().enumerate() {
            let stimulus = Stimulus {
                frequency_cpd: (octave - band as f32).exp2(),
                temporal_hz: omega,
                eccentricity_deg,
                luminance_cd_m2,
                area_deg2: 0.6,
            };
            let exact = achromatic(&stimulus, VisualField::Worst);
            let ratio = fall.at(eccentricity_deg, VisualField::Worst) / exact;
            prop_assert!((ratio - 1.0).abs() < 0.02 || exact < 1e-30, "{ratio} {stimulus:?}");
        }
    }

    #[test]
    fn finite_whatever_comes_in(bits in any::<[u32; 4]>()) {
        let [omega, area, frequency, luminance] = bits.map(f32::from_bits);
        for fall in FovealTable::new(omega, area).falls(frequency, luminance) {
            prop_assert!(fall.log2_foveal.is_finite());
            prop_assert!(fall.log2_per_deg_temporal > 0.0 && fall.log2_per_deg_nasal > 0.0);
        }
    }
}

#[test]
fn without_a_number_the_usual_stimulus() {
    let fall = FovealTable::new(f32::NAN, f32::NAN).falls(f32::NAN, f32::NAN)[0];
    let usual = achromatic_fall(&Stimulus::default());
    assert!((fall.log2_foveal - usual.log2_foveal).abs() < 0.01);
    assert_eq!(fall.log2_per_deg_nasal, usual.log2_per_deg_nasal);
}

#[test]
fn bands_below_the_domain_are_at_its_end() {
    let falls = FovealTable::new(0.0, 1.0).falls(0.1, 100.0);
    assert_eq!(falls[1], falls[2]);
    assert_eq!(falls[2], falls[3]);
}
