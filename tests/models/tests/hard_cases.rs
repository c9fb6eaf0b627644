//! The table of hard cases, asserted.

use parafovea_models::hard_cases::table;

#[test]
fn every_case_is_as_expected() {
    let wrong: Vec<String> =
        table().iter().filter(|case| !case.passed).map(|case| case.to_string()).collect();
    assert!(wrong.is_empty(), "{} cases are wrong:\n{}", wrong.len(), wrong.join("\n"));
}
