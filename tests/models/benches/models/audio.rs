//! Cost of `audio`.

use criterion::Criterion;

pub fn benches(_criterion: &mut Criterion) {}
