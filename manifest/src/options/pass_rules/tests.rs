use super::*;
use proptest::prelude::*;

fn rules(text: &str) -> Result<PassRules, PassRulesError> {
    text.parse()
}

#[test]
fn rules_are_read_in_their_order() {
    let rules = rules("exclude 2048x2048; left R16G16B16A16_SFLOAT 1440x1600 #2 flipped;").unwrap();
    let [exclude, left] = rules.iter().collect::<Vec<_>>()[..] else { panic!("{rules:?}") };
    assert_eq!((exclude.kind, exclude.extent), (PassKind::Exclude, Some([2048, 2048])));
    assert_eq!((exclude.format, exclude.ordinal, exclude.way_up), (None, None, None));
    assert_eq!(left.format.unwrap().value(), 97);
    assert_eq!((left.kind, left.extent), (PassKind::Left, Some([1440, 1600])));
    assert_eq!((left.ordinal, left.way_up), (Some(2), Some(WayUp::Flipped)));
}

#[test]
fn no_text_is_no_rules() {
    assert_eq!(rules(" ; "), Ok(PassRules::default()));
}

/// Errors name the word that is wrong, and the allowed words.
#[test]
fn errors_name_what_is_allowed() {
    for (text, words) in [
        ("skip 64x64", &["\"skip\"", "exclude", "left", "right", "either", "double-wide", "array"][..]),
        ("left 64x", &["\"64x\"", "R16G16B16A16_SFLOAT", "1440x1600", "#1", "upright", "flipped"]),
        ("left 64x64 0x9", &["\"0x9\"", "a size"]),
        ("left #0", &["\"#0\"", "from 1"]),
        ("left +8x8", &["\"+8x8\""]),
        ("left 8x8 9x9", &["\"9x9\"", "a second value of this kind"]),
        ("exclude; left 8x8", &["\"exclude\"", "a size or a number"]),
        ("left 1x1;left 2x2;left 3x3;left 4x4;left 5x5;left 6x6;left 7x7;left 8x8;left 9x9", &["at most 8"]),
    ] {
        let error = rules(text).unwrap_err().to_string();
        for word in words {
            assert!(error.contains(word), "{text}: {error}");
        }
    }
}

fn any_rule() -> impl Strategy<Value = PassRule> {
    let kinds = prop::sample::select(KINDS.map(|(_, kind)| kind).to_vec());
    let ways = prop::option::of(prop::sample::select(WAYS_UP.map(|(_, way)| way).to_vec()));
    let extent = prop::array::uniform2(1..=u32::MAX);
    let format = prop::option::of(prop::sample::select(COLOR_FORMATS.to_vec()));
    (kinds, format, extent, prop::option::of(1..=u32::MAX), ways).prop_map(
        |(kind, format, extent, ordinal, way_up)| PassRule {
            kind,
            format,
            extent: Some(extent),
            ordinal,
            way_up,
        },
    )
}

proptest! {
    #[test]
    fn rules_are_written_as_they_are_read(list in prop::collection::vec(any_rule(), 0..=MOST_RULES)) {
        let mut all = PassRules::default();
        for (place, rule) in all.rules.iter_mut().zip(&list) {
            *place = Some(*rule);
        }
        prop_assert_eq!(all.to_string().parse(), Ok(all));
    }

    #[test]
    fn any_text_is_rules_or_an_error(text in "[a-z0-9#;x _A-Z]{0,40}") {
        if let Ok(read) = text.parse::<PassRules>() {
            prop_assert_eq!(read.to_string().parse(), Ok(read));
        }
    }
}
