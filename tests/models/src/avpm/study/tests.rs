use super::*;
use proptest::prelude::*;

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
    // 2^-24 relative is rounding, 2^-10 a difference.
    let merged = averaged(&[entry(20.0, 0.0, 4.0), entry(20.000_000_1, 0.0, 2.0), entry(20.02, 0.0, 1.0)]);
    assert_eq!(merged.iter().map(|entry| entry.mu).collect::<Vec<_>>(), [3.0, 1.0]);
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
}
