//! Linear least squares with coefficients that must not be negative, for the few unknowns of Eq. 13.
//!
//! The solution is the best of the ordinary solutions on each set of columns among those without a negative
//! coefficient (the problem is convex, and on the columns that are above 0 the constraint does not act). Four
//! unknowns have 16 sets, so all are tried: no iteration, and no tolerance that decides when to stop.

/// A column of which the others leave less than this part counts as dependent on them. Features are f32, with seven
/// digits: smaller variations are rounding, which the fit would amplify to coefficients.
const DEPENDENT: f64 = 1e-6;

/// The solution of a least squares problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution<const N: usize> {
    /// x, each >= 0.
    pub x: [f64; N],
    /// Sum of squares of the residuals of x.
    pub residual: f64,
}

/// The x >= 0 for which the sum over rows of (row . x - target)^2 is least.
///
/// `rows` and `targets` have equal length; surplus ones are ignored. N is small: 2^N problems are solved. Nothing where the
/// columns depend on each other, where there are fewer rows than columns, or where a number is NaN or so large that its
/// square is infinite.
pub fn non_negative<const N: usize>(rows: &[[f64; N]], targets: &[f64]) -> Option<Solution<N>> {
    const { assert!(N <= 8, "all sets of columns are tried") };
    let count = rows.len().min(targets.len());
    let (rows, targets) = (&rows[..count], &targets[..count]);
    if rank(rows) < N || !targets.iter().map(|target| target * target).sum::<f64>().is_finite() {
        return None;
    }
    let residual = |x: &[f64; N]| -> f64 {
        let of_row = |(row, target): (&[f64; N], &f64)| (dot(row, x) - target).powi(2);
        rows.iter().zip(targets).map(of_row).sum()
    };
    (0..1u32 << N)
        .filter_map(|set| on_columns(rows, targets, set))
        .filter(|x| x.iter().all(|&x| x >= 0.0))
        .map(|x| Solution { x, residual: residual(&x) })
        .min_by(|a, b| a.residual.total_cmp(&b.residual))
}

/// Number of linearly independent columns, to a part of 1e-6 of each one's length. 0 where a number is NaN or
/// its square infinite.
pub fn rank<const N: usize>(rows: &[[f64; N]]) -> usize {
    let mut columns = Orthogonal::<N>::default();
    (0..N).filter(|&column| columns.add(rows, column)).count()
}

/// The ordinary solution with only the columns of which `set` has the bit; 0 for the others. None if they are
/// dependent.
fn on_columns<const N: usize>(rows: &[[f64; N]], targets: &[f64], set: u32) -> Option<[f64; N]> {
    let mut columns = Orthogonal::<N>::default();
    for column in (0..N).filter(|column| set >> column & 1 == 1) {
        if !columns.add(rows, column) {
            return None;
        }
    }
    Some(columns.solve(targets))
}

/// Q and R of some columns, by Gram and Schmidt with every projection done twice.
struct Orthogonal<const N: usize> {
    /// Column of each step, and its orthogonal unit vector.
    steps: Vec<(usize, Vec<f64>)>,
    /// `r[i][j]`: component of column j along the vector of step i.
    r: [[f64; N]; N],
}

impl<const N: usize> Default for Orthogonal<N> {
    fn default() -> Self {
        Self { steps: Vec::new(), r: [[0.0; N]; N] }
    }
}

impl<const N: usize> Orthogonal<N> {
    /// Takes one more column; returns false, without it, if it depends on the columns before it or is not finite.
    fn add(&mut self, rows: &[[f64; N]], column: usize) -> bool {
        let mut vector: Vec<f64> = rows.iter().map(|row| row[column]).collect();
        let whole = dot(&vector, &vector).sqrt();
        for _ in 0..2 {
            for (i, (_, unit)) in self.steps.iter().enumerate() {
                let along = dot(&vector, unit);
                self.r[i][column] += along;
                vector.iter_mut().zip(unit).for_each(|(x, u)| *x -= along * u);
            }
        }
        let left = dot(&vector, &vector).sqrt();
        let independent = whole.is_finite() && left > DEPENDENT * whole;
        if independent {
            self.r[self.steps.len()][column] = left;
            vector.iter_mut().for_each(|x| *x /= left);
            self.steps.push((column, vector));
        }
        independent
    }

    fn solve(&self, targets: &[f64]) -> [f64; N] {
        let mut x = [0.0; N];
        for (i, (column, unit)) in self.steps.iter().enumerate().rev() {
            let solved: f64 =
                self.steps[i + 1..].iter().map(|(later, _)| self.r[i][*later] * x[*later]).sum();
            x[*column] = (dot(unit, targets) - solved) / self.r[i][*column];
        }
        x
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests;
