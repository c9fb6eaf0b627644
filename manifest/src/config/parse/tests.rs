use super::*;
use crate::options::{Allowed, ChromaMode, GazeSource, LogLevel, Preset, RatesMode};
use proptest::prelude::*;

fn read(text: &str) -> Result<Config, String> {
    parse(Path::new("game.toml"), text).map_err(|errors| errors.to_string())
}

fn rejected(text: &str) -> String {
    read(text).unwrap_err()
}

#[test]
fn unset_options_keep_their_defaults() {
    let config = read("log.level = 'debug'\n[gaze]\nsource = 'centre'\n[chroma]\nmode = 'paper'").unwrap();
    let mut expected = Config::default();
    expected.log.level = LogLevel::Debug;
    expected.gaze.source = GazeSource::Centre;
    expected.chroma.mode = ChromaMode::Paper;
    assert_eq!(config, expected);
    assert_eq!(read("").unwrap(), Config::default());
    assert_eq!(read("\u{feff}enabled = true\r\n").unwrap(), Config::default());
}

#[test]
fn a_preset_sets_what_the_file_does_not() {
    let config = read("preset = 'streaming'").unwrap();
    let mut expected = Config { preset: Preset::Streaming, ..Config::default() };
    expected.chroma.mode = ChromaMode::Default;
    assert_eq!(config, expected, "and nothing else");
    for own in ["chroma.mode = 'off'\npreset = 'streaming'", "preset = 'streaming'\n[chroma]\nmode = 'off'"] {
        assert_eq!(read(own).unwrap().chroma.mode, ChromaMode::Off, "{own}");
    }
    assert_eq!(read("preset = 'balanced'"), Ok(Config::default()));
    assert_eq!(
        rejected("preset = 'steaming'"),
        "game.toml: line 1: preset = 'steaming' is not allowed; allowed: \"none\", \"quality\", \"balanced\", \
         \"performance\", \"streaming\", \"fixed\" or \"paper\""
    );
    assert_eq!(
        rejected("[chroma]\npreset = 'streaming'"),
        "game.toml: line 2: unknown key chroma.preset; did you mean preset?"
    );
}

#[test]
fn with_the_preset_none_every_technique_is_off() {
    let config = read("preset = 'none'").unwrap();
    assert_eq!((config.rates.mode, config.chroma.mode), (RatesMode::Off, ChromaMode::Off));
    let config = read("preset = 'none'\n[rates]\nmode = 'auto'").unwrap();
    assert_eq!(config.rates, Config::default().rates, "but what is set itself");
}

#[test]
fn numbers_may_be_written_as_integers_and_in_any_notation() {
    let config = read("chroma.plateau_deg = 1_0\nchroma.max_eccentricity_deg = 0x20\ngaze.hold_ms = 0b11\nchroma.rim_fade = 5e-1").unwrap();
    assert_eq!(config.chroma.plateau_deg, 10.0);
    assert_eq!(config.chroma.max_eccentricity_deg, 32.0);
    assert_eq!(config.gaze.hold_ms, 3);
    assert_eq!(config.chroma.rim_fade, 0.5);
}

#[test]
fn a_wrong_value_is_told_with_file_line_key_value_and_what_is_allowed() {
    for (text, line) in [
        (
            "\n[chroma]\nplateau_deg = 90",
            "game.toml: line 3: chroma.plateau_deg = 90 is not allowed; allowed: a number from 1.1 to 30 degrees",
        ),
        ("enabled = 'yes'", "game.toml: line 1: enabled = 'yes' is not allowed; allowed: true or false"),
        (
            "log.level = \"loud\"",
            "game.toml: line 1: log.level = \"loud\" is not allowed; allowed: \"error\", \"warn\", \"info\" or \"debug\"",
        ),
        (
            "gaze.hold_ms = 3.5",
            "game.toml: line 1: gaze.hold_ms = 3.5 is not allowed; allowed: a whole number from 0 to 500 milliseconds",
        ),
        (
            "gaze.hold_ms = -1",
            "game.toml: line 1: gaze.hold_ms = -1 is not allowed; allowed: a whole number from 0 to 500 milliseconds",
        ),
        ("chroma = 3", "game.toml: line 1: chroma = 3 is not allowed; allowed: a section [chroma]"),
        (
            "enabled = [\n1,\n2]",
            "game.toml: line 1: enabled = [\\n1,\\n2] is not allowed; allowed: true or false",
        ),
    ] {
        assert_eq!(rejected(text), line);
    }
}

#[test]
fn no_number_escapes_its_range() {
    for value in [
        "nan",
        "-nan",
        "inf",
        "+inf",
        "-inf",
        "1e999",
        "-1e999",
        "99999999999999999999",
        "1e-50",
        "\"1\"",
        "2026-01-01",
    ] {
        let message = rejected(&format!("chroma.cb_bound = {value}"));
        assert!(message.contains(&format!("chroma.cb_bound = {value} is not allowed")), "{message}");
        assert!(message.ends_with("allowed: a number from 0.7 to 0.85"), "{message}");
    }
}

#[test]
fn the_wrong_word_of_pass_rules_is_told() {
    for (rules, reason) in [
        ("left", "\"left\": a rule needs a colour format, a size or a number"),
        ("middle 10x10", "\"middle\": a rule begins with exclude, left, right, either, double-wide or array"),
        ("left 10x10 20x20", "\"20x20\": a second value of this kind in one rule"),
        (
            "left #1;left #2;left #3;left #4;left #5;left #6;left #7;left #8;left #9",
            "too many rules; allowed: at most 8",
        ),
    ] {
        let message = rejected(&format!("rates.passes = '{rules}'"));
        let start = format!(
            "game.toml: line 1: rates.passes = '{rules}' is not allowed: {reason}; allowed: rules like "
        );
        assert!(message.starts_with(&start), "{message}");
    }
    let message = rejected("rates.passes = 'left VK_FORMAT_R8G8B8A8_SRGB'");
    assert!(
        message.contains("is not allowed: \"VK_FORMAT_R8G8B8A8_SRGB\": allowed: a colour format"),
        "{message}"
    );
    assert!(rejected("rates.passes = 1").contains("1 is not allowed; allowed: rules like"));
}

#[test]
fn an_unknown_key_is_told_with_the_nearest_one() {
    for (text, line) in [
        (
            "[chroma]\nplatau_deg = 6",
            "game.toml: line 2: unknown key chroma.platau_deg; did you mean chroma.plateau_deg?",
        ),
        ("[chrome]\nmode = 'off'", "game.toml: line 1: unknown key chrome; did you mean chroma?"),
        ("hold_ms = 5", "game.toml: line 1: unknown key hold_ms; did you mean gaze.hold_ms?"),
        ("enable = true", "game.toml: line 1: unknown key enable; did you mean enabled?"),
        (
            "[log.level]\nx = 1",
            "game.toml: line 1: log.level = [log.level] is not allowed; allowed: \"error\", \"warn\", \"info\" or \"debug\"",
        ),
        (
            "[log]\nsource = 'eyes'",
            "game.toml: line 2: unknown key log.source; did you mean gaze.source or audio.source?",
        ),
        (
            "mode = 'fixed'",
            "game.toml: line 1: unknown key mode; did you mean audio.mode or rates.mode or reuse.mode or chroma.mode?",
        ),
        ("[chroma]\nstrength = 1", "game.toml: line 2: unknown key chroma.strength"),
        ("'line\\nbreak' = 1", r"game.toml: line 1: unknown key line\nbreak"),
        ("\"line\\nbreak\" = 1", r"game.toml: line 1: unknown key line\nbreak"),
    ] {
        assert_eq!(rejected(text), line);
    }
    assert!(rejected(&format!("{} = 1", "k".repeat(5000))).len() < 200);
}

#[test]
fn all_errors_are_told_in_order_up_to_ten() {
    let message = rejected("enabled = 1\n[gaze]\nsource = 'nose'\n[log]\nlevl = 'info'");
    let lines: Vec<_> = message.lines().collect();
    assert_eq!(lines.len(), 3, "{message}");
    assert!(lines[0].contains("line 1") && lines[1].contains("line 3") && lines[2].contains("line 5"));

    let many: String = (0..100).map(|number| format!("key{number} = 1\n")).collect();
    let message = rejected(&many);
    assert_eq!(message.lines().count(), 11);
    assert!(message.ends_with("game.toml: 90 more errors"), "{message}");
}

#[test]
fn a_key_that_is_set_twice_is_named() {
    for text in [
        "[chroma]\nmode = 'off'\nmode = 'paper'",
        "[chroma]\nmode = 'off'\n\"mode\" = 'off'",
        "chroma.mode = 'off'\n\nchroma.mode = 'off'",
    ] {
        let message = rejected(text);
        assert!(message.starts_with("game.toml: line 3: not valid TOML: duplicate key: "), "{message}");
        assert!(message.contains("mode"), "{message}");
    }
}

#[test]
fn text_that_is_no_toml_is_told_with_its_line() {
    for text in
        ["\n\nenabled", "\n\nenabled = ", "\n\n= true", "\n\n[chroma", "\n\nlog.level = \"info\nx = 1"]
    {
        let message = rejected(text);
        assert!(message.starts_with("game.toml: line 3: not valid TOML: "), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    let deep = rejected(&format!("enabled = {}", "[".repeat(100_000)));
    assert_eq!(deep.lines().count(), 1);
    assert!(deep.len() < 300, "{deep}");
}

#[test]
fn the_plateau_ends_before_the_curves_do() {
    let message = rejected("[chroma]\nmax_eccentricity_deg = 20\nplateau_deg = 25");
    assert!(
        message
            .starts_with("game.toml: line 3: chroma.plateau_deg = 25 and chroma.max_eccentricity_deg = 20: ")
    );
    let message = rejected("[chroma]\nplateau_deg = 20\n\nmax_eccentricity_deg = 20");
    assert!(message.starts_with("game.toml: line 4: "), "{message}");
    assert!(read("[chroma]\nplateau_deg = 20\nmax_eccentricity_deg = 20.5").is_ok());
}

/// A line that sets `option`, which is alone in its file.
fn set(option: &OptionSpec, value: &str) -> String {
    format!("{} = {value}\n", option.key())
}

#[test]
fn every_option_takes_its_default_and_its_bounds_and_nothing_beyond() {
    for option in OPTIONS {
        assert_eq!(read(&set(option, &option.value(&Config::default()))), Ok(Config::default()));
        let (good, bad): (Vec<String>, Vec<String>) = match option.allowed() {
            Allowed::Flag => (vec!["true".into(), "false".into()], vec!["0".into(), "'true'".into()]),
            Allowed::Number { min, max } => (
                vec![format!("{min:?}"), format!("{max:?}")],
                vec![format!("{:?}", min.next_down()), format!("{:?}", max.next_up()), "nan".into()],
            ),
            Allowed::Whole { min, max } => (
                vec![min.to_string(), max.to_string()],
                vec![(i64::from(min) - 1).to_string(), (max + 1).to_string(), format!("{min}.0")],
            ),
            Allowed::Text(_) if option.key() == "reuse.periods" => (
                vec!["\"11111\"".into(), "\"56789\"".into()],
                vec!["\"\"".into(), "\"11113\"".into(), "11223".into()],
            ),
            Allowed::Text(_) if option.key() == "gaze.osc_listen" => (
                vec!["\"127.0.0.1:1\"".into(), "\"[::1]:65535\"".into()],
                vec!["\"\"".into(), "\"127.0.0.1:0\"".into(), "\"localhost:9020\"".into(), "9020".into()],
            ),
            Allowed::Text(_) if option.key() == "gaze.offset_deg" => (
                vec!["\"-20, 20\"".into(), "\"0.25, -1.5\"".into()],
                vec!["\"\"".into(), "\"0, 20.1\"".into(), "1.5".into()],
            ),
            // An empty text stands for no rules, no names, ...: the one value that each such option takes.
            Allowed::Text(_) => (vec!["\"\"".into()], vec!["1".into(), "true".into()]),
            Allowed::Choice(choices) => (
                choices.iter().map(|(name, _)| format!("\"{name}\"")).collect(),
                vec!["\"\"".into(), "\"OFF\"".into(), "0".into()],
            ),
        };
        for value in good {
            // With the angle at which the curves end out of the way of the plateau's greatest value.
            let far = if option.name == "plateau_deg" { "chroma.max_eccentricity_deg = 110\n" } else { "" };
            let config = read(&format!("{far}{}", set(option, &value))).unwrap();
            assert_eq!(option.value(&config), value);
        }
        for value in bad {
            let message = rejected(&set(option, &value));
            assert_eq!(
                message,
                format!(
                    "game.toml: line 1: {} = {value} is not allowed; allowed: {}",
                    option.key(),
                    option.allowed_with_unit()
                )
            );
        }
    }
}

proptest! {
    #[test]
    fn any_text_gives_a_configuration_or_lines_that_name_the_file(text in any::<String>()) {
        told_well(&text)?;
    }

    #[test]
    fn any_text_that_looks_like_toml_does_too(
        text in "(\\[?(enabled|log|gaze|chroma|mode|level|hold_ms|\"\u{0}\")\\]?( |\n|\\.|=|=true|='off'|=[0-9]{1,3}|=\\{|\\}|,|#|\u{1b}){1,2}){0,12}"
    ) {
        told_well(&text)?;
    }

    #[test]
    fn any_value_is_taken_or_named(index in 0..OPTIONS.len(), number in any::<f64>()) {
        told_well(&set(&OPTIONS[index], &format!("{number:?}")))?;
    }
}

fn told_well(text: &str) -> Result<(), TestCaseError> {
    if let Err(message) = read(text) {
        prop_assert!((1..=11).contains(&message.lines().count()), "{message}");
        for line in message.lines() {
            prop_assert!(line.starts_with("game.toml: line ") || line.ends_with(" more errors"), "{line}");
            prop_assert!(!line.contains(char::is_control) && line.len() < 1000, "{line}");
        }
    }
    Ok(())
}

/// The off switch works with the key of a later version, or with a slip, in the same file.
#[test]
fn a_file_with_errors_can_turn_the_layer_off() {
    for text in [
        "enabled = false\nof_a_later_version = 1\n",
        "gaze.hold_ms = 9999\nenabled = false\n",
        "enabled = false\n[chroma]\nplateau_deg = 30\nmax_eccentricity_deg = 20\n",
        "\u{feff}preset = 1\nenabled = false",
        "enabled = false\nrates.mode = off\n",
        "enabled = false\n= 1\n",
        "enabled = false\nenabled = false\n",
    ] {
        let errors = parse(Path::new("x"), text).unwrap_err();
        assert!(errors.turns_off(), "{text}");
        assert_eq!(errors.at_start(), Config { enabled: false, ..Config::default() });
    }
    for text in [
        "enabled = true\nunknown = 1\n",
        "unknown = 1\n",
        "enabled = 'false'\n",
        "gaze.enabled = false\n",
        "enabled = off\n",
        "[gaze]\n= 1\nenabled = false\n",
    ] {
        let errors = parse(Path::new("x"), text).unwrap_err();
        assert!(!errors.turns_off(), "{text}");
        assert_eq!(errors.at_start(), Config::default());
    }
}
