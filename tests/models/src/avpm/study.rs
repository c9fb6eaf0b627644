//! Data of a user study (paper A, Algorithm 1, lines 1-8).

/// One row of D of Algorithm 1: features of sound and picture, and their score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Loudness units, 0..=25.
    pub gamma_ld: f32,
    /// Kilo-mel, 1..=2.5457: the range of the budget.
    pub gamma_fq_kilomel: f32,
    /// Visual loss of Eq. 11, >= 0, in units of Tursun's sensitivity.
    pub gamma_vis: f32,
    /// Score, or a mean of scores.
    pub mu: f32,
}

/// Algorithm 1, line 8: entries with identical features become one, with the mean of their scores, in the order of
/// loudness, frequency and visual loss.
///
/// Identical means equal as f32, to seven digits.
pub fn averaged(entries: &[Entry]) -> Vec<Entry> {
    // + 0 makes -0 equal to 0.
    let key = |entry: &Entry| [entry.gamma_ld, entry.gamma_fq_kilomel, entry.gamma_vis].map(|x| x + 0.0);
    let mut sorted = entries.to_vec();
    sorted.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.iter().zip(&b).fold(std::cmp::Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(b)))
    });
    let same = |a: &Entry, b: &Entry| key(a).map(f32::to_bits) == key(b).map(f32::to_bits);
    let mean = |group: &[Entry]| {
        let sum: f64 = group.iter().map(|entry| f64::from(entry.mu)).sum();
        Entry { mu: (sum / group.len() as f64) as f32, ..group[0] }
    };
    sorted.chunk_by(same).map(mean).collect()
}

#[cfg(test)]
mod tests;
