//! The files.

use crate::made_up::results;
use parafovea_models::errors::RINGS;
use parafovea_report::advice::advice;
use parafovea_report::hardware::Look;
use parafovea_report::page::page;
use parafovea_report::pictures::Pictures;
use parafovea_report::results::Results;
use parafovea_report::{plot, table};
use parafovea_tests::picture::Picture;

fn written_page(results: &Results) -> String {
    let folder = tempfile::tempdir().unwrap();
    let mut pictures = Pictures::new(folder.path()).unwrap();
    let seen = Picture::from_fn(512, 512, |x, y| [x as u8, y as u8, 9, 255]);
    let map = Picture::from_fn(4, 4, |x, _| [x as u8; 4]);
    pictures.keep("cockpit", "everything balanced", &seen, Some(&map));
    page(results, &[], &pictures).unwrap()
}

/// The names of unclosed tags, or the first closing tag without an open one.
fn unbalanced(html: &str) -> Result<Vec<&str>, String> {
    const EMPTY: [&str; 5] = ["meta", "img", "br", "hr", "link"];
    let mut open = Vec::new();
    for tag in html.split('<').skip(1).filter(|tag| !tag.starts_with(['!', '?'])) {
        let inside = tag.split_once('>').ok_or_else(|| format!("`{tag}` does not end"))?.0;
        let name = inside.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap_or_default();
        if inside.starts_with('/') {
            match open.pop() {
                Some(last) if last == name => {}
                last => return Err(format!("</{name}> where {last:?} is open")),
            }
        } else if !inside.ends_with('/') && !EMPTY.contains(&name) {
            open.push(name);
        }
    }
    Ok(open)
}

#[test]
fn the_page_is_well_formed_and_needs_nothing_else() {
    let html = written_page(&results());
    assert_eq!(unbalanced(&html), Ok(vec![]));
    assert!(
        html.contains("a device &amp; its &lt;driver&gt;")
            && html.contains("digital silence &amp; &lt;less&gt;")
    );
    // The page contains everything that it shows: it has no addresses but those of SVG's own names, and data.
    let outside = html.replace("http://www.w3.org/2000/svg", "").replace("http://www.w3.org/1999/xlink", "");
    for word in ["http:", "https:", "url(", "@import", "<script", "<link"] {
        assert!(!outside.contains(word), "the page has {word}");
    }
    let sources: Vec<&str> = html.split("src=\"").skip(1).collect();
    assert_eq!(sources.len(), 2, "a picture and its map");
    assert!(sources.iter().all(|source| source.starts_with("data:image/png;base64,")));
}

#[test]
fn the_look_of_hardware_rates_has_a_table_and_verdicts() {
    let mut results = results();
    let words = "Maps by the look of hardware rates";
    assert!(!written_page(&results).contains(words), "nobody measured it");
    results.hardware = results.scenes.clone();
    let html = written_page(&results);
    assert_eq!(unbalanced(&html), Ok(vec![]));
    let table = html.split(words).nth(1).unwrap();
    // Cost and mean loss of two scenes.
    assert!(table.contains("<td>preset balanced</td><td>0.550</td>"), "{table}");
    assert!(html.contains("out of 2, with a lower loss than the alternative at equal share"), "{html}");
    results.conditions.look = Look::Mask;
    let html = written_page(&results);
    assert!(html.contains("Maps by the look of the mask") && !html.contains(words), "{html}");
}

#[test]
fn the_first_screen_says_what_to_switch_on() {
    let html = written_page(&results());
    let first = html.split("All techniques").next().unwrap();
    let advice = advice(&results(), &[]);
    assert!(advice.len() >= 4);
    for advice in &advice {
        assert!(first.contains(advice.application), "{} is not there", advice.application);
    }
    for words in
        ["no GPU yet", "0.55 times the time here", "all bits by -8.0 %", "do not show the speed on a GPU"]
    {
        assert!(first.contains(words), "{words} is not there:\n{first}");
    }
    assert_eq!(advice[2].setting, "preset = \"streaming\"");
    // In the mean of 0.5 and 1.3 everything costs more than rates alone, and re-use was not measured by itself.
    let reuse = &advice[3];
    assert!(reuse.setting.starts_with("reuse.mode = \"off\""), "{reuse:?}");
}

#[test]
fn colour_is_not_given_up_for_a_few_bits() {
    let mut results = results();
    for bits in results.scenes.iter_mut().flat_map(|scene| &mut scene.bits) {
        bits.total = -0.02;
    }
    assert_eq!(advice(&results, &[])[2].setting, "chroma.mode = \"off\"");
}

#[test]
fn plots_are_svg_with_a_line_for_each_sweep() {
    let results = results();
    let overview = plot::overview(&results).unwrap();
    let document = roxmltree::Document::parse(&overview).unwrap();
    let texts: Vec<&str> = document.descendants().filter_map(|node| node.text()).map(str::trim).collect();
    for title in ["render scale", "fixed foveation (FR)", "presets", "everything"] {
        assert!(texts.contains(&title), "{title} is not in the legend");
    }
    assert!(!texts.contains(&"re-use"), "what was not measured has no line");
    assert!(texts.iter().any(|text| text.contains("not a user's speed")));
    let scene = plot::of_scene(&results, &results.scenes[0]).unwrap();
    assert!(roxmltree::Document::parse(&scene).is_ok() && scene.contains("Pareto front"));
}

#[test]
fn tables_have_as_many_cells_as_titles() {
    let results = results();
    let markdown = table::markdown(&results, &[]);
    let columns = table::titles(&results).len();
    let rows: Vec<&str> = markdown.lines().filter(|line| line.starts_with("| ")).collect();
    assert_eq!(rows.len(), 3 * (1 + 8), "the mean and two scenes");
    assert!(rows.iter().all(|row| row.matches(" | ").count() == columns - 1), "{markdown}");
    assert!(
        markdown.contains("| preset balanced | 0.55 | 0.55 | 22.0 | 0.55 | 27.5 | none yet |"),
        "{markdown}"
    );

    let csv = table::csv(&results).unwrap();
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let titles = reader.headers().unwrap().clone();
    assert_eq!(titles.len(), 3 + 10 + RINGS);
    let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(records.len(), 2 * 8);
    let column = |name: &str| titles.iter().position(|title| title == name).unwrap();
    let everything = records.iter().find(|record| &record[2] == "everything balanced").unwrap();
    assert_eq!((&everything[0], &everything[column("x_off")]), ("cockpit", "0.5"));
    let chroma = records.iter().find(|record| &record[2] == "chroma").unwrap();
    assert_eq!(&chroma[column("ms")], "", "it was not timed");
}

#[test]
fn lines_for_programs_have_what_was_measured() {
    let rows = table::json_rows(&results());
    let row = |case: &str, metric: &str| {
        rows.iter().find(|row| row.app == "cockpit" && row.case == case && row.metric == metric)
    };
    let time = row("everything balanced", "cpu_ms").unwrap();
    let beside = time.comparison.unwrap();
    assert_eq!((time.value, beside.baseline, beside.ratio), (20.0, 40.0, 0.5));
    assert!(row("chroma", "cpu_ms").is_none());
    assert_eq!(row("chroma", "bd_rate JPEG 4:2:0 total").unwrap().value, -0.08);
}

#[test]
fn results_come_back_as_they_were_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.json");
    results().write(&path).unwrap();
    let (kept, made) = (Results::read(&path).unwrap(), results());
    // Figures come back to the last digit or the one before.
    assert_eq!((&kept.conditions, kept.techniques()), (&made.conditions, made.techniques()));
    let losses = |results: &Results| -> Vec<f64> {
        results.scenes.iter().flat_map(|scene| &scene.points).map(|point| point.loss()).collect()
    };
    assert!(losses(&kept).iter().zip(losses(&made)).all(|(a, b)| (a - b).abs() < 1e-12));
    std::fs::write(&path, "{}").unwrap();
    assert!(Results::read(&path).unwrap_err().contains("results.json"));
}
