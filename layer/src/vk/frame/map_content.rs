//! The content of a pass's map, as the file of passes shows it.

use crate::backend::MapSize;

/// A map of shading rates with known texels.
pub trait MapContent: Send + Sync + 'static {
    /// Calls `act` once with the size of the map and its texels, which are empty where only the GPU knows them.
    fn read(&self, act: &mut dyn FnMut(MapSize, &[u8]));
}
