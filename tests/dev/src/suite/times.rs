//! Times of the last run of each test: the longest start first, so that none is left alone at the end.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

/// Times by names of tests.
#[derive(Clone, Default, PartialEq, Eq, Debug)]
pub struct Times(BTreeMap<String, Duration>);

impl Times {
    /// The times that [`Self::save`] wrote; none where it wrote none.
    pub fn load(file: &Path) -> Self {
        Self::parse(&std::fs::read_to_string(file).unwrap_or_default())
    }

    /// Keeps them for the next run.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save(&self, file: &Path) -> std::io::Result<()> {
        std::fs::write(file, self.text())
    }

    fn parse(text: &str) -> Self {
        let line = |line: &str| {
            let (seconds, name) = line.split_once(' ')?;
            Some((name.to_owned(), Duration::try_from_secs_f64(seconds.parse().ok()?).ok()?))
        };
        Self(text.lines().filter_map(line).collect())
    }

    fn text(&self) -> String {
        self.0.iter().map(|(name, time)| format!("{:.3} {name}\n", time.as_secs_f64())).collect()
    }

    /// Sets the time of a test.
    pub fn set(&mut self, name: &str, time: Duration) {
        self.0.insert(name.to_owned(), time);
    }

    /// Time of all these tests together, one after the other. A test that was never run may be long, and counts as such.
    pub fn of<'a>(&self, names: impl Iterator<Item = &'a str>) -> Duration {
        names
            .fold(Duration::ZERO, |sum, name| sum.saturating_add(*self.0.get(name).unwrap_or(&Duration::MAX)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_they_are_written() {
        let mut times = Times::default();
        times.set("tests/sound sound pipewire::x", Duration::from_millis(1250));
        times.set("core parafovea_core y", Duration::from_millis(3));
        assert_eq!(Times::parse(&times.text()), times);
        assert_eq!(Times::parse("no time\n-1 a\nNaN b\n"), Times::default());
    }

    #[test]
    fn unknown_tests_are_the_longest() {
        let mut times = Times::default();
        times.set("a", Duration::from_secs(2));
        times.set("b", Duration::from_secs(3));
        assert_eq!(times.of(["a", "b"].into_iter()), Duration::from_secs(5));
        assert_eq!(times.of(["a", "new", "other"].into_iter()), Duration::MAX);
    }
}
