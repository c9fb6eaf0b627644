//! What is computed from measured points: which are worth having, what a sweep loses at a cost, how sure that is, and how many bits
//! a codec saves.

mod bd_rate;
mod bootstrap;
mod front;

pub use bd_rate::{BdRateError, RatePoint, bd_rate};
pub use bootstrap::{Bootstrap, Interval};
pub use front::{AtCost, CostAndLoss, front, loss_at};
