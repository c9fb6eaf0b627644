use super::*;

#[test]
fn the_visible_shift_grows_with_eccentricity() {
    for (eccentricity_deg, shift) in
        [(0.0, 1.25), (10.0, 14.45), (40.0, 54.05), (-5.0, 1.25), (f32::NAN, 1.25)]
    {
        assert!((visible_shift_arcmin(eccentricity_deg) - shift).abs() < 1e-4, "at {eccentricity_deg}");
    }
}

#[test]
fn the_visible_change_is_that_of_the_sensitivity_and_grows_with_eccentricity() {
    let visible = VisibleChange::new(0.7);
    let stimulus = Stimulus {
        frequency_cpd: 0.5 / 0.7,
        temporal_hz: 8.0,
        eccentricity_deg: 20.0,
        luminance_cd_m2: 50.0,
        area_deg2: 4.0,
    };
    let sensitivity = crate::perception::csf::castle::achromatic(&stimulus, VisualField::Worst);
    assert!((visible.at(20.0) * sensitivity / 2.0 - 1.0).abs() < 1e-4);
    // Of the order of the known thresholds for large flickering fields: a few percent beside the fovea, tens of percent far out.
    assert!((0.01..0.1).contains(&visible.at(10.0)), "{}", visible.at(10.0));
    assert!((0.1..1.0).contains(&visible.at(35.0)), "{}", visible.at(35.0));
    for width_deg in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let change = VisibleChange::new(width_deg).at(20.0);
        assert!(change > 0.0 && change.is_finite(), "{change} for {width_deg}");
    }
}

#[test]
fn changes_are_judged_by_what_is_seen() {
    let (settings, visible) = (RefreshSettings::default(), VisibleChange::new(0.7));
    let threshold = 0.5 * visible.at(20.0);
    assert!((settings.need(3.0 * threshold, &visible, 20.0) - 3.0).abs() < 1e-4);
    assert!(settings.need(threshold, &visible, 10.0) > settings.need(threshold, &visible, 30.0));
    assert_eq!(settings.need(0.0, &visible, 20.0), 0.0);
    assert_eq!(settings.need(f32::NAN, &visible, 20.0), f32::INFINITY);
    let broken = RefreshSettings { change: 0.0, ..settings };
    assert_eq!(broken.need(0.0, &visible, 20.0), f32::INFINITY);
}

#[test]
fn a_scene_cut_is_a_large_share() {
    let settings = RefreshSettings::default();
    assert!(!settings.is_scene_cut(49, 100) && settings.is_scene_cut(50, 100));
    assert!(!settings.is_scene_cut(0, 0));
    assert!(RefreshSettings { cut_share: f32::NAN, ..settings }.is_scene_cut(0, 1));
}

#[test]
fn no_smaller_change_than_the_least_is_refreshed_anywhere() {
    let (settings, visible) = (RefreshSettings::default(), VisibleChange::new(0.7));
    let least = settings.least_change(&visible);
    assert!(least > 0.0 && settings.need(least * 1.01, &visible, 0.0) > 1.0);
    for eccentricity_deg in [0.0, 3.0, 20.0, 60.0, 180.0, f32::NAN] {
        assert!(settings.need(least, &visible, eccentricity_deg) <= 1.0, "at {eccentricity_deg}");
    }
    for change in [0.0, -1.0, f32::NAN] {
        let all = RefreshSettings { change, ..settings };
        assert_eq!(all.least_change(&visible), f32::NEG_INFINITY, "all of it is refreshed");
    }
}
