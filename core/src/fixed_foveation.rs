//! Fixed foveated rendering, the baseline of paper A.
