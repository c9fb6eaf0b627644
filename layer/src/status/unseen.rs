//! Reasons why an active session has no visible effect.

use super::{Decision, StatusSnapshot, Topic};
use crate::config::{Config, GazeSource, chroma_settings, wants_maps, wants_reuse};
use crate::link::{BACKEND_MASK, BACKEND_NONE};
use parafovea_manifest::options::RatesMode;

/// Facts about a session besides a [`StatusSnapshot`].
#[derive(Clone, Copy, Debug)]
pub struct Known<'a> {
    /// Whether any frame had maps of rates.
    pub had_maps: bool,
    /// Whether any swapchain has images of the layer.
    pub has_own_images: bool,
    /// Whether no part was turned off after a failure.
    pub is_healthy: bool,
    /// Decisions on devices and passes.
    pub decisions: &'a [Decision],
}

/// One line with the reasons why no technique that the configuration enables has a visible effect; `None` if one has.
pub fn why_unseen(config: &Config, snapshot: &StatusSnapshot, known: &Known) -> Option<String> {
    const HEAD: &str = "active, but without visible effect";
    if !config.enabled {
        return Some(format!("{HEAD}: enabled = false"));
    }
    let mut reasons = Vec::new();
    if wants_maps(config) && config.rates.mode != RatesMode::Off {
        reasons.push(("shading rates", rates(snapshot, known)?));
    }
    if wants_reuse(config) {
        reasons.push(("re-use", reuse(snapshot, known)?));
    }
    if chroma_settings(config).is_some() {
        reasons.push(("chroma", chroma(config, snapshot, known)?));
    }
    if reasons.is_empty() {
        return Some(format!(
            "{HEAD}: the configuration enables nothing (preset, rates.mode, reuse.mode, chroma.mode)"
        ));
    }
    let reasons: Vec<String> = reasons.iter().map(|(what, why)| format!("{what}: {why}")).collect();
    Some(format!("{HEAD}; {}", reasons.join("; ")))
}

/// `None` if rates are coarse.
fn rates(snapshot: &StatusSnapshot, known: &Known) -> Option<String> {
    let of_maps = maps(snapshot, known);
    if of_maps.is_some() {
        return of_maps;
    }
    if snapshot.rates.is_dropped() {
        return Some(DROPPED.to_owned());
    }
    if snapshot.gpu_decides || snapshot.has_coarse_tiles() {
        return None;
    }
    Some(match is_blind(snapshot) {
        true => "the gaze is unknown, and the whole view is within the wide area of full rate".to_owned(),
        false => {
            "the whole view is within rates.foveal_deg plus the tracker's error from the gaze".to_owned()
        }
    })
}

/// The reason why no pass has a map; `None` if any has.
fn maps(snapshot: &StatusSnapshot, known: &Known) -> Option<String> {
    if snapshot.backend == BACKEND_NONE {
        let refused = known.decisions.iter().filter(|decision| decision.topic == Topic::NoBackend);
        let refused: Vec<&str> = refused.map(|decision| decision.line.as_str()).collect();
        return Some(match refused.is_empty() {
            true => {
                "no backend for shading rates on this device; the log gives the reason earlier".to_owned()
            }
            false => format!("no backend for shading rates on this device ({})", refused.join(", ")),
        });
    }
    if known.had_maps {
        return None;
    }
    let mut refusals: Vec<&str> = Vec::new();
    for decision in known.decisions {
        match &decision.topic {
            Topic::NoMask(reason) if !refusals.contains(&reason.as_str()) => refusals.push(reason),
            _ => {}
        }
    }
    let is_recognised = known.decisions.iter().any(|decision| decision.topic == Topic::Scene);
    Some(match (is_recognised, refusals.is_empty()) {
        (true, false) => {
            format!("the scene was recognised; the mask backend left it alone: {}", refusals.join(", "))
        }
        (true, true) if snapshot.backend == BACKEND_MASK => "the scene was recognised, but has no mask yet: its \
                         command buffers were recorded before recognition, or pipelines are still being compiled"
            .to_owned(),
        (true, true) => {
            "the scene was recognised, but none of its render passes could get rates; the log gives \
                         the reason earlier"
                .to_owned()
        }
        (false, _) => "no render pass was recognised as the scene; rates.passes can name it".to_owned(),
    })
}

fn reuse(snapshot: &StatusSnapshot, known: &Known) -> Option<String> {
    if snapshot.reuse.is_dropped()
        && let Some(of_feedback) = known.decisions.iter().rfind(|decision| decision.topic == Topic::Feedback)
    {
        return Some(of_feedback.line.trim_start_matches("re-use: ").to_owned());
    }
    let of_maps = maps(snapshot, known);
    if of_maps.is_some() {
        return of_maps;
    }
    if snapshot.reuse.is_dropped() {
        return Some(DROPPED.to_owned());
    }
    if !known.has_own_images {
        return Some(NO_IMAGES.to_owned());
    }
    let all: u32 = snapshot.tiles.iter().sum();
    if snapshot.tiles_due < all {
        return None;
    }
    // In most frames nothing is left out where pictures change all the time; that is not a fault.
    is_blind(snapshot).then(|| "the gaze is unknown".to_owned())
}

fn chroma(config: &Config, snapshot: &StatusSnapshot, known: &Known) -> Option<String> {
    if !known.is_healthy {
        return Some("off after a failure, which the log names earlier".to_owned());
    }
    if snapshot.attenuates_colour && known.has_own_images {
        return None;
    }
    Some(match snapshot.attenuates_colour {
        true => NO_IMAGES.to_owned(),
        false if is_blind(snapshot) && config.gaze.source != GazeSource::Centre => {
            "the gaze is unknown; gaze.source = \"centre\" needs no eye tracker".to_owned()
        }
        false => "colour has not faded yet, or the gaze is unreliable".to_owned(),
    })
}

const DROPPED: &str = "dropped by rates.gate: no clear saving in this application, or rates.gate = \"off\"";

const NO_IMAGES: &str = "no swapchain can be used: each is of an unsupported kind, or was created before the technique was enabled; \
                         restart the application";

fn is_blind(snapshot: &StatusSnapshot) -> bool {
    !snapshot.gaze_is_valid
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{ChromaMode, Preset, ReuseMode};
    use crate::link::BACKEND_RATE_ATTACHMENT;
    use parafovea_core::gate::{GateMode, Gates, Techniques};
    use parafovea_core::rate::ShadingRate;

    const NONE: Known = Known { had_maps: true, has_own_images: true, is_healthy: true, decisions: &[] };

    fn decision(topic: Topic, line: &str) -> Decision {
        Decision { topic, line: line.to_owned() }
    }

    /// Rates that are on, and coarse.
    fn seen() -> StatusSnapshot {
        let gates = Gates::new(Techniques { rates: GateMode::On, reuse: GateMode::On });
        let Techniques { rates, reuse } = gates.gates();
        let mut snapshot = StatusSnapshot {
            backend: BACKEND_MASK,
            gaze_is_valid: true,
            rates: rates.into(),
            reuse: reuse.into(),
            ..StatusSnapshot::default()
        };
        snapshot.count(&[ShadingRate::R4X4.texel(), 0]);
        snapshot
    }

    fn why(config: &Config, snapshot: &StatusSnapshot, known: &Known) -> String {
        let line = why_unseen(config, snapshot, known).unwrap();
        assert!(line.starts_with("active, but without visible effect"), "{line}");
        line
    }

    #[test]
    fn nothing_is_said_where_something_is_seen() {
        let mut config = Config::default();
        assert_eq!(why_unseen(&config, &seen(), &NONE), None);
        // Colour that stays is not a reason where rates are coarse.
        config.chroma.mode = ChromaMode::Default;
        assert_eq!(why_unseen(&config, &seen(), &NONE), None);
        let decided = StatusSnapshot { gpu_decides: true, tiles: [0; 16], ..seen() };
        assert_eq!(why_unseen(&config, &decided, &NONE), None);
        let coloured = StatusSnapshot { backend: BACKEND_NONE, attenuates_colour: true, ..seen() };
        assert_eq!(why_unseen(&config, &coloured, &NONE), None);
    }

    #[test]
    fn each_reason_is_named() {
        let config = Config::default();
        let off = Config { enabled: false, ..config };
        assert!(why(&off, &seen(), &NONE).ends_with("enabled = false"));
        assert!(why(&Config::of_preset(Preset::None), &seen(), &NONE).contains("enables nothing"));

        let decisions = [decision(Topic::NoBackend, "no masks: a queue with graphics but without compute")];
        let device = StatusSnapshot { backend: BACKEND_NONE, ..seen() };
        let line = why(&config, &device, &Known { decisions: &decisions, ..NONE });
        assert!(line.contains("shading rates: no backend") && line.contains("a queue"), "{line}");

        let unmatched = Known { had_maps: false, ..NONE };
        assert!(why(&config, &seen(), &unmatched).contains("no render pass was recognised"));
        // Words in a line mean nothing: only topics count.
        let other = [decision(Topic::OtherPass, "pass 8x8: the scene: no mask")];
        let line = why(&config, &seen(), &Known { decisions: &other, ..unmatched });
        assert!(line.contains("no render pass was recognised"), "{line}");
        let multisampled = || Topic::NoMask("depth is multisampled".to_owned());
        let decisions = [
            decision(Topic::Scene, "a"),
            decision(multisampled(), "b"),
            decision(multisampled(), "c"),
            decision(Topic::NoMask("it blends".to_owned()), "d"),
        ];
        let line = why(&config, &seen(), &Known { decisions: &decisions, ..unmatched });
        assert!(line.ends_with("the mask backend left it alone: depth is multisampled, it blends"), "{line}");
        let line = why(&config, &seen(), &Known { decisions: &decisions[..1], ..unmatched });
        assert!(line.contains("recorded before recognition"), "{line}");
        let attached = StatusSnapshot { backend: BACKEND_RATE_ATTACHMENT, ..seen() };
        let line = why(&config, &attached, &Known { decisions: &decisions[..1], ..unmatched });
        assert!(line.contains("none of its render passes could get rates"), "{line}");

        let gates = Gates::new(Techniques { rates: GateMode::Off, reuse: GateMode::Off });
        let Techniques { rates, reuse } = gates.gates();
        let dropped = StatusSnapshot { rates: rates.into(), reuse: reuse.into(), ..seen() };
        assert!(why(&config, &dropped, &NONE).contains("dropped by rates.gate"));

        let mut reusing = config;
        (reusing.rates.mode, reusing.reuse.mode) = (RatesMode::Off, ReuseMode::Paper);
        let decisions = [decision(Topic::Feedback, "re-use: off, because a filter")];
        let line = why(&reusing, &dropped, &Known { decisions: &decisions, ..unmatched });
        assert!(line.ends_with("re-use: off, because a filter"), "{line}");

        let mut fine = StatusSnapshot { tiles: [0; 16], ..seen() };
        fine.count(&[0, 0]);
        assert!(why(&config, &fine, &NONE).contains("rates.foveal_deg"));
        fine.gaze_is_valid = false;
        assert!(why(&config, &fine, &NONE).contains("the gaze is unknown"));
    }

    #[test]
    fn colour_that_stays_says_why() {
        let mut config = Config::of_preset(Preset::None);
        config.chroma.mode = ChromaMode::Default;
        let blind = StatusSnapshot { gaze_is_valid: false, ..seen() };
        assert!(why(&config, &blind, &NONE).contains("chroma: the gaze is unknown"));
        let faded = StatusSnapshot { attenuates_colour: true, ..seen() };
        let without_images = Known { has_own_images: false, ..NONE };
        assert!(why(&config, &faded, &without_images).contains("no swapchain can be used"));
        assert_eq!(why_unseen(&config, &faded, &NONE), None);
    }
}
