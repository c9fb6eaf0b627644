//! What contrast there is, and how much of it is seen.
