//! The log's lines about the rates of passes.

use parafovea_manifest::status::Status;
use std::collections::HashSet;

/// The logged rates of one session.
#[derive(Default)]
pub struct AppliedRates {
    /// Names of rates that were logged together.
    logged: HashSet<String>,
    /// Names of the rates in the previous status.
    last: String,
}

impl AppliedRates {
    /// The line for the next status of the session; `None` if its rates were logged before, or differ from the status before: they ramp after
    /// a start, and trials switch them.
    pub fn line(&mut self, status: &Status) -> Option<String> {
        if status.passes_matched == 0 {
            self.last.clear();
            return None;
        }
        let names: Vec<_> = status.rates.tiles.iter().map(|(name, _)| name.as_str()).collect();
        let names = names.join(", ");
        let is_settled = std::mem::replace(&mut self.last, names.clone()) == names;
        if !is_settled || !self.logged.insert(names) {
            return None;
        }
        let share = |(name, share): &(String, f32)| {
            let name = if name == "skipped" { "4x4 blocks skipped" } else { name };
            format!("{name} {:.0} %", share * 100.0)
        };
        let tiles: Vec<_> = status.rates.tiles.iter().map(share).collect();
        let passes =
            if status.passes_matched == 1 { "1 pass" } else { &format!("{} passes", status.passes_matched) };
        Some(format!(
            "rates in {passes} ({}): {:.0} % of the pixels shaded; tiles: {}",
            status.backend,
            status.rates.shaded * 100.0,
            tiles.join(", ")
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_manifest::status::Rates;

    #[test]
    fn rates_are_logged_once_they_have_settled() {
        let status = |passes_matched, tiles: &[(&str, f32)]| {
            let tiles = tiles.iter().map(|(name, share)| ((*name).to_owned(), *share)).collect();
            let rates = Rates { tiles, shaded: 0.4, ..Rates::default() };
            Status { backend: "mask".to_owned(), passes_matched, rates, ..Status::default() }
        };
        let all = status(2, &[("1x1", 1.0)]);
        let masked = status(2, &[("skipped", 0.56), ("1x1", 0.44)]);
        let alone = status(0, &[("1x1", 1.0)]);
        let mut applied = AppliedRates::default();
        let mut told = |status: &Status| applied.line(status);
        assert_eq!([told(&alone), told(&all), told(&masked)], [None, None, None]);
        let line =
            "rates in 2 passes (mask): 40 % of the pixels shaded; tiles: 4x4 blocks skipped 56 %, 1x1 44 %";
        assert_eq!(told(&masked).as_deref(), Some(line));
        assert_eq!([told(&masked), told(&alone), told(&masked), told(&masked)], [None, None, None, None]);
        let more = status(1, &[("skipped", 0.6), ("2x2", 0.4)]);
        assert_eq!(told(&more), None);
        assert!(told(&more).is_some_and(|line| line.starts_with("rates in 1 pass ")));
    }
}
