//! `XR_KHR_convert_timespec_time`: times are nanoseconds of `CLOCK_MONOTONIC`; the simulated clock keeps its own count
//! of them, which converts by the same rule.

use crate::abi::pointers::{In, Out};
use crate::fault::{Fault, section};
use crate::runtime::call;
use openxr_sys as xr;

const SECOND_NS: i64 = 1_000_000_000;

fn invalid(message: String) -> Fault {
    Fault::new(xr::Result::ERROR_TIME_INVALID, section::TIMESPEC, message)
}

/// `xrConvertTimespecTimeToTimeKHR`.
pub(crate) extern "system" fn to_time(
    instance: xr::Instance,
    timespec: In<libc::timespec>,
    time: Out<xr::Time>,
) -> xr::Result {
    call("xrConvertTimespecTimeToTimeKHR", |runtime| {
        runtime.instances.get(instance)?;
        let libc::timespec { tv_sec, tv_nsec } = timespec.copied("timespecTime")?;
        let nanoseconds = tv_sec.checked_mul(SECOND_NS).and_then(|whole| whole.checked_add(tv_nsec));
        let valid = nanoseconds.filter(|&time| time > 0 && (0..SECOND_NS).contains(&tv_nsec));
        let valid = valid.ok_or_else(|| invalid(format!("{tv_sec} s {tv_nsec} ns is no time")))?;
        time.set("time", xr::Time::from_nanos(valid))?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrConvertTimeToTimespecTimeKHR`.
pub(crate) extern "system" fn from_time(
    instance: xr::Instance,
    time: xr::Time,
    timespec: Out<libc::timespec>,
) -> xr::Result {
    call("xrConvertTimeToTimespecTimeKHR", |runtime| {
        runtime.instances.get(instance)?;
        let nanoseconds = time.as_nanos();
        if nanoseconds <= 0 {
            return Err(invalid(format!("{nanoseconds} is no XrTime: it is not positive")));
        }
        let converted = libc::timespec { tv_sec: nanoseconds / SECOND_NS, tv_nsec: nanoseconds % SECOND_NS };
        timespec.set("timespecTime", converted)?;
        Ok(xr::Result::SUCCESS)
    })
}
