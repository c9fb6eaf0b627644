//! Settings that suit kinds of applications, each explained.

use parafovea_manifest::options::{Config, OPTIONS, OptionSpec};
use std::fmt::Write;

/// A kind of application.
struct Kind {
    name: &'static str,
    /// Description, a line each.
    about: &'static [&'static str],
    settings: &'static [Suited],
}

/// A setting that suits it.
struct Suited {
    key: &'static str,
    /// As it stands in a file.
    value: &'static str,
    why: &'static str,
}

const KINDS: &[Kind] = &[
    Kind {
        name: "proton",
        about: &[
            "Windows games that Proton runs with DXVK or vkd3d-proton.",
            "They use dynamic rendering, and their own OpenXR input, to which the layer adds the eye tracker.",
            "Launch options in Steam: PARAFOVEA=1 %command%",
            "The log has the name of the game's .exe file.",
        ],
        settings: &[Suited {
            key: "gaze.attach_alone_after_s",
            value: "0",
            why: "Games with long loading times set up their OpenXR input late; the layer must not attach the eye tracker before that.",
        }],
    },
    Kind {
        name: "unity",
        about: &[
            "Unity games: one image for both eyes (double-wide, or an array of two layers), and off-screen render passes",
            "that may be upside-down.",
            "If recognition of the scene fails, name its render pass in rates.passes, with the size from the log:",
            "  passes = \"array 2048x2048\"",
        ],
        settings: &[Suited {
            key: "rates.backend",
            value: "\"auto\"",
            why: "\"auto\" uses rate attachments if the device has them: in multisampled render passes, common in Unity, masks save less.",
        }],
    },
    Kind {
        name: "unreal",
        about: &[
            "Unreal games: deferred shading and temporal anti-aliasing, which smooths coarse blocks over",
            "several frames, but shimmers if the blocks are large.",
        ],
        settings: &[
            Suited {
                key: "rates.peripheral",
                value: "\"2x2\"",
                why: "Temporal anti-aliasing copes with blocks of two pixels; with larger blocks, edges flicker.",
            },
            Suited {
                key: "rates.greatest_loss",
                value: "10.0",
                why: "In exchange, more tiles become coarse on a GPU.",
            },
        ],
    },
    Kind {
        name: "godot",
        about: &[
            "Godot 4 games: Mobile draws both eyes in one multiview render pass; Forward+ in several, then tone mapping.",
            "The rate attachment of a multiview pass has one layer per eye, or one layer with the finer rate of both eyes.",
        ],
        settings: &[Suited {
            key: "preset",
            value: "\"balanced\"",
            why: "The default works; if the project has foveation of its own, turn one of the two off.",
        }],
    },
    Kind {
        name: "wgpu",
        about: &[
            "wgpu and Bevy programs: dynamic rendering or Vulkan render passes of their own.",
            "They enable few device features; Parafovea enables the others that it needs.",
        ],
        settings: &[Suited {
            key: "gaze.attach_alone_after_s",
            value: "30",
            why: "Many have no OpenXR input: after this delay, the layer attaches the eye tracker.",
        }],
    },
    Kind {
        name: "flight-simulator",
        about: &[
            "Flight and racing simulators: instruments with small text far from the gaze, read at a glance.",
            "A larger area around the gaze stays sharp, and no area becomes very coarse.",
        ],
        settings: &[
            Suited {
                key: "rates.mode",
                value: "\"fixed\"",
                why: "Rings keep the area around the gaze sharp regardless of its contrast.",
            },
            Suited {
                key: "rates.foveal_deg",
                value: "20.0",
                why: "The instrument next to the gaze stays legible.",
            },
            Suited {
                key: "rates.transitional_deg",
                value: "35.0",
                why: "Shading rates become coarse more gradually.",
            },
            Suited {
                key: "rates.peripheral",
                value: "\"2x2\"",
                why: "Peripheral text stays legible, and moving needles stay visible.",
            },
            Suited {
                key: "chroma.plateau_deg",
                value: "12.0",
                why: "Coloured lamps and bands keep their colour, if chroma.mode is not \"off\".",
            },
        ],
    },
];

/// Names of the kinds.
pub fn names() -> Vec<&'static str> {
    KINDS.iter().map(|kind| kind.name).collect()
}

/// A commented file for that kind; the options' own words explain each setting.
pub fn file(name: &str) -> String {
    let Some(kind) = KINDS.iter().find(|kind| kind.name == name) else { return String::new() };
    let mut text = String::new();
    for line in kind.about {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "# {line}");
    }
    let mut section = "";
    for option in OPTIONS {
        let Some(setting) = kind.settings.iter().find(|setting| setting.key == option.key()) else {
            continue;
        };
        if option.section != section {
            section = option.section;
            let _ = write!(text, "\n[{section}]\n");
        }
        let _ = write!(
            text,
            "\n# {}\n# Allowed: {}.\n# Reason: {}\n{} = {}\n",
            option.doc,
            option.allowed_with_unit(),
            setting.why,
            option.name,
            setting.value
        );
    }
    text
}

/// Whether the file of that kind sets an option, and not to its default.
pub fn changes(name: &str, option: &OptionSpec) -> bool {
    let kind = KINDS.iter().find(|kind| kind.name == name);
    let setting = kind.and_then(|kind| kind.settings.iter().find(|setting| setting.key == option.key()));
    setting.is_some_and(|setting| setting.value != option.value(&Config::default()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_manifest::config::parse;
    use std::path::Path;

    #[test]
    fn each_file_is_valid_and_sets_what_it_says() {
        for kind in KINDS {
            let text = file(kind.name);
            let config =
                parse(Path::new(kind.name), &text).unwrap_or_else(|errors| panic!("{errors}\n{text}"));
            for setting in kind.settings {
                let option = OPTIONS.iter().find(|option| option.key() == setting.key).unwrap();
                assert_eq!(option.value(&config), setting.value, "{}: {}", kind.name, setting.key);
                assert!(text.contains(option.doc) && text.contains(setting.why), "{text}");
            }
            let set = super::super::effective::set_in(&text);
            assert_eq!(set.len(), kind.settings.len(), "{text}");
        }
    }
}
