use super::*;

const GOOD: Evidence =
    Evidence { in_history: true, eccentricity_deg: 20.0, shift_arcmin: 0.0, content_change: 0.0 };

#[test]
fn the_visible_shift_grows_with_eccentricity() {
    for (eccentricity_deg, shift) in
        [(0.0, 1.25), (10.0, 14.45), (40.0, 54.05), (-5.0, 1.25), (f32::NAN, 1.25)]
    {
        assert!((visible_shift_arcmin(eccentricity_deg) - shift).abs() < 1e-4, "at {eccentricity_deg}");
    }
}

#[test]
fn evidence_is_judged() {
    let settings = RefreshSettings::default();
    let judge = |evidence| settings.judge(&evidence);
    assert_eq!(judge(GOOD), Refresh::Unneeded);
    assert_eq!(judge(Evidence { in_history: false, ..GOOD }), Refresh::Required);
    // 1.25 + 26.4 arc minutes are seen at 20 degrees.
    assert_eq!(judge(Evidence { shift_arcmin: 27.6, ..GOOD }), Refresh::Unneeded);
    assert!(matches!(judge(Evidence { shift_arcmin: 2.0 * 27.65, ..GOOD }), Refresh::Wanted(need)
        if (need - 2.0).abs() < 1e-5));
    assert_eq!(judge(Evidence { content_change: 0.049, ..GOOD }), Refresh::Unneeded);
    assert_eq!(judge(Evidence { content_change: 0.2, ..GOOD }), Refresh::Wanted(4.0));
    assert_eq!(
        judge(Evidence { shift_arcmin: 2.0 * 27.65, content_change: 0.2, ..GOOD }),
        Refresh::Wanted(4.0)
    );
    for evidence in [
        Evidence { shift_arcmin: f32::NAN, ..GOOD },
        Evidence { content_change: f32::NAN, ..GOOD },
        Evidence { content_change: f32::INFINITY, ..GOOD },
    ] {
        assert_eq!(judge(evidence), Refresh::Wanted(f32::INFINITY));
    }
    let broken = RefreshSettings { content_change: 0.0, ..settings };
    assert_eq!(broken.judge(&GOOD), Refresh::Wanted(f32::INFINITY));
}

#[test]
fn a_scene_cut_is_a_large_share() {
    let settings = RefreshSettings::default();
    assert!(!settings.is_scene_cut(49, 100) && settings.is_scene_cut(50, 100));
    assert!(!settings.is_scene_cut(0, 0));
    assert!(RefreshSettings { cut_share: f32::NAN, ..settings }.is_scene_cut(0, 1));
}
