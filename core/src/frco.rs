//! Foveated rendering cost optimisation: from budget and contrast to a rate (paper A, Eq. 18-20).
