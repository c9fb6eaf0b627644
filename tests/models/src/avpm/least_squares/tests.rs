use super::*;
use proptest::prelude::*;

#[test]
fn a_system_that_has_a_solution_is_solved() {
    let rows = [[1.0, 2.0], [3.0, 4.0], [5.0, 7.0]];
    let targets = [5.0, 11.0, 19.0];
    let solution = non_negative(&rows, &targets).unwrap();
    assert!((solution.x[0] - 1.0).abs() < 1e-12 && (solution.x[1] - 2.0).abs() < 1e-12);
    assert!(solution.residual < 1e-24);
}

#[test]
fn a_coefficient_that_would_be_negative_is_held_at_zero() {
    // Without the constraint (2, -1).
    let rows = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let solution = non_negative(&rows, &[2.0, -1.0, 1.0]).unwrap();
    assert!((solution.x[0] - 1.5).abs() < 1e-12);
    assert_eq!(solution.x[1], 0.0);
    assert!((solution.residual - 1.5).abs() < 1e-12);
    // Both held: the targets remain.
    assert_eq!(non_negative(&rows, &[-1.0, -2.0, -2.0]), Some(Solution { x: [0.0; 2], residual: 9.0 }));
}

#[test]
fn columns_that_depend_on_each_other_have_no_solution() {
    let targets = [1.0, 2.0, 3.0, 4.0];
    assert_eq!(non_negative(&[[1.0, 2.0], [2.0, 4.0], [3.0, 6.0], [4.0, 8.0]], &targets), None);
    assert_eq!(non_negative(&[[1.0, 0.0], [2.0, 0.0]], &targets), None);
    // The columns differ by no more than rounding.
    assert_eq!(non_negative(&[[1.0, 1.0], [1.0, 1.0 + 1e-7], [1.0, 1.0]], &targets), None);
    // Fewer rows than columns, none, no numbers, numbers that overflow.
    assert_eq!(non_negative(&[[1.0, 2.0]], &targets), None);
    assert_eq!(non_negative::<2>(&[], &targets), None);
    assert_eq!(non_negative(&[[1.0], [f64::NAN]], &targets), None);
    assert_eq!(non_negative(&[[1.0], [1e200]], &targets), None);
    assert_eq!(non_negative(&[[1.0], [1.0]], &[f64::INFINITY, 0.0]), None);
}

#[test]
fn rank_counts_independent_columns() {
    assert_eq!(rank(&[[1.0, 2.0, 3.0], [4.0, 5.0, 9.0], [7.0, 8.0, 15.0]]), 2);
    assert_eq!(rank(&[[0.0, 0.0], [0.0, 0.0]]), 0);
    assert_eq!(rank(&[[0.0, 1.0], [0.0, 2.0]]), 1);
    // Scale does not matter.
    assert_eq!(rank(&[[1e-30, 1e30], [-1e-30, 1e30]]), 2);
}

proptest! {
    /// The conditions of Karush, Kuhn and Tucker, which only the solution of a convex problem meets: x >= 0, the
    /// gradient >= 0, and one of both 0 in each coordinate.
    #[test]
    fn the_solution_is_optimal(
        rows in prop::collection::vec(prop::array::uniform4(-10.0f64..10.0), 4..30),
        scores in prop::collection::vec(-10.0f64..10.0, 30),
    ) {
        let targets = &scores[..rows.len()];
        prop_assume!(rank(&rows) == 4);
        let solution = non_negative(&rows, targets).unwrap();
        for column in 0..4 {
            let gradient: f64 = rows
                .iter()
                .zip(targets)
                .map(|(row, target)| row[column] * (dot(row, &solution.x) - target))
                .sum();
            prop_assert!(solution.x[column] >= 0.0 && gradient >= -1e-7);
            prop_assert!(solution.x[column] == 0.0 || gradient <= 1e-7);
        }
    }
}
