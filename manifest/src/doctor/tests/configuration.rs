//! Files of the configuration.

use super::*;
use crate::config::Names;

/// As stow and Nix leave them when a package is removed.
#[test]
fn a_link_to_a_missing_file_is_named_with_the_file_that_applies() {
    let mut machine = Machine::new();
    let [config, app, target] = ["config.toml", "apps/Game.toml", "gone.toml"]
        .map(|name| machine.path("home/.config/parafovea").join(name));
    fs::create_dir_all(app.parent().unwrap()).unwrap();
    symlink("../gone.toml", &app).unwrap();
    let of = |machine: &Machine, application: Option<&str>| {
        let mut surroundings = machine.surroundings();
        surroundings.application = application.map(Names::unknown);
        let findings = examine(&surroundings).into_iter().filter(|finding| finding.severity > Severity::Good);
        findings.collect::<Vec<_>>()
    };
    let found = of(&machine, Some("Game"));
    assert_eq!(
        found.iter().map(|finding| finding.id).collect::<Vec<_>>(),
        ["configuration-link"],
        "{found:#?}"
    );
    let link = format!("{} is a link to a missing file, ", app.display());
    assert!(found[0].found.starts_with(&link) && found[0].found.ends_with("gone.toml"), "{}", found[0]);
    assert!(found[0].means.ends_with(&format!("{} applies.", config.display())), "{}", found[0]);
    let found = of(&machine, None);
    assert!(found.len() == 1 && found[0].means.contains("its application"), "{found:#?}");

    fs::remove_file(&app).unwrap();
    fs::remove_file(&config).unwrap();
    symlink(&target, &config).unwrap();
    let found = of(&machine, None);
    assert!(found.len() == 1 && found[0].means.ends_with("the defaults apply."), "{found:#?}");
    fs::write(&target, "").unwrap();
    assert_eq!(of(&machine, None), []);

    // The variable's file applies in any case, so that it is an error.
    fs::remove_file(&target).unwrap();
    machine.set("PARAFOVEA_CONFIG", config.to_str().unwrap());
    let found = of(&machine, None);
    assert!(found.len() == 1 && found[0].id == "configuration-wrong", "{found:#?}");
}

#[test]
fn an_off_switch_beside_errors_is_told() {
    let machine = Machine::new();
    for (text, means) in
        [("enabled = false\na = 1\n", "except for enabled = false"), ("a = 1\n", "or the defaults")]
    {
        machine.put("home/.config/parafovea/config.toml", text);
        let findings = machine.findings();
        assert!(
            findings[0].id == "configuration-wrong" && findings[0].means.contains(means),
            "{}",
            findings[0]
        );
    }
}
