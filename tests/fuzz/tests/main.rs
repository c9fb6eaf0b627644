//! A few thousand of the inputs that `cargo dev fuzz` makes millions of.

use parafovea_fuzz::{TARGETS, Until, run};

#[test]
fn a_few_inputs_of_each_target() {
    for target in &TARGETS {
        let executions = run(target, 1, Until::Executions(3000));
        let executions = executions.unwrap_or_else(|finding| {
            panic!("{}: {}\n{:?}", target.name, finding.what, String::from_utf8_lossy(&finding.input))
        });
        assert_eq!(executions, 3000, "{}", target.name);
    }
}
