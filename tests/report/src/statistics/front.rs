//! The Pareto front of points, and interpolation between them.

/// Cost and loss of a technique.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostAndLoss {
    /// Above 0, in any unit.
    pub cost: f64,
    /// 0 for nothing, in any unit.
    pub loss: f64,
}

/// Indices of the `points` on the Pareto front: every other point costs more or loses more. In ascending order of cost, and so in
/// descending order of loss. Of equal ones the first counts; points with a NaN are left out.
pub fn front(points: &[CostAndLoss]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len())
        .filter(|&index| !(points[index].cost.is_nan() || points[index].loss.is_nan()))
        .collect();
    order.sort_by(|&a, &b| {
        points[a].cost.total_cmp(&points[b].cost).then(points[a].loss.total_cmp(&points[b].loss))
    });
    let mut least = f64::INFINITY;
    order.retain(|&index| {
        let is_less = points[index].loss < least;
        least = least.min(points[index].loss);
        is_less
    });
    order
}

/// Loss of a sweep at a cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AtCost {
    /// So much.
    Loss(f64),
    /// It gets no cheaper than its cheapest point, which loses so much.
    OutOfReach {
        /// The loss of the cheapest point.
        cheapest: f64,
    },
}

/// Least loss of a sweep at a cost of at most `cost`: that of its [`front`], interpolated linearly over the logarithm of the cost;
/// beyond the most expensive point, the loss of that point. None without points.
pub fn loss_at(points: &[CostAndLoss], cost: f64) -> Option<AtCost> {
    let front = front(points);
    let (first, last) = (points[*front.first()?], points[*front.last()?]);
    if cost < first.cost {
        return Some(AtCost::OutOfReach { cheapest: first.loss });
    }
    let next = front.iter().position(|&index| points[index].cost > cost);
    Some(AtCost::Loss(match next {
        None => last.loss,
        Some(next) => {
            let (from, to) = (points[front[next - 1]], points[front[next]]);
            let into = (cost / from.cost).ln() / (to.cost / from.cost).ln();
            from.loss + into * (to.loss - from.loss)
        }
    }))
}

/// Least cost of a sweep at a loss of at most `loss`: that of its [`front`], interpolated as in [`loss_at`]; for greater losses than that of
/// its cheapest point, the cost of that point. `None` if every point loses more.
pub fn cost_at(points: &[CostAndLoss], loss: f64) -> Option<f64> {
    let front = front(points);
    let reached = front.iter().position(|&index| points[index].loss <= loss)?;
    let to = points[front[reached]];
    let Some(from) = reached.checked_sub(1).map(|before| points[front[before]]) else { return Some(to.cost) };
    let into = (from.loss - loss) / (from.loss - to.loss);
    Some(from.cost * (to.cost / from.cost).powf(into))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(points: &[(f64, f64)]) -> Vec<CostAndLoss> {
        points.iter().map(|&(cost, loss)| CostAndLoss { cost, loss }).collect()
    }

    #[test]
    fn the_front_has_what_no_other_point_beats() {
        let all =
            points(&[(1.0, 0.0), (0.5, 4.0), (0.7, 2.0), (0.8, 3.0), (0.5, 5.0), (1.2, 0.0), (0.7, 2.0)]);
        assert_eq!(front(&all), [1, 2, 0]);
        assert!(front(&[]).is_empty());
        assert_eq!(front(&points(&[(f64::NAN, 0.0), (0.3, f64::NAN), (1.0, 1.0)])), [2]);
    }

    #[test]
    fn between_points_the_loss_is_on_a_line_over_log_cost() {
        // Halfway from 0.25 to 1 in the logarithm is 0.5.
        let sweep = points(&[(1.0, 0.0), (0.25, 8.0)]);
        assert_eq!(loss_at(&sweep, 0.5), Some(AtCost::Loss(4.0)));
        assert_eq!(loss_at(&sweep, 0.25), Some(AtCost::Loss(8.0)));
        assert_eq!(loss_at(&sweep, 1.0), Some(AtCost::Loss(0.0)));
    }

    #[test]
    fn costs_and_losses_are_of_one_line() {
        let sweep = points(&[(1.0, 0.0), (0.25, 8.0), (0.4, 9.0), (0.5, 3.0)]);
        for cost in [0.25, 0.3, 0.5, 0.8, 1.0] {
            let Some(AtCost::Loss(loss)) = loss_at(&sweep, cost) else { panic!("out of reach") };
            let found = cost_at(&sweep, loss).unwrap();
            assert!((found - cost).abs() < 1e-12, "{found}, not {cost}");
        }
        assert_eq!(cost_at(&sweep, 20.0), Some(0.25));
        assert_eq!(cost_at(&points(&[(0.5, 3.0)]), 2.0), None);
    }

    #[test]
    fn more_need_not_be_spent_and_less_cannot_be_had() {
        let sweep = points(&[(0.9, 1.0), (0.5, 3.0), (0.6, 7.0)]);
        assert_eq!(loss_at(&sweep, 2.0), Some(AtCost::Loss(1.0)));
        assert_eq!(loss_at(&sweep, 0.4), Some(AtCost::OutOfReach { cheapest: 3.0 }));
        assert_eq!(loss_at(&[], 0.4), None);
        // The point at 0.6 is beaten, and bends nothing.
        let Some(AtCost::Loss(loss)) = loss_at(&sweep, 0.6) else { panic!("out of reach") };
        let expected = 3.0 - 2.0 * (0.6_f64 / 0.5).ln() / (0.9_f64 / 0.5).ln();
        assert!((loss - expected).abs() < 1e-12, "{loss}, not {expected}");
    }
}
