use super::*;
use proptest::prelude::*;

const HEADER: &str = "loudness_lufs,frequency_khz,gamma_vis,mu\n";

fn rejected(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

#[test]
fn a_study_is_read_in_either_unit_and_any_order() {
    let text = "\u{feff}# made by hand\nparticipant, mu,gamma_vis ,frequency_khz,loudness_lufs\r\n\
                7,4.65,0,5.42,-18.54\r\n# a remark\n8, 3.5 ,2.5e4,0.05,-80\n";
    let entries = parse(text).unwrap();
    assert_eq!(entries.len(), 2);
    assert!((entries[0].gamma_ld - 16.46).abs() < 1e-5);
    assert!((entries[0].gamma_fq_kilomel - 2.443_590_5).abs() < 1e-5);
    assert_eq!((entries[0].gamma_vis, entries[0].mu), (0.0, 4.65));
    // Below the range of the model.
    assert_eq!(entries[1], Entry { gamma_ld: 0.0, gamma_fq_kilomel: 1.0, gamma_vis: 2.5e4, mu: 3.5 });

    let features = parse("gamma_ld,gamma_fq,gamma_vis,mu\n\"16.46\",2.0,0,4.65").unwrap();
    assert_eq!(features[0], Entry { gamma_ld: 16.46, gamma_fq_kilomel: 2.0, gamma_vis: 0.0, mu: 4.65 });
    assert_eq!(parse(HEADER), Ok(vec![]));
}

#[test]
fn errors_say_where_what_and_what_is_allowed() {
    for (row, message) in [
        ("-18.5,5.4,0,good", "line 3, column mu: \"good\" is not allowed; allowed: a number from 0 to 100"),
        (
            "-18.5,5420,0,4",
            "line 3, column frequency_khz: \"5420\" is not allowed; allowed: a number from 0.02 to 20",
        ),
        (
            "-inf,5.4,0,4",
            "line 3, column loudness_lufs: \"-inf\" is not allowed; allowed: a number from -200 to 20",
        ),
        (
            "-18.5,5.4,NaN,4",
            "line 3, column gamma_vis: \"NaN\" is not allowed; allowed: a number from 0 to 1000000000",
        ),
        (
            "-18.5,5.4,,4",
            "line 3, column gamma_vis: \"\" is not allowed; allowed: a number from 0 to 1000000000",
        ),
        ("-18.5,5.4,0", "line 3 has 3 fields; the header has 4"),
    ] {
        assert_eq!(rejected(&format!("{HEADER}-20,1,0,3\n{row}\n")), message);
    }
    assert_eq!(
        rejected("# a\nloudness,frequency_khz,gamma_vis,mu\n"),
        "line 2: there is no column loudness_lufs or gamma_ld; the header has: loudness, frequency_khz, gamma_vis, mu",
    );
    assert_eq!(
        rejected("gamma_fq,loudness_lufs,frequency_khz,gamma_vis,mu\n"),
        "line 1: frequency_khz and gamma_fq have the same meaning; remove one of them",
    );
    assert_eq!(
        rejected("loudness_lufs,frequency_khz,gamma_vis,mu,mu\n"),
        "line 1: mu and mu have the same meaning; remove one of them",
    );
    for newline in ["\n", "\r\n"] {
        let text = format!("# a\n\n{HEADER}-20,1,0,3\n\n# b\n#c\n-20,1,0,x\n").replace('\n', newline);
        assert!(rejected(&text).starts_with("line 8, column mu:"), "{}", rejected(&text));
        let text = format!("{HEADER}\n\"-20\",1,0,3\n# b\n-20,1\n").replace('\n', newline);
        assert!(rejected(&text).starts_with("line 5 has 2 fields"), "{}", rejected(&text));
    }
    assert_eq!(rejected(""), "the study is empty; the first line names the columns");
    assert_eq!(rejected("# only a remark"), "the study is empty; the first line names the columns");
}

#[test]
fn identical_features_are_averaged() {
    let entry = |gamma_ld, gamma_vis, mu| Entry { gamma_ld, gamma_fq_kilomel: 1.5, gamma_vis, mu };
    let entries = [
        entry(20.0, 0.0, 4.0),
        entry(10.0, 5.0, 1.0),
        entry(20.0, -0.0, 3.0),
        entry(10.0, 0.0, 2.0),
        entry(20.0, 0.0, 5.0),
    ];
    let expected = [entry(10.0, 0.0, 2.0), entry(10.0, 5.0, 1.0), entry(20.0, 0.0, 4.0)];
    assert_eq!(averaged(&entries), expected);
    // Rounding in the eighth digit is not a difference, in the sixth it is.
    let text = format!("{HEADER}-18.54,5.42,0,4\n-18.540000001,5.42,0,2\n-18.5401,5.42,0,1\n");
    let merged = averaged(&parse(&text).unwrap());
    assert_eq!(merged.iter().map(|entry| entry.mu).collect::<Vec<_>>(), [1.0, 3.0]);
}

proptest! {
    #[test]
    fn averaging_does_not_depend_on_the_order(
        entries in prop::collection::vec((0u8..3, 0u8..2, 0u8..5), 0..20),
        seed: u64,
    ) {
        let entry = |&(ld, fq, mu): &(u8, u8, u8)| Entry {
            gamma_ld: ld.into(), gamma_fq_kilomel: f32::from(fq) + 1.0, gamma_vis: 0.0, mu: mu.into(),
        };
        let mut entries: Vec<Entry> = entries.iter().map(entry).collect();
        let expected = averaged(&entries);
        let length = entries.len().max(1) as u64;
        entries.rotate_left((seed % length) as usize);
        entries.reverse();
        prop_assert_eq!(averaged(&entries), expected);
    }

    #[test]
    fn any_text_is_read_or_rejected(text in "[-0-9,.\"#a-z\n\r\\PC]{0,80}", header: bool) {
        let text = if header { format!("{HEADER}{text}") } else { text };
        if let Ok(entries) = parse(&text) {
            for entry in entries {
                prop_assert!(entry.mu.is_finite() && (1.0..=2.5457).contains(&entry.gamma_fq_kilomel));
            }
        }
    }
}
