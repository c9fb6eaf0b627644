//! The source of decisions.

/// Source of the decision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum GateMode {
    /// The gate, by the cost of frames.
    #[default]
    Auto,
    /// Always on.
    On,
    /// Always off.
    Off,
}
