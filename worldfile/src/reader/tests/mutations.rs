//! Worlds with random errors.

use super::*;
use proptest::prelude::*;

/// The lines of a world that hold numbers which are wrong if they are as large as this, each with what comes
/// before its value.
fn numbers(text: &str) -> Vec<(usize, &str)> {
    let limited = [
        "_m = ",
        "_s = ",
        "_mps = ",
        "_degps = ",
        "_mps2 = ",
        "_degps2 = ",
        "_hz = ",
        "_deg = ",
        "_kg = ",
        "beams = ",
        "friction = ",
        "sensor_radius = ",
        "dwell = ",
    ];
    let lines = text.lines().enumerate().filter_map(|(line, text)| {
        let key = limited.iter().find(|key| text.contains(*key) && !text.starts_with(['#', ' ']))?;
        let at = text.find(key)? + key.len();
        let is_alone = text[at..].trim_end().bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
        is_alone.then_some((line, &text[..at]))
    });
    lines.collect()
}

/// A text with some characters replaced by others.
pub(crate) fn changed(good: &'static str) -> impl Strategy<Value = String> {
    (0..good.len(), 0..40_usize, "[ -~\n]{0,12}").prop_map(move |(at, length, text)| {
        format!("{}{text}{}", &good[..at], &good[(at + length).min(good.len())..])
    })
}

/// A text with another number in the place of one of its numbers.
pub(crate) fn renumbered(
    good: &'static str,
    number: impl Strategy<Value = String>,
) -> impl Strategy<Value = String> {
    (any::<prop::sample::Index>(), number).prop_map(move |(place, number)| {
        let is_digit = |c: char| c.is_ascii_digit();
        let is_first = |at: &usize| !good[..*at].ends_with(|c: char| c.is_ascii_alphanumeric() || c == '.');
        let places: Vec<usize> = good.match_indices(is_digit).map(|(at, _)| at).filter(is_first).collect();
        let at = places[place.index(places.len())];
        let end = at + good[at..].find(|c: char| !is_digit(c) && c != '.').unwrap();
        format!("{}{number}{}", &good[..at], &good[end..])
    })
}

proptest! {
    #[test]
    fn every_unknown_key_is_reported_with_its_line(
        (text, places) in prop::sample::select(vec![HOUSE, FOUR_ROOMS, TWO_BLOCKS]).prop_flat_map(|text| {
            let headers = text.lines().enumerate().filter(|(_, line)| line.starts_with('['));
            let headers: Vec<usize> = headers.map(|(i, _)| i).collect();
            let most = headers.len().min(20);
            (Just(text), prop::sample::subsequence(headers, 0..=most))
        })
    ) {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        for (more, place) in places.iter().enumerate() {
            lines.insert(place + more + 1, format!("not_known_{more} = [1, {{ a = 2 }}]"));
        }
        let messages = messages(&lines.join("\n"));
        prop_assert_eq!(messages.len(), places.len(), "{}", messages.join("\n"));
        for (more, (message, place)) in messages.iter().zip(&places).enumerate() {
            let what = format!("unknown key `not_known_{more}`\n");
            let line = format!("world.toml:{}:1\n", place + more + 2);
            prop_assert!(message.starts_with(&what) && message.contains(&line), "{message}");
        }
    }

    #[test]
    fn every_invalid_number_is_reported_with_its_line(
        (text, places) in prop::sample::select(vec![HOUSE, YARD, FOUR_ROOMS, TWO_BLOCKS]).prop_flat_map(|text| {
            let numbers = numbers(text);
            let most = numbers.len().min(20);
            (Just(text), prop::sample::subsequence(numbers, 0..=most))
        })
    ) {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        for (place, key) in &places {
            lines[*place] = format!("{key}4000000000");
        }
        let messages = messages(&lines.join("\n"));
        prop_assert_eq!(messages.len(), places.len(), "{}", messages.join("\n"));
        for (message, (place, key)) in messages.iter().zip(&places) {
            let line = format!("world.toml:{}:{}\n", place + 1, key.len() + 1);
            prop_assert!(message.contains("which is out of range") && message.contains(&line), "{message}");
        }
    }

    /// A value of any type in the place of any other.
    #[test]
    fn no_type_makes_it_panic(
        text in prop::sample::select(vec![HOUSE, FOUR_ROOMS, TWO_BLOCKS]),
        place: prop::sample::Index,
        value in prop::sample::select(vec![
            "true", "-1", "1e400", "99999999999999999999", "0xff", "nan", "\"\"", "[]", "[1.0]", "[[]]", "{}",
            "{ a = 1 }", "[{}]", "1979-05-27",
        ]),
    ) {
        let places: Vec<usize> = text.match_indices(" = ").map(|(at, _)| at + 3).collect();
        let at = places[place.index(places.len())];
        let end = at + text[at..].find('\n').unwrap();
        for message in messages(&format!("{}{value}{}", &text[..at], &text[end..])) {
            prop_assert!(message.contains("world.toml"), "{message}");
        }
    }
}
