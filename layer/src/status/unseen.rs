//! Why nothing is seen of an active session.

use super::Moment;
use crate::config::{Config, GazeSource, chroma_settings, wants_maps, wants_reuse};
use crate::link::BACKEND_NONE;
use parafovea_core::rate::ShadingRate;
use parafovea_manifest::options::RatesMode;

/// What is known besides a [`Moment`].
#[derive(Clone, Copy, Debug)]
pub struct Known<'a> {
    /// Whether any frame had maps of rates.
    pub had_maps: bool,
    /// Whether any swapchain has images of ours.
    pub has_own_images: bool,
    /// Whether nothing was given up because it failed.
    pub is_healthy: bool,
    /// What was decided of devices and passes.
    pub decisions: &'a [String],
}

/// One line that says why nothing of what the configuration asks for is to be seen; nothing where any of it is.
pub fn why_unseen(config: &Config, moment: &Moment, known: &Known) -> Option<String> {
    const HEAD: &str = "active, but nothing is to be seen of it";
    if !config.enabled {
        return Some(format!("{HEAD}: enabled = false"));
    }
    let mut reasons = Vec::new();
    if wants_maps(config) && config.rates.mode != RatesMode::Off {
        reasons.push(("shading rates", rates(moment, known)?));
    }
    if wants_reuse(config) {
        reasons.push(("re-use", reuse(moment, known)?));
    }
    if chroma_settings(config).is_some() {
        reasons.push(("colour", colour(config, moment, known)?));
    }
    if reasons.is_empty() {
        return Some(format!(
            "{HEAD}: the configuration asks for nothing (preset, rates.mode, reuse.mode, chroma.mode)"
        ));
    }
    let reasons: Vec<String> = reasons.iter().map(|(what, why)| format!("{what}: {why}")).collect();
    Some(format!("{HEAD}; {}", reasons.join("; ")))
}

/// Nothing where rates are coarse.
fn rates(moment: &Moment, known: &Known) -> Option<String> {
    let of_maps = maps(moment, known);
    if of_maps.is_some() {
        return of_maps;
    }
    if moment.rates.is_dropped() {
        return Some(
            "dropped by rates.gate, because they do not pay here, or because it is \"off\"".to_owned(),
        );
    }
    let is_coarse =
        |(texel, count): (usize, &u32)| *count > 0 && texel != usize::from(ShadingRate::R1X1.texel());
    if moment.gpu_decides || moment.tiles.iter().enumerate().any(is_coarse) {
        return None;
    }
    Some(match is_blind(moment) {
        true => "the gaze is not known, and nothing of the view is far enough from its middle".to_owned(),
        false => "every tile is nearer to the gaze than rates.foveal_deg and the tracker's error".to_owned(),
    })
}

/// Why no pass has a map; nothing where any has.
fn maps(moment: &Moment, known: &Known) -> Option<String> {
    if moment.backend == BACKEND_NONE {
        let refused: Vec<&str> =
            known.decisions.iter().filter(|line| line.starts_with("no ")).map(String::as_str).collect();
        return Some(match refused.is_empty() {
            true => "this device has no way to shade coarsely; the log says above why".to_owned(),
            false => format!("this device has no way to shade coarsely ({})", refused.join(", ")),
        });
    }
    if known.had_maps {
        return None;
    }
    let refused: Vec<&str> =
        known.decisions.iter().filter(|line| line.contains("has no mask")).map(String::as_str).collect();
    let is_scene = known.decisions.iter().any(|line| line.contains(": the scene"));
    Some(match (is_scene, refused.is_empty()) {
        (true, false) => format!("passes of the scene are left alone ({})", refused.join(", ")),
        (true, true) => {
            "passes of the scene were recognised, and none could have rates; the log says above why"
                .to_owned()
        }
        (false, _) => "no pass was recognised as the scene; rates.passes can name it".to_owned(),
    })
}

fn reuse(moment: &Moment, known: &Known) -> Option<String> {
    let of_maps = maps(moment, known);
    if of_maps.is_some() {
        return of_maps;
    }
    if moment.reuse.is_dropped() {
        return Some(
            "dropped by rates.gate, because it does not pay here, or because it is \"off\"".to_owned(),
        );
    }
    if !known.has_own_images {
        return Some(NO_IMAGES.to_owned());
    }
    let all: u32 = moment.tiles.iter().sum();
    if moment.tiles_due < all {
        return None;
    }
    // In most frames nothing is left out where pictures change all the time; that is no fault.
    is_blind(moment).then(|| "the gaze is not known".to_owned())
}

fn colour(config: &Config, moment: &Moment, known: &Known) -> Option<String> {
    if !known.is_healthy {
        return Some("given up after a failure, which the log has above".to_owned());
    }
    if moment.attenuates_colour && known.has_own_images {
        return None;
    }
    Some(match moment.attenuates_colour {
        true => NO_IMAGES.to_owned(),
        false if is_blind(moment) && config.gaze.source != GazeSource::Centre => {
            "the gaze is not known; gaze.source = \"centre\" goes without an eye tracker".to_owned()
        }
        false => "it is not faded out yet, or the gaze is not trusted".to_owned(),
    })
}

const NO_IMAGES: &str = "no swapchain has images of ours: they were made before that was asked for, or cannot have them; start \
                         the application anew";

fn is_blind(moment: &Moment) -> bool {
    !moment.gaze_is_valid
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{ChromaMode, Preset};
    use crate::link::BACKEND_MASK;
    use parafovea_core::gate::{GateMode, Gates, Techniques};

    const NONE: Known = Known { had_maps: true, has_own_images: true, is_healthy: true, decisions: &[] };

    /// Rates that are on, and coarse.
    fn seen() -> Moment {
        let gates = Gates::new(Techniques { rates: GateMode::On, reuse: GateMode::On });
        let Techniques { rates, reuse } = gates.gates();
        let mut moment = Moment {
            backend: BACKEND_MASK,
            gaze_is_valid: true,
            rates: rates.into(),
            reuse: reuse.into(),
            ..Moment::default()
        };
        moment.count(&[ShadingRate::R4X4.texel(), 0]);
        moment
    }

    fn why(config: &Config, moment: &Moment, known: &Known) -> String {
        let line = why_unseen(config, moment, known).unwrap();
        assert!(line.starts_with("active, but nothing is to be seen of it"), "{line}");
        line
    }

    #[test]
    fn nothing_is_said_where_something_is_seen() {
        let mut config = Config::default();
        assert_eq!(why_unseen(&config, &seen(), &NONE), None);
        // Colour that stays is no reason where rates are coarse.
        config.chroma.mode = ChromaMode::Default;
        assert_eq!(why_unseen(&config, &seen(), &NONE), None);
        let decided = Moment { gpu_decides: true, tiles: [0; 16], ..seen() };
        assert_eq!(why_unseen(&config, &decided, &NONE), None);
        let coloured = Moment { backend: BACKEND_NONE, attenuates_colour: true, ..seen() };
        assert_eq!(why_unseen(&config, &coloured, &NONE), None);
    }

    #[test]
    fn each_reason_is_named() {
        let config = Config::default();
        let off = Config { enabled: false, ..config };
        assert!(why(&off, &seen(), &NONE).ends_with("enabled = false"));
        assert!(why(&Config::of_preset(Preset::None), &seen(), &NONE).contains("asks for nothing"));

        let decisions = ["no masks either: a queue that can draw and not compute".to_owned()];
        let device = Moment { backend: BACKEND_NONE, ..seen() };
        let line = why(&config, &device, &Known { decisions: &decisions, ..NONE });
        assert!(line.contains("shading rates: this device") && line.contains("a queue"), "{line}");

        let unmatched = Known { had_maps: false, ..NONE };
        assert!(why(&config, &seen(), &unmatched).contains("no pass was recognised"));
        let decisions =
            ["pass 8x8: the scene: left eye", "a pass of 8x8 has no mask: it blends"].map(str::to_owned);
        let refused = Known { decisions: &decisions, ..unmatched };
        assert!(why(&config, &seen(), &refused).contains("has no mask: it blends"));

        let gates = Gates::new(Techniques { rates: GateMode::Off, reuse: GateMode::Off });
        let Techniques { rates, reuse } = gates.gates();
        let dropped = Moment { rates: rates.into(), reuse: reuse.into(), ..seen() };
        assert!(why(&config, &dropped, &NONE).contains("dropped by rates.gate"));

        let mut fine = Moment { tiles: [0; 16], ..seen() };
        fine.count(&[0, 0]);
        assert!(why(&config, &fine, &NONE).contains("rates.foveal_deg"));
        fine.gaze_is_valid = false;
        assert!(why(&config, &fine, &NONE).contains("the gaze is not known"));
    }

    #[test]
    fn colour_that_stays_says_why() {
        let mut config = Config::of_preset(Preset::None);
        config.chroma.mode = ChromaMode::Default;
        let blind = Moment { gaze_is_valid: false, ..seen() };
        assert!(why(&config, &blind, &NONE).contains("colour: the gaze is not known"));
        let faded = Moment { attenuates_colour: true, ..seen() };
        let without_images = Known { has_own_images: false, ..NONE };
        assert!(why(&config, &faded, &without_images).contains("no swapchain has images of ours"));
        assert_eq!(why_unseen(&config, &faded, &NONE), None);
    }
}
