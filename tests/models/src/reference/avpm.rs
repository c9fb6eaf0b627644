//! References of `avpm` and `frco`.

/// a, b, c, d of paper A's Eq. 14.
pub const PAPER: [f64; 4] = [0.05, 0.45, 0.19, 3.63];

/// Eq. 1, with an `ITU_min` of one's own; `ITU_max` is -10.
pub fn gamma_ld(lufs: f64, itu_min: f64) -> f64 {
    lufs.max(itu_min).min(-10.0) - itu_min
}

/// Eq. 2, mel.
pub fn mel(hz: f64) -> f64 {
    2595.0 * (1.0 + hz / 700.0).log10()
}

/// Eq. 12.
pub fn score([a, b, c, d]: [f64; 4], gamma_ld: f64, gamma_fq: f64, gamma_vis: f64) -> f64 {
    a * gamma_ld + b / gamma_fq - c * gamma_vis / 10_000.0 + d
}

/// alpha of Eq. 17, of features within their ranges.
pub fn alpha([a, b, c, d]: [f64; 4], threshold: f64, gamma_ld: f64, gamma_fq: f64) -> f64 {
    10_000.0 / c * (a * gamma_ld + b / gamma_fq + d - threshold)
}

/// Eq. 19 with the corrected sign: the sensitivity in the bands, finest first, that an area rate removes.
pub fn loss(bands: &[f64], area_rate: f64) -> f64 {
    let octaves = -area_rate.sqrt().log2();
    bands.iter().enumerate().map(|(i, band)| band * (octaves - i as f64).clamp(0.0, 1.0)).sum()
}

/// Eq. 13 for rows of X and scores: non-negative least squares by descent along one coordinate after the other, which
/// cannot go wrong on a convex problem but needs many turns. Columns are scaled to length 1 meanwhile.
pub fn non_negative_least_squares(rows: &[[f64; 4]], scores: &[f64]) -> [f64; 4] {
    let length: [f64; 4] =
        std::array::from_fn(|j| rows.iter().map(|row| row[j] * row[j]).sum::<f64>().sqrt());
    let scaled: Vec<[f64; 4]> = rows.iter().map(|row| std::array::from_fn(|j| row[j] / length[j])).collect();
    let mut x = [0.0; 4];
    for _ in 0..200_000 {
        for j in 0..4 {
            let slope: f64 = scaled
                .iter()
                .zip(scores)
                .map(|(row, score)| row[j] * (score - (0..4).map(|k| row[k] * x[k]).sum::<f64>()))
                .sum();
            x[j] = (x[j] + slope).max(0.0);
        }
    }
    std::array::from_fn(|j| x[j] / length[j])
}
