//! The figures, from made-up trials.

use super::*;
use draw::palette;
use image::RgbImage;

const FIVE: [&str; 5] = ["curious", "recency", "poisson", "random", "coin"];

fn figures(report: &Report) -> (Vec<String>, Vec<RgbImage>, Vec<String>) {
    let files = written(report);
    let names = files.iter().map(|(name, _)| name.clone()).collect();
    let of = |ending: &'static str| files.iter().filter(move |(name, _)| name.ends_with(ending));
    let pictures = of(".png").map(|(_, bytes)| image::load_from_memory(bytes).unwrap().into_rgb8());
    let texts = of(".svg").map(|(_, bytes)| String::from_utf8(bytes.clone()).unwrap());
    (names, pictures.collect(), texts.collect())
}

#[test]
fn the_run_over_all_worlds_is_figure_3_and_the_others_are_named() {
    let names = |worlds, estimators: &[&str]| {
        let (names, ..) = figures(&report(worlds, estimators, &["curious"], 1));
        let svg = names.iter().filter_map(|name| name.strip_suffix(".svg"));
        svg.map(String::from).collect::<Vec<_>>()
    };
    assert_eq!(names(1, &["paper"]), ["figure3"]);
    // By name.
    assert_eq!(names(1, &["paper", "two-state"]), ["figure3-two_blocks-two-state", "figure3"]);
    assert_eq!(names(2, &["paper"]), ["figure3-generated_1", "figure3-two_blocks", "figure3"]);
    assert_eq!(names(9, &["paper"]), ["figure3"]);
}

#[test]
fn names_that_look_alike_in_a_file_s_name_stay_apart() {
    let (settings, mut trials) = experiment(3, &["paper"], &["curious"], 1);
    for trial in &mut trials {
        trial.world = trial.world.replace("generated 1", "a b").replace("generated 2", "a_b");
    }
    let (mut names, ..) = figures(&Report::new(settings, trials));
    names.retain(|name| name.ends_with("svg"));
    assert_eq!(names, ["figure3-a_b-2.svg", "figure3-a_b.svg", "figure3-two_blocks.svg", "figure3.svg"]);
}

#[test]
fn every_strategy_the_world_and_the_words_are_drawn() {
    let (_, pictures, texts) = figures(&report(1, &["two-state"], &FIVE, 5));
    let (picture, text) = (&pictures[0], &texts[0]);
    let count = |colour: [u8; 3]| picture.pixels().filter(|pixel| pixel.0 == colour).count();
    let colors = [[0, 114, 178], [0, 158, 115], [230, 159, 0], [150, 150, 150], [86, 180, 233]];
    for (name, colour) in FIVE.into_iter().zip(colors) {
        assert!(count(colour) > 300, "{name}: {}", count(colour));
        let [red, green, blue] = colour;
        assert!(text.contains(&format!("stroke=\"#{red:02X}{green:02X}{blue:02X}\"")), "{name}");
        assert!(text.contains(&format!(">\n{name}\n</text>")), "{name}");
    }
    // The walls, and the blocks at their starts.
    assert!(count(palette::WALL) > 1000, "{}", count(palette::WALL));
    assert!(count(palette::MOVING) > 100, "{}", count(palette::MOVING));
    let title = "two_blocks: 5 trials of 20,000 steps, estimator two-state, sensor radius 4";
    for words in [title, "top", "bottom", "Map correct: share of cells", "15,000"] {
        assert!(text.contains(&format!(">\n{words}\n</text>")), "{words}");
    }
    assert!(!text.contains("NaN") && !text.contains("inf"));
    let [width, height] = [picture.width(), picture.height()];
    let size = format!("<svg width=\"{width}\" height=\"{height}\" stroke-linejoin=\"round\"");
    assert!(text.starts_with(&format!("{size} viewBox=\"0 0 {width}0 {height}0\"")), "the same size");
    assert!(text.ends_with("</svg>\n"));
}

#[test]
fn undefined_values_single_samples_and_missing_worlds_can_be_drawn() {
    let changes: [fn(&mut Trial); 4] = [
        |trial| trial.samples.iter_mut().for_each(|sample| sample.rate_error = f64::NAN),
        |trial| trial.samples.truncate(1),
        |trial| trial.samples[70].log_error = f64::INFINITY,
        |trial| trial.world = "nowhere".into(),
    ];
    for change in changes {
        let (settings, mut trials) = experiment(1, &["paper"], &["curious", "recency"], 2);
        trials.iter_mut().for_each(change);
        let (_, pictures, texts) = figures(&Report::new(settings, trials));
        assert_eq!(pictures.len(), 1);
        assert!(!texts[0].contains("NaN") && !texts[0].contains("inf"));
    }
}

#[test]
fn names_are_escaped() {
    let (settings, mut trials) = experiment(1, &["paper"], &["curious"], 1);
    trials[0].world = "a < b & \"c\"\u{1b}\u{ffff}".into();
    let (.., texts) = figures(&Report::new(settings, trials));
    // Control characters are not allowed in XML, not even escaped.
    assert!(texts[0].contains("a &lt; b &amp; &quot;c&quot;\\u{1b}\\u{ffff}: 1 trial"));
}
