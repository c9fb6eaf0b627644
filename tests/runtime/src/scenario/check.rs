//! Values that parse, but that no headset has.

use super::{FovDegrees, Scenario, View};
use crate::fault;
use crate::instance::EXTENSIONS;
use std::fmt::{Debug, Display};
use std::ops::RangeInclusive;

/// The first value outside of its key's range.
pub(super) fn check(scenario: &Scenario) -> Result<(), String> {
    within("clock.refresh_hz", scenario.clock.refresh_hz, 1.0..=1000.0)?;
    within("swapchain.images", scenario.swapchain.images, 1..=8)?;
    within("system.eye_height", scenario.system.eye_height, 0.0..=3.0)?;
    within("system.max_size", scenario.system.max_size, 1..=16384)?;
    one_of("system.max_samples", &scenario.system.max_samples, &[1, 2, 4, 8])?;
    one_of("system.max_api", &scenario.system.max_api.as_str(), &["1.0", "1.1"])?;
    let known = EXTENSIONS.map(|extension| extension.name);
    let quirks = &scenario.quirks;
    for (key, names) in [
        ("system.extensions_off", &scenario.system.extensions_off),
        ("quirks.refused_extensions", &quirks.refused_extensions),
        ("quirks.unlisted_extensions", &quirks.unlisted_extensions),
    ] {
        for name in names {
            one_of(key, &name.as_str(), &known)?;
        }
    }
    within("tracker.latency_ms", scenario.tracker.latency_ms, 0.0..=1000.0)?;
    within("tracker.newer_at_views_ms", scenario.tracker.newer_at_views_ms, 0.0..=1000.0)?;
    if scenario.session.focused_from < scenario.session.visible_from {
        let (focused, visible) = (scenario.session.focused_from, scenario.session.visible_from);
        return Err(format!(
            "session.focused_from is {focused}; allowed: session.visible_from ({visible}) or more"
        ));
    }
    if scenario.views.len() != 2 {
        return Err(format!(
            "[[view]] is there {} times; allowed: 2 times, left and right",
            scenario.views.len()
        ));
    }
    for view in &scenario.views {
        check_view(view, scenario.system.max_size)?;
    }
    ascending("head", scenario.head.iter().map(|head| head.t))?;
    ascending("gaze", scenario.gaze.iter().map(|gaze| gaze.t))?;
    ascending("zoom", scenario.zoom.iter().map(|zoom| zoom.t))?;
    for head in &scenario.head {
        finite("head.position", &head.position)?;
        finite("head.yaw_deg, pitch_deg or roll_deg", &[head.yaw_deg, head.pitch_deg, head.roll_deg])?;
    }
    for gaze in &scenario.gaze {
        finite("gaze.yaw_deg or pitch_deg", &[gaze.yaw_deg, gaze.pitch_deg])?;
    }
    for zoom in &scenario.zoom {
        within("zoom.scale", zoom.scale, 0.1..=1.0)?;
    }
    for input in &scenario.input {
        within("input.t", input.t, f64::MIN..=f64::MAX)?;
        let value = input.value.pair();
        within("input.value", value[0], -1.0..=1.0)?;
        within("input.value", value[1], -1.0..=1.0)?;
    }
    for fault in &scenario.fault {
        if !crate::dispatch::has(&fault.call) {
            return Err(format!("fault.call has {:?}; allowed: functions of the runtime", fault.call));
        }
        if !fault.result.is_empty() && fault::result_named(&fault.result).is_none() {
            return Err(format!("fault.result has {:?}; allowed: names of XrResult, or \"\"", fault.result));
        }
        within("fault.late_ms", fault.late_ms, 0..=10_000)?;
    }
    Ok(())
}

fn check_view(view: &View, max_size: u32) -> Result<(), String> {
    within("view.width", view.width, 1..=max_size)?;
    within("view.height", view.height, 1..=max_size)?;
    let FovDegrees { left, right, up, down } = view.fov_deg;
    for (key, value) in [("left", left), ("right", right), ("up", up), ("down", down)] {
        within(&format!("view.fov_deg.{key}"), value, -89.0..=89.0)?;
    }
    finite("view.position", &view.position)?;
    if left == right || up == down {
        return Err("view.fov_deg is empty; allowed: left unlike right, up unlike down".to_owned());
    }
    let length = view.orientation.iter().map(|part| part * part).sum::<f32>().sqrt();
    within("length of view.orientation", length, 0.99..=1.01)
}

fn within<T: PartialOrd + Display>(key: &str, value: T, allowed: RangeInclusive<T>) -> Result<(), String> {
    if allowed.contains(&value) {
        return Ok(());
    }
    Err(format!("{key} is {value}; allowed: {} to {}", allowed.start(), allowed.end()))
}

fn finite(key: &str, values: &[f32]) -> Result<(), String> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(format!("{key} is {value}; allowed: finite numbers")),
        None => Ok(()),
    }
}

fn one_of<T: PartialEq + Debug>(key: &str, value: &T, allowed: &[T]) -> Result<(), String> {
    if allowed.contains(value) { Ok(()) } else { Err(format!("{key} has {value:?}; allowed: {allowed:?}")) }
}

fn ascending(key: &str, times: impl Iterator<Item = f64>) -> Result<(), String> {
    let times: Vec<_> = times.collect();
    if let Some(time) = times.iter().find(|time| !time.is_finite()) {
        return Err(format!("{key}.t is {time}; allowed: finite times"));
    }
    match times.windows(2).find(|pair| pair[1].partial_cmp(&pair[0]).is_none_or(|order| order.is_lt())) {
        Some(pair) => Err(format!("{key}.t is {} after {}; allowed: ascending times", pair[1], pair[0])),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusals_name_the_key_and_what_is_allowed() {
        let cases = [
            ("[clock]\nrefresh_hz=0", "clock.refresh_hz is 0; allowed: 1 to 1000"),
            ("[clock]\nspeed=1", "unknown field `speed`, expected one of `mode`, `refresh_hz`, `turns`"),
            ("[clock]\nmode='fast'", "unknown variant `fast`, expected `simulated` or `real`"),
            ("[swapchain]\nimages=9", "swapchain.images is 9; allowed: 1 to 8"),
            ("[system]\nmax_api='2.0'", "system.max_api has \"2.0\"; allowed: [\"1.0\", \"1.1\"]"),
            ("[system]\nextensions_off=['XR_no']", "system.extensions_off has \"XR_no\"; allowed: [\"XR_"),
            ("[[view]]\nwidth=8", "[[view]] is there 1 times; allowed: 2 times"),
            (
                "[session]\nvisible_from=3",
                "session.focused_from is 0; allowed: session.visible_from (3) or more",
            ),
            ("[[gaze]]\nt=1\n[[gaze]]\nt=0", "gaze.t is 0 after 1; allowed: ascending times"),
            ("[[head]]\nt=nan", "head.t is NaN; allowed: finite times"),
            (
                "[[head]]\nt=0\nyaw_deg=nan",
                "head.yaw_deg, pitch_deg or roll_deg is NaN; allowed: finite numbers",
            ),
            ("[[head]]\nt=0\nposition=[0, 1e39, 0]", "head.position is inf; allowed: finite numbers"),
            ("[[gaze]]\nt=0\npitch_deg=-inf", "gaze.yaw_deg or pitch_deg is -inf; allowed: finite numbers"),
            ("[[input]]\nt=nan\npath='/'\nvalue=true", "input.t is NaN; allowed: -1"),
            ("[[input]]\nvalue=true", "missing field `path`"),
            ("[[fault]]\ncall='xrNo'", "fault.call has \"xrNo\"; allowed: functions"),
            ("[[fault]]\ncall='xrEndFrame'\nresult='XR_NO'", "fault.result has \"XR_NO\"; allowed: names"),
        ];
        for (text, message) in cases {
            let error = Scenario::parse(text).unwrap_err();
            assert!(error.contains(message), "{text}: {error}");
        }
    }

    #[test]
    fn an_empty_file_is_the_default() {
        assert_eq!(Scenario::parse("").unwrap(), Scenario::default());
    }

    #[test]
    fn the_manual_has_every_key() {
        let manual = include_str!("../../README.md");
        let input =
            super::super::Input { t: 0.0, path: String::new(), value: super::super::InputValue::Float(0.0) };
        let zoom = super::super::Zoom { t: 0.0, scale: 1.0 };
        let fault: super::super::Fault = toml::from_str("call = 'xrEndFrame'").unwrap();
        let everything =
            Scenario { input: vec![input], zoom: vec![zoom], fault: vec![fault], ..Scenario::default() };
        let everything = toml::Table::try_from(&everything).unwrap();
        let mut keys = Vec::new();
        for (section, value) in everything {
            let table = match value {
                toml::Value::Array(tables) => tables[0].as_table().unwrap().clone(),
                other => other.as_table().unwrap().clone(),
            };
            keys.extend(table.into_iter().map(|(key, _)| (section.clone(), key)));
        }
        assert!(keys.len() > 30, "{keys:?}");
        for (section, key) in keys {
            assert!(manual.contains(&format!("[{section}]")), "[{section}]");
            assert!(manual.contains(&format!("`{key}`")), "{key} of [{section}]");
        }
    }
}
