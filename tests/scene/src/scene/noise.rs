//! Repeating value noise without a random number generator: the same texels on every machine.

/// A hash of a lattice point to 0..1 (the finaliser of MurmurHash3 over packed coordinates).
pub fn hash(x: u32, y: u32, seed: u32) -> f32 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ seed.wrapping_mul(0xc2b2_ae3d);
    h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    ((h ^ (h >> 16)) >> 8) as f32 / (1 << 24) as f32
}

/// Smooth noise in 0..1 that repeats every unit of `u` and `v`, with `cells` x `cells` lattice points.
pub fn value(u: f32, v: f32, cells: u32, seed: u32) -> f32 {
    let (x, y) = (u.rem_euclid(1.0) * cells as f32, v.rem_euclid(1.0) * cells as f32);
    let (i, j) = (x as u32, y as u32);
    let smooth = |t: f32| t * t * (3.0 - 2.0 * t);
    let (s, t) = (smooth(x - i as f32), smooth(y - j as f32));
    let at = |dx, dy| hash((i + dx) % cells, (j + dy) % cells, seed);
    let near = at(0, 0) + (at(1, 0) - at(0, 0)) * s;
    let far = at(0, 1) + (at(1, 1) - at(0, 1)) * s;
    near + (far - near) * t
}

/// A sum of octaves of [`value`], each twice as fine and half as strong, in 0..1.
pub fn fractal(u: f32, v: f32, cells: u32, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut weight, mut total) = (0.0, 0.5, 0.0);
    for octave in 0..octaves {
        sum += weight * value(u, v, cells << octave, seed + octave);
        total += weight;
        weight *= 0.5;
    }
    sum / total
}
