//! Queues.

/// Identity of a queue within its device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct QueueId {
    /// Its family.
    pub family: u32,
    /// Its index in the family.
    pub index: u32,
}
