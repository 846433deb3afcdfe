//! Any bytes: a world or errors, soon, and never a panic.

use super::{Table, lab_files};
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

const WORDS: &str = "model;position;ranger;laser;sensor;block;define;include;a;b;(;);( );[;];size;pose;origin;points;point[0];\
    bitmap;\"lab.png\";\"rover.inc\";\"lab.world\";boundary;fov;samples;range;drive;\"omni\";name;\"a\";[0 0];\
    [1 2 3];[0 0 0 90];-1;0;3;1e9;update_interval;velocity_bounds;localization;\"odom\";\n;#";

/// Words that mean something, in any order.
fn words() -> impl Strategy<Value = String> {
    let words = prop::sample::select(WORDS.split(';').collect::<Vec<_>>());
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
        let mut files = Table::new();
        files.insert("x".into(), bytes);
        read(Path::new("x"), &files);
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
