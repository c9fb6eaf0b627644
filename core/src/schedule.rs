//! Which parts of the picture are rendered anew in a frame (paper B).
