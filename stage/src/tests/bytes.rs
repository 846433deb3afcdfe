//! Any bytes: a world or errors, soon, and never a panic.

use super::{Table, lab_files, table};
use crate::{load, read};
use proptest::prelude::*;
use std::path::Path;

/// The example with a part of one of its files replaced.
fn changed(file: &str, at: &prop::sample::Index, length: usize, bytes: &[u8]) -> Table {
    let mut files = lab_files();
    let whole = files.get_mut(Path::new(file)).unwrap();
    let at = at.index(whole.len());
    let end = (at + length).min(whole.len());
    whole.splice(at..end, bytes.iter().copied());
    files
}

/// Words that mean something, in any order.
fn words() -> impl Strategy<Value = String> {
    let words = "model|position|ranger|laser|sensor|block|define|include|a|b|(|)|( )|[|]|size|pose|origin|points|point[0]|\
                 bitmap|\"lab.png\"|\"rover.inc\"|\"lab.world\"|boundary|fov|samples|range|drive|\"omni\"|name|\"a\"|[0 0]|\
                 [1 2 3]|[0 0 0 90]|-1|0|3|1e9|update_interval|velocity_bounds|localization|\"odom\"|\n|#";
    let words = prop::sample::select(words.split('|').collect::<Vec<_>>());
    prop::collection::vec(words, 0..60).prop_map(|words| words.join(" "))
}

proptest! {
    #[test]
    fn no_change_makes_it_panic(
        file in prop::sample::select(vec!["lab.world", "rover.inc", "scanner.inc", "lab.png"]),
        at in any::<prop::sample::Index>(),
        length in 0..40_usize,
        text in "[ -~\n]{0,12}",
    ) {
        load(Path::new("lab.world"), &changed(file, &at, length, text.as_bytes()));
    }

    #[test]
    fn no_bytes_make_it_panic(
        at in any::<prop::sample::Index>(),
        length in 0..200_usize,
        bytes in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        load(Path::new("lab.world"), &changed("lab.world", &at, length, &bytes));
        read(Path::new("x"), &table(&[("x", &bytes)]));
    }

    #[test]
    fn no_words_make_it_panic(text in words()) {
        let mut files = lab_files();
        files.insert("x.world".into(), text.into_bytes());
        load(Path::new("x.world"), &files);
    }

    /// Numbers of every size in every place.
    #[test]
    fn no_number_makes_it_panic(
        file in prop::sample::select(vec!["lab.world", "rover.inc", "scanner.inc"]),
        place in any::<prop::sample::Index>(),
        exponent in -320..310_i32,
        sign in any::<bool>(),
    ) {
        let mut files = lab_files();
        let text = String::from_utf8(files[Path::new(file)].clone()).unwrap();
        let numbers: Vec<usize> = text.match_indices(|c: char| c.is_ascii_digit())
            .filter(|(at, _)| text[..*at].ends_with([' ', '[']))
            .map(|(at, _)| at).collect();
        let at = numbers[place.index(numbers.len())];
        let end = at + text[at..].find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len() - at);
        let number = format!("{}1e{exponent}", if sign { "-" } else { "" });
        files.insert(file.into(), format!("{}{number}{}", &text[..at], &text[end..]).into_bytes());
        if let (Some(spec), _) = load(Path::new("lab.world"), &files) {
            let mut fleet = sim::physics::Fleet::new(&spec, 0);
            fleet.run_until(0.2, &mut ());
        }
    }
}

/// The worst megabytes that are known, each read within seconds and 1 GiB: run alone as
/// `(ulimit -v 1048576; TEST-PROGRAM worst_megabytes --ignored --nocapture)`.
#[test]
#[ignore = "slow; for measuring memory and time"]
fn worst_megabytes() {
    const SIZE: usize = 1_000_000;
    let fill = |head: &str, part: &str| format!("{head}{}", part.repeat((SIZE - head.len()) / part.len()));
    let star: String = (0..1000)
        .map(|i| {
            let (y, x) = libm::sincos(f64::from(i) * 0.006283);
            let radius = if i % 2 == 0 { 1.0 } else { 0.999 };
            format!("point[{i}] [{:.3} {:.3}]\n", x * radius, y * radius)
        })
        .collect();
    let doubling: String =
        (1..=25).map(|i| format!("define a{i} model( a{0}( ) a{0}( ) )\n", i - 1)).collect();
    let each = |count: usize, text: fn(usize) -> String| (0..count).map(text).collect::<String>();
    let worlds = [
        ("models", fill("", "model()")),
        ("unlike models", each(30_000, |i| format!("model(pose[{i} 0 {i} 9])\n"))),
        ("robots", each(9000, |i| format!("position(pose[{i} 0 0 0] size[.1 .1 .1] laser())\n"))),
        (
            "turned robots",
            each(9000, |i| format!("position(pose[{} {} 0 9] laser(samples 10000))\n", i % 95, i / 95)),
        ),
        ("keys", fill("model(", "a 1\n")),
        ("words", fill("", "a ")),
        ("brackets", fill("", "a(")),
        ("lists", fill("model( size [", "1 ")),
        ("doublings", format!("define a0 model( )\n{doubling}a25( )")),
        ("stars", format!("define star model( block( points 1000\n{star}) )\n{}", "star()".repeat(500))),
        ("includes", fill("", "include \"i.inc\"\n")),
        ("pictures", fill("", "model(bitmap \"p.pbm\")\n")),
        ("pictured robots", fill("", "position(bitmap \"p.pbm\")\n")),
    ];
    for (name, text) in worlds {
        assert!(text.len() <= SIZE, "{name}: {}", text.len());
        let mut files = lab_files();
        files.insert("x.world".into(), text.into_bytes());
        files.insert("i.inc".into(), fill("", "model()").into_bytes());
        // Rows of every other pixel, above rows of none: as many corners as there may be.
        let rows = (0..1000).flat_map(|y| if y % 2 == 0 { [0xaa; 125] } else { [0; 125] });
        files.insert("p.pbm".into(), b"P4 1000 1000\n".iter().copied().chain(rows).collect());
        let start = std::time::Instant::now();
        let (spec, findings) = load(Path::new("x.world"), &files);
        let (is_good, time) = (spec.is_some(), start.elapsed());
        let (errors, warnings) = (findings.errors(), findings.warnings());
        println!("{name}: {time:?}, good: {is_good}, {errors} errors, {warnings} warnings");
    }
}
