//! Figures from measured points: the Pareto front, the loss of a sweep at a cost, confidence intervals, and the bits that a codec saves.

mod bd_rate;
mod bootstrap;
mod front;

pub use bd_rate::{BdRateError, RatePoint, bd_rate};
pub use bootstrap::{Bootstrap, Interval};
pub use front::{AtCost, CostAndLoss, cost_at, front, loss_at};
