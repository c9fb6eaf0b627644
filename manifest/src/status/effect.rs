//! The effect of a technique on frame times, in words.

/// The effect of a technique whose frames take `ratio` times as long as frames without it, with the bounds of a confidence interval: a
/// noun phrase such as "a saving of 35 % (30 to 40 %)" or "a slowdown of 20 % (10 to 30 %)".
pub fn effect([ratio, low, high]: [f32; 3]) -> String {
    let percent = |ratio: f32| ((ratio - 1.0).abs() * 100.0).round();
    let (of_ratio, of_low, of_high) = (percent(ratio), percent(low), percent(high));
    if low < 1.0 && high > 1.0 {
        return format!("no clear effect (a saving of {of_low} % to a slowdown of {of_high} %)");
    }
    match ratio > 1.0 {
        true => format!("a slowdown of {of_ratio} % ({of_low} to {of_high} %)"),
        false => format!("a saving of {of_ratio} % ({of_high} to {of_low} %)"),
    }
}

#[cfg(test)]
mod tests {
    use super::effect;

    #[test]
    fn slowdowns_and_savings_are_named_and_never_negative() {
        assert_eq!(effect([0.65, 0.6, 0.7]), "a saving of 35 % (30 to 40 %)");
        assert_eq!(effect([1.2, 1.1, 1.3]), "a slowdown of 20 % (10 to 30 %)");
        assert_eq!(effect([0.99, 0.95, 1.03]), "no clear effect (a saving of 5 % to a slowdown of 3 %)");
    }
}
