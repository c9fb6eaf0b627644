//! What one frame shall do, for each eye.
