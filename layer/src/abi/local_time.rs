//! Local time, from the C library.

use std::fmt;
use std::time::{SystemTime, UNIX_EPOCH};

/// A moment on the user's clock. `Display` writes ISO 8601 with milliseconds and the offset from UTC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LocalTime {
    /// Year, month from 1, day of the month from 1.
    date: [i32; 3],
    /// Hour, minute, second; 60 is a leap second.
    time: [i32; 3],
    /// Milliseconds of the second.
    millis: u32,
    /// Offset from UTC, seconds, positive to the east.
    offset_s: i64,
}

impl LocalTime {
    /// A moment in the time zone of this process; the start of 1970 if the C library does not know it.
    pub fn at(moment: SystemTime) -> Self {
        let since = moment.duration_since(UNIX_EPOCH).unwrap_or_default();
        let seconds = libc::time_t::try_from(since.as_secs()).unwrap_or_default();
        // SAFETY: the structure is plain numbers and a pointer, for all of which zero is valid.
        let mut parts: libc::tm = unsafe { std::mem::zeroed() };
        // SAFETY: both point to live values of their types, and the call keeps neither. Its result is the second one or null; null
        // leaves zeros.
        unsafe { libc::localtime_r(&seconds, &mut parts) };
        Self {
            date: [parts.tm_year.saturating_add(1900), parts.tm_mon + 1, parts.tm_mday.max(1)],
            time: [parts.tm_hour, parts.tm_min, parts.tm_sec],
            millis: since.subsec_millis(),
            offset_s: parts.tm_gmtoff,
        }
    }
}

impl fmt::Display for LocalTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([year, month, day], [hour, minute, second]) = (self.date, self.time);
        let sign = if self.offset_s < 0 { '-' } else { '+' };
        let minutes = self.offset_s.abs() / 60;
        write!(
            f,
            "{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}.{:03}{sign}{:02}:{:02}",
            self.millis,
            minutes / 60,
            minutes % 60
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn iso_8601_with_an_offset_to_either_side() {
        let east =
            LocalTime { date: [2024, 2, 9], time: [3, 4, 60], millis: 7, offset_s: 5 * 3600 + 45 * 60 };
        assert_eq!(east.to_string(), "2024-02-09T03:04:60.007+05:45");
        let west = LocalTime { offset_s: -(3 * 3600 + 30 * 60), ..east };
        assert_eq!(west.to_string(), "2024-02-09T03:04:60.007-03:30");
    }

    /// Days of the Gregorian calendar since 1970, for years from then on.
    fn days([year, month, day]: [i32; 3]) -> i64 {
        let is_leap = |year: i32| year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
        let years: i64 = (1970..year).map(|year| if is_leap(year) { 366 } else { 365 }).sum();
        let february = if is_leap(year) { 29 } else { 28 };
        let months = [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
        years + months.iter().take(month as usize - 1).sum::<i64>() + i64::from(day) - 1
    }

    #[test]
    fn the_same_moment_in_any_time_zone() {
        for seconds in [0, 951_782_399, 1_709_251_199, 1_800_000_000] {
            let local = LocalTime::at(UNIX_EPOCH + Duration::from_millis(seconds * 1000 + 250));
            let [hour, minute, second] = local.time.map(i64::from);
            let of_day = hour * 3600 + minute * 60 + second;
            assert_eq!(days(local.date) * 86_400 + of_day - local.offset_s, seconds as i64, "{local}");
            assert_eq!(local.millis, 250);
        }
    }
}
