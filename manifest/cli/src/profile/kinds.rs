//! Settings that suit kinds of applications, each explained.

use parafovea_manifest::options::OPTIONS;
use std::fmt::Write;

/// A kind of application.
struct Kind {
    name: &'static str,
    /// What it is, and what there is to know, a line each.
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
            "They render without render-pass objects, and bring input of their own, which the eye tracker joins.",
            "Launch options in Steam: PARAFOVEA=1 %command%",
            "The log is called after the .exe.",
        ],
        settings: &[Suited {
            key: "gaze.attach_alone_after_s",
            value: "0",
            why: "Games that take long to load set their input up late: it is never assumed that they have none.",
        }],
    },
    Kind {
        name: "unity",
        about: &[
            "Games made with Unity: a picture of both eyes in one image (double-wide, or an array of two), and passes",
            "off the screen that may be upside-down.",
            "If the log takes no pass for the scene, rates.passes says which it is, with its size from the log:",
            "  passes = \"array 2048x2048\"",
        ],
        settings: &[Suited {
            key: "rates.backend",
            value: "\"auto\"",
            why: "Multi-sampled passes, which are usual here, need rate attachments; a mask leaves them alone.",
        }],
    },
    Kind {
        name: "unreal",
        about: &[
            "Games made with Unreal: deferred shading, and temporal anti-aliasing, which smooths coarse blocks over",
            "several frames, and shimmers where they are large.",
        ],
        settings: &[
            Suited {
                key: "rates.peripheral",
                value: "\"2x2\"",
                why: "Temporal anti-aliasing keeps up with blocks of two pixels; with larger ones edges flicker.",
            },
            Suited {
                key: "rates.transitional_deg",
                value: "22.0",
                why: "In exchange the coarsest rate begins nearer to the gaze.",
            },
        ],
    },
    Kind {
        name: "godot",
        about: &[
            "Games made with Godot 4: one multiview pass for both eyes.",
            "With both eyes in one pass a rate image has a layer for each, or the finer of both.",
        ],
        settings: &[Suited {
            key: "preset",
            value: "\"balanced\"",
            why: "Nothing stands in the way; if foveation is on in the project too, turn one of them off.",
        }],
    },
    Kind {
        name: "wgpu",
        about: &[
            "Programs made with wgpu, or Bevy: their own passes, dynamic rendering or render passes of Vulkan.",
            "They ask for few features; Parafovea adds what it needs.",
        ],
        settings: &[Suited {
            key: "gaze.attach_alone_after_s",
            value: "30",
            why: "Many have no input of their own: after this time the eye tracker is asked all the same.",
        }],
    },
    Kind {
        name: "flight-simulator",
        about: &[
            "Flight and racing simulators: instruments with small text, read at a glance, far from where the eyes were.",
            "What is near to the gaze stays sharp in a larger area, and nothing is very coarse.",
        ],
        settings: &[
            Suited {
                key: "rates.foveal_deg",
                value: "20.0",
                why: "An instrument beside the one that is looked at can be read too.",
            },
            Suited { key: "rates.transitional_deg", value: "35.0", why: "Rates fall off more slowly." },
            Suited {
                key: "rates.peripheral",
                value: "\"2x2\"",
                why: "Text in the corner of the eye stays text: a needle that moves is noticed.",
            },
            Suited {
                key: "chroma.plateau_deg",
                value: "12.0",
                why: "Coloured lamps and bands keep their colour; it matters where chroma.mode is not \"off\".",
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
            "\n# {}\n# Allowed: {}.\n# Here: {}\n{} = {}\n",
            option.doc,
            option.allowed_with_unit(),
            setting.why,
            option.name,
            setting.value
        );
    }
    text
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
